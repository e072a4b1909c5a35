"""Reading of objects, once or repeatedly, with the outcome of each."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.drive_words import BY_MODE
from firmware_bridge.families.epos2.commissioning.client import Ask, Do, Script, Wait
from firmware_bridge.families.epos2.commissioning.job import JobError, Outcome, ReadJob
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.units import Nanoseconds


class Reading:
    """Objects in the order of the request, each with the newest outcome."""

    def __init__(self, addresses: Sequence[Address]) -> None:
        self.addresses: Final = tuple(dict.fromkeys(addresses))
        self.found: dict[Address, Outcome] = {}
        needs_mode = BY_MODE.intersection(self.addresses) and od.MODE_DISPLAY not in self.addresses
        self._requested = (*self.addresses, od.MODE_DISPLAY) if needs_mode else self.addresses

    @property
    def mode(self) -> Mode | None:
        """The drive's mode, which some texts depend on; None where it is not known."""
        value = self.value(od.MODE_DISPLAY)
        return Mode(value) if value in set(Mode) else None

    def value(self, address: Address) -> int | str | None:
        """Return what was read; None where nothing was."""
        raw = self.found.get(address)
        return ANY_TYPE.decoded(address, raw) if isinstance(raw, bytes) else None

    def once(self) -> Script:
        """Read each object once. A refusal is kept; a drive that does not answer ends the script."""
        return tuple(Ask(ReadJob(address), partial(self._keep, address)) for address in self._requested)

    def again_and_again(self, period: Nanoseconds, changed: Callable[[], None]) -> Script:
        """Read them for ever, with a pause in between; call `changed` after each round that brought news."""
        return (Do(partial(self._round, period, changed, {})),)

    def _round(self, period: Nanoseconds, changed: Callable[[], None], before: dict[Address, str]) -> Script:
        after = Do(partial(self._after, period, changed, before))
        return (*self.once(), after)

    def _after(self, period: Nanoseconds, changed: Callable[[], None], before: dict[Address, str]) -> Script:
        now = {address: str(outcome) for address, outcome in self.found.items()}
        if now != before:
            changed()
        return (Wait(period), Do(partial(self._round, period, changed, now)))

    def _keep(self, address: Address, outcome: Outcome) -> Script:
        if isinstance(outcome, JobError) and outcome.unheard:
            raise outcome
        self.found[address] = outcome
        return ()
