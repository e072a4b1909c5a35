"""Objects that parameterize the servo axis, that report from it, and that rest while it is powered.

The effect of the values is in `emulators.servo.scaling`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from emulators.servo.axis import ELECTRONIC_GEAR, POSITION
from emulators.servo.record import ServoRecord
from emulators.servo.scaling import raw_speed_rpm, speed_rpm
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at

STANDSTILL_WINDOW: Final = Address(0x2101, 1)
STANDSTILL_TIME: Final = Address(0x2101, 2)
SENSOR_POLARITY: Final = Address(0x2210, 4)
MISCELLANEOUS: Final = Address(0x2008)
SENSOR_RESOLUTION: Final = Address(0x202C, 1)
DIGITAL_POSITION: Final = Address(0x2300, 1)


@dataclass(frozen=True, slots=True)
class AxisParameter:
    """An object and the setting that follows it."""

    address: Address
    setting: str


PARAMETERS: Final = (
    AxisParameter(at.ENCODER_PULSES, "encoder_pulses"),
    AxisParameter(at.CURRENT_P, "current_p"),
    AxisParameter(at.CURRENT_I, "current_i"),
    AxisParameter(at.VELOCITY_P, "velocity_p"),
    AxisParameter(at.VELOCITY_I, "velocity_i"),
    AxisParameter(at.VELOCITY_FEEDFORWARD, "velocity_speed_forward"),
    AxisParameter(at.VELOCITY_ACCELERATION_FEEDFORWARD, "velocity_acceleration_forward"),
    AxisParameter(at.POSITION_P, "position_p"),
    AxisParameter(at.POSITION_I, "position_i"),
    AxisParameter(at.POSITION_D, "position_d"),
    AxisParameter(at.POSITION_VELOCITY_FEEDFORWARD, "position_speed_forward"),
    AxisParameter(at.POSITION_ACCELERATION_FEEDFORWARD, "position_acceleration_forward"),
    AxisParameter(at.CONTINUOUS_CURRENT_LIMIT, "continuous_current"),
    AxisParameter(at.OUTPUT_CURRENT_LIMIT, "peak_current"),
    AxisParameter(at.THERMAL_TIME_CONSTANT, "thermal_time"),
    AxisParameter(at.MAX_MOTOR_SPEED, "max_speed"),
    AxisParameter(od.MAX_FOLLOWING_ERROR, "following_error"),
    AxisParameter(od.POSITION_WINDOW, "position_window"),
    AxisParameter(od.POSITION_WINDOW_TIME, "position_window_time"),
    AxisParameter(od.VELOCITY_WINDOW, "velocity_window"),
    AxisParameter(od.VELOCITY_WINDOW_TIME, "velocity_window_time"),
    AxisParameter(STANDSTILL_WINDOW, "standstill_window"),
    AxisParameter(STANDSTILL_TIME, "standstill_time"),
)

ONLY_WITHOUT_POWER: Final = (
    at.ENCODER_PULSES,
    at.SENSOR_TYPE,
    SENSOR_POLARITY,
    od.MOTOR_TYPE,
    MISCELLANEOUS,
)
"""Refused with 0x08000022 while the power stage is on (EPOS Firmware Specification, by analogy)."""


def _signed_16(value: int) -> int:
    # 0x20F4 and 0x6078 are INT16: saturated, for a wrapped value would show the wrong sign.
    return max(-0x8000, min(0x7FFF, value))


def following_error(axis: ServoRecord) -> int:
    """Return demand minus actual position in qc; 0 where no position is regulated."""
    return position_demand(axis) - axis.position if axis.regulator == POSITION else 0


def position_demand(axis: ServoRecord) -> int:
    """Return the position demand in qc; it follows the shaft where no position is regulated."""
    if axis.regulator != POSITION:
        return axis.position
    # Half a count first: the arithmetic shift rounds towards minus infinity.
    return (axis.position_demand + (1 << axis.fraction >> 1)) >> axis.fraction


def velocity_demand(axis: ServoRecord) -> int:
    """Return the velocity demand in rpm; 0 where none is regulated."""
    return speed_rpm(axis, axis.velocity_demand) if axis.powered else 0


def desired_value(axis: ServoRecord) -> int:
    """Return where the digital position input wants the shaft, in qc; the demand while it does not count."""
    if axis.profile != ELECTRONIC_GEAR:
        return position_demand(axis)
    return axis.target_position >> axis.fraction


ACTUAL_VALUES: Final[tuple[tuple[Address, Callable[[ServoRecord], int]], ...]] = (
    (at.ENCODER_COUNTER, lambda axis: axis.encoder + axis.slipped & 0xFFFF_FFFF),
    # The averaged current has 16 binary places.
    (at.CURRENT_AVERAGED, lambda axis: _signed_16((axis.current_average + 0x8000) >> 16)),
    (at.VELOCITY_AVERAGED, lambda axis: speed_rpm(axis, axis.velocity_average)),
    (SENSOR_RESOLUTION, lambda axis: axis.resolution),
    (at.CURRENT_DEMAND, lambda axis: _signed_16(axis.current_demand_ma)),
    (at.ANALOGUE_INPUT_1, lambda axis: _signed_16(axis.analogue_1_mv)),
    (at.ANALOGUE_INPUT_2, lambda axis: _signed_16(axis.analogue_2_mv)),
    (DIGITAL_POSITION, desired_value),
    (at.FOLLOWING_ERROR, lambda axis: _signed_16(following_error(axis))),
    (od.POSITION_DEMAND, position_demand),
    (od.POSITION_ACTUAL, lambda axis: axis.position),
    (od.VELOCITY_DEMAND, velocity_demand),
    # Raw: 1 qc/ms is the resolution, and at 256 pulses 58.6 rpm, as recorded from an EPOS2.
    (od.VELOCITY_ACTUAL, raw_speed_rpm),
    (od.CURRENT_ACTUAL, lambda axis: _signed_16(axis.current_ma)),
)
"""Objects that are read from the axis."""
