"""The EPOS2's homing mode: its methods, and the objects that they need beside those of CiA 402."""

from collections.abc import Mapping
from typing import ClassVar, Final

from emulators.canopen.homing_methods import HomingMove
from emulators.drive.homing import HomingMode
from emulators.epos2.modes.homing_methods import METHODS
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire import address as at

SENSORS_WITH_INDEX: Final = frozenset({1, 6})
"""Sensor types 0x2210:2 (maxon's command library)."""


class MaxonHoming(HomingMode):
    """Homing by the method in 0x6098. A switch is a pin with its function; a pin may have none.

    Assumed: the offset 0x607C is a signed distance from the reference.
    """

    methods: ClassVar[Mapping[int, tuple[HomingMove, ...]]] = METHODS

    @property
    def has_index(self) -> bool:
        """True if 0x2210:2 has a sensor with index."""
        return self.shaft.store.get(at.SENSOR_TYPE) in SENSORS_WITH_INDEX

    @property
    def home_position(self) -> int:
        """0x2081, qc."""
        return self.shaft.store.get(at.HOME_POSITION)

    @property
    def moved_offset(self) -> int:
        """0x607C, qc."""
        return self.shaft.store.get(od.HOME_OFFSET)

    @property
    def stop_current_ma(self) -> int:
        """0x2080."""
        return self.shaft.store.get(at.HOMING_CURRENT)
