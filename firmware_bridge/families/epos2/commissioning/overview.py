"""Overview of a drive: identity, state, mode, errors, network state."""

from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import PowerState, Status
from firmware_bridge.families.epos2.commissioning.client import Do, Script
from firmware_bridge.families.epos2.commissioning.next_step import next_step
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.power_states import state_of

STANDING: Final = (
    od.STATUSWORD,
    od.CONTROLWORD,
    od.MODE,
    od.MODE_DISPLAY,
    od.ERROR_REGISTER,
    od.ERROR_HISTORY_COUNT,
)
HISTORY_LENGTH: Final = 5
IDENTITY: Final = (
    od.DEVICE_NAME,
    Address(0x2003, 2),
    Address(0x2003, 1),
    Address(0x2003, 3),
    Address(0x2003, 4),
    od.VENDOR_ID,
    od.PRODUCT_CODE,
    od.REVISION,
    Address(0x2004),
)
"""Name, versions in the order of maxon's command library, the identity object, the serial number."""


def network_states(statusword: int, *, alone: bool) -> tuple[NmtState, ...]:
    """Return the network states that an EPOS2 may be in, by its statusword; `alone` as for `Overview`."""
    if statusword & Status.REMOTE:
        return (NmtState.OPERATIONAL,)
    pre = (NmtState.PRE_OPERATIONAL,)
    return (*pre, NmtState.STOPPED) if alone else pre


class Overview:
    """State of a drive. `readings` holds the values read, in order."""

    def __init__(self, *, alone: bool) -> None:
        """Take `alone`: the drive is on its own line, which answers in every network state."""
        self._alone = alone
        self._standing = Reading(STANDING)
        self._history = Reading(())

    @property
    def readings(self) -> tuple[Reading, Reading]:
        """The values read: first the state, then the error history, the newest error first."""
        return self._standing, self._history

    @property
    def state(self) -> PowerState | None:
        """The state of the power state machine; None where it was not read."""
        word = self._standing.value(od.STATUSWORD)
        return state_of(word) if isinstance(word, int) else None

    @property
    def mode(self) -> Mode | None:
        """The mode that it is in; None where it was not read."""
        return self._standing.mode

    @property
    def next_step(self) -> str:
        """What brings the drive nearer to motion; empty where that is not known."""
        control, status = (self._standing.value(address) for address in (od.CONTROLWORD, od.STATUSWORD))
        known = control if isinstance(control, int) else None
        return next_step(self.state, self.mode, known, status if isinstance(status, int) else 0)

    @property
    def network(self) -> tuple[NmtState, ...]:
        """Network states that it may be in: a drive in Stopped answers on its own line only."""
        word = self._standing.value(od.STATUSWORD)
        return network_states(word, alone=self._alone) if isinstance(word, int) else ()

    def script(self) -> Script:
        """Read it all."""
        return (*self._standing.once(), Do(self._errors))

    def _errors(self) -> Script:
        count = self._standing.value(od.ERROR_HISTORY_COUNT)
        entries = min(count, HISTORY_LENGTH) if isinstance(count, int) else 0
        self._history = Reading([Address(od.ERROR_HISTORY_COUNT.index, n + 1) for n in range(entries)])
        return self._history.once()
