"""Node number and bit rate of a device on the bus; both may change with a restart."""

from typing import Final

from emulators.canopen.lss_slave import LssSlave
from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import LayerSetting
from emulators.canopen.saved_parameters import SavedParameters
from firmware_bridge.units import NEVER, Nanoseconds

FIRST_NUMBER: Final = 1
"""Number of a device that has none from its hardware and has saved none."""


class Identity:
    """Node number and bit rate in use."""

    def __init__(self, hardware_node: int, bus_rate: int | None, objects: LayerSetting) -> None:
        """Take the number that a switch gives, 0 for none, and the bus' bits a second, None for any."""
        self._hardware_node: Final = hardware_node
        self._objects: Final = objects
        self.node = hardware_node or FIRST_NUMBER
        self.due: Nanoseconds = NEVER
        """Time at which the bit rate changes, or the silence after that ends."""
        self._bus_rate: Final = bus_rate
        self._rate: int | None = bus_rate
        self._next: int | None = None
        self._delay: Nanoseconds = 0
        self._quiet = False

    @property
    def on_bus(self) -> bool:
        """True if the device receives from the bus and is received there."""
        return not self._quiet and (self._bus_rate is None or self._rate == self._bus_rate)

    def restart(self, store: ObjectStore, memory: SavedParameters, lss: LssSlave) -> None:
        """Begin as after power-on: number and bit rate from switch, copy or default, and all objects."""
        lss.pending_node = None
        store.node_id = self._hardware_node or FIRST_NUMBER
        # The number before the objects: the defaults of the COB-IDs contain it.
        self.node = store.node_id = self._hardware_node or memory.saved(self._objects.node_number)
        memory.load()
        self._take(store, memory.saved(self._objects.bit_rate))

    def reset_communication(self, store: ObjectStore, lss: LssSlave) -> None:
        """Take a number that layer setting has left."""
        if not self._hardware_node and lss.pending_node is not None:
            self.node = store.node_id = lss.pending_node

    def switch(self, code: int, delay: Nanoseconds, now: Nanoseconds) -> None:
        """Change the bit rate after a delay, and be quiet for another one."""
        # CiA 305: the delay counts twice, up to the change and from there to the first frame.
        self._next, self._delay, self._quiet = code, delay, True
        self.due = now + delay

    def wake(self, store: ObjectStore, now: Nanoseconds) -> bool:
        """Do what is due; return True if that may have put the device on the bus, or off it."""
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
        store.set(self._objects.bit_rate_in_use, code)
        self._rate = self._objects.bit_rates.get(code)
        self._next, self._quiet, self.due = None, False, NEVER
