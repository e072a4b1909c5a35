"""Under which number and at which bit rate the drive is on the bus; both may change with a restart.

Sources: EPOS Firmware Specification (by analogy): 0x2000 counts while the DIP switch is 0, 0x2000 and 0x2001
take effect after save and restart; CiA 305 for the change of the bit rate at run time. Where they are silent:
a drive whose switch is 0 and that has saved no number is node 1; a drive at another bit rate than the bus is
not receiving and silent (a real one would also disturb the others with error frames).
"""

from typing import Final

from emulators.epos2.canopen.lss_slave import NODE_NUMBER, LssSlave
from emulators.epos2.objects.device_profile import BIT_RATE, BIT_RATE_IN_USE, BIT_RATES
from emulators.epos2.objects.saved_parameters import SavedParameters
from emulators.epos2.objects.store import ObjectStore
from firmware_bridge.units import NEVER, Nanoseconds

FIRST_NUMBER: Final = 1
"""Of a drive whose DIP switch is 0 and that has saved none."""


class Identity:
    """Node number and bit rate in use."""

    def __init__(self, dip_switch: int, bus_rate: int | None) -> None:
        """`bus_rate` in bits a second is what the bus runs at; None where that does not matter."""
        self.dip_switch: Final = dip_switch
        self.node = dip_switch or FIRST_NUMBER
        self.due: Nanoseconds = NEVER
        """When the bit rate changes, or the silence after that ends."""
        self._bus_rate: Final = bus_rate
        self._rate: int | None = bus_rate
        self._next: int | None = None
        self._delay: Nanoseconds = 0
        self._quiet = False

    @property
    def on_bus(self) -> bool:
        """Whether the drive hears the bus and is heard."""
        return not self._quiet and (self._bus_rate is None or self._rate == self._bus_rate)

    def restart(self, store: ObjectStore, memory: SavedParameters, lss: LssSlave) -> None:
        """Begin as after power-on: number and bit rate from switch, copy or default, and all objects."""
        lss.pending_node = None
        store.node_id = self.dip_switch or FIRST_NUMBER
        self.node = store.node_id = self.dip_switch or memory.saved(NODE_NUMBER)
        memory.load()
        self._take(store, memory.saved(BIT_RATE))

    def reset_communication(self, store: ObjectStore, lss: LssSlave) -> None:
        """Take a number that layer setting has left."""
        if not self.dip_switch and lss.pending_node is not None:
            self.node = store.node_id = lss.pending_node

    def switch(self, code: int, delay: Nanoseconds, now: Nanoseconds) -> None:
        """Change the bit rate after a delay, and be quiet for another one."""
        self._next, self._delay, self._quiet = code, delay, True
        self.due = now + delay

    def wake(self, store: ObjectStore, now: Nanoseconds) -> bool:
        """Do what is due; whether the drive is on the bus, or off it, since then."""
        if now < self.due:
            return False
        if self._next is not None:
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
