"""Sensors of an axis by its objects: the fitted ones, their supervision, and the position's range.

Sources: EPOS Firmware Specification (by analogy): index and hall sensors, 0x2008 bit 0 switches the
supervision of the position sensor off; EDS and maxon's library for the codes in 0x2210 and 0x6402. Where they
are silent: hall sensors belong to a brushless motor, whatever the position sensor is; their angle is
supervised in sinus commutation only, and not with inverted hall sensors; a dual loop is any controller
structure but 0.
"""

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.axis_parameters import MISCELLANEOUS, SENSOR_POLARITY
from emulators.servo.axis import ServoAxis
from emulators.servo.sensors import hall_pattern
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode

CONTROLLER_STRUCTURE: Final = Address(0x2220)
HALL_PATTERN: Final = Address(0x2022)
ENCODER_INVERTED: Final = 1 << 0
HALL_INVERTED: Final = 1 << 1
UNSUPERVISED: Final = 1 << 0
"""Bit of 0x2008."""
WITH_INDEX: Final = (1, 6)
"""0x2210:2, position sensors that have an index."""
ABSOLUTE: Final = (4, 8)
"""Codes of 0x2210:2, SSI and sinus encoders: they report a position, not steps."""
HALL_ONLY: Final = 3
SINUS: Final = 10
BRUSHLESS: Final = (10, 11)
"""0x6402."""

_SHAPING: Final = (
    MISCELLANEOUS,
    at.SENSOR_TYPE,
    SENSOR_POLARITY,
    od.MOTOR_TYPE,
    at.POLE_PAIRS,
    CONTROLLER_STRUCTURE,
    od.MIN_POSITION_LIMIT,
    od.MAX_POSITION_LIMIT,
    od.MODE,
)


class Sensing:
    """The axis' sensors as the objects describe them."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self._store = store
        self._axis = axis
        for address in _SHAPING:
            store.on_write(address, partial(self._take, address))
        store.on_read(HALL_PATTERN, partial(hall_pattern, axis))

    def apply(self, changed: Mapping[Address, int] = MappingProxyType({})) -> None:
        """Describe the sensors to the axis again; `changed` wins over what the store still has."""

        def value(address: Address) -> int:
            return changed[address] if address in changed else self._store.get(address)

        axis, kind, motor = self._axis, value(at.SENSOR_TYPE), value(od.MOTOR_TYPE)
        inverted = value(SENSOR_POLARITY)
        supervised = not value(MISCELLANEOUS) & UNSUPERVISED
        axis.encoder_reversed = int(bool(inverted & ENCODER_INVERTED))
        # Hall sensors alone (type 3) have no encoder cable that could be supervised.
        axis.encoder_supervised = int(supervised and kind != HALL_ONLY)
        axis.index_supervised = int(kind in WITH_INDEX)
        axis.hall_pole_pairs = max(1, value(at.POLE_PAIRS)) if motor in BRUSHLESS else 0
        axis.hall_angle_supervised = int(motor == SINUS and not inverted & HALL_INVERTED)
        axis.auxiliary_supervised = int(value(CONTROLLER_STRUCTURE) != 0)
        axis.lowest_qc, axis.highest_qc = value(od.MIN_POSITION_LIMIT), value(od.MAX_POSITION_LIMIT)
        # 0x607D does not count in homing (Firmware Specification 9.3): the position has no reference yet.
        axis.position_limited = int(value(od.MODE) != Mode.HOMING)

    def _take(self, address: Address, value: int) -> None:
        self.apply({address: value})
