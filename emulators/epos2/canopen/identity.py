"""Node number and bit rate of the drive on the bus; both may change with a restart."""

from typing import Final

from emulators.epos2.canopen.lss_slave import NODE_NUMBER, LssSlave
from emulators.epos2.objects.device_profile import BIT_RATE, BIT_RATE_IN_USE, BIT_RATES
from emulators.epos2.objects.saved_parameters import SavedParameters
from emulators.epos2.objects.store import ObjectStore
from firmware_bridge.units import NEVER, Nanoseconds

FIRST_NUMBER: Final = 1
"""Number of a drive whose DIP switch is 0 and that has saved none."""


class Identity:
    """Node number and bit rate in use."""

    def __init__(self, dip_switch: int, bus_rate: int | None) -> None:
        """`bus_rate` in bits a second is what the bus runs at; None where that does not matter."""
        self.dip_switch: Final = dip_switch
        self.node = dip_switch or FIRST_NUMBER
        self.due: Nanoseconds = NEVER
        """Time at which the bit rate changes, or the silence after that ends."""
        self._bus_rate: Final = bus_rate
        self._rate: int | None = bus_rate
        self._next: int | None = None
        self._delay: Nanoseconds = 0
        self._quiet = False

    @property
    def on_bus(self) -> bool:
        """True if the drive receives from the bus and is received there."""
        return not self._quiet and (self._bus_rate is None or self._rate == self._bus_rate)

    def restart(self, store: ObjectStore, memory: SavedParameters, lss: LssSlave) -> None:
        """Begin as after power-on: number and bit rate from switch, copy or default, and all objects."""
        lss.pending_node = None
        store.node_id = self.dip_switch or FIRST_NUMBER
        # The number before the objects: the defaults of the COB-IDs contain it.
        self.node = store.node_id = self.dip_switch or memory.saved(NODE_NUMBER)
        memory.load()
        self._take(store, memory.saved(BIT_RATE))

    def reset_communication(self, store: ObjectStore, lss: LssSlave) -> None:
        """Take a number that layer setting has left."""
        if not self.dip_switch and lss.pending_node is not None:
            self.node = store.node_id = lss.pending_node

    def switch(self, code: int, delay: Nanoseconds, now: Nanoseconds) -> None:
        """Change the bit rate after a delay, and be quiet for another one."""
        # CiA 305: the delay counts twice, up to the change and from there to the first frame.
        self._next, self._delay, self._quiet = code, delay, True
        self.due = now + delay

    def wake(self, store: ObjectStore, now: Nanoseconds) -> bool:
        """Do what is due; return True if that may have put the drive on the bus, or off it."""
        if now < self.due:
            return False
        if self._next is not None:
            # Noted first: `_take` ends the silence.
            ends = self.due + self._delay
            self._take(store, self._next)
            self._quiet, self.due = True, ends
        if now >= self.due:
            self._quiet = False
            self.due = NEVER
        return True

    def _take(self, store: ObjectStore, code: int) -> None:
        store.set(BIT_RATE_IN_USE, code)
        self._rate = BIT_RATES.get(code)
        self._next, self._quiet, self.due = None, False, NEVER
