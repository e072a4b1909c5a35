"""The parameters that a ground station sees: the robot file's numbers, and telemetry rates that it may set.

Every value is REAL32, so that both ways of carrying integers agree. Limits are read-only here on purpose:
what the interlocks hold is changed in the robot file, by someone who is near the robot.
"""

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.teleop.mavlink import Message, dialect, text_of

NAME_LENGTH: Final = 16


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row: its name on the link, where its first value comes from, and how far it may be set."""

    name: str
    first: Callable[[Robot], float]
    unit: str
    writable: tuple[float, float] | None = None
    """Smallest and largest value that a station may set; None for a read-only row."""
    stream: int | None = None
    """The message whose rate in Hz this row is."""


PARAMETERS: Final = (
    Parameter("WHEEL_R", lambda robot: robot.base.wheel_radius_m, "m"),
    Parameter("TRACK_L", lambda robot: robot.base.rear_track_m, "m"),
    Parameter("BASE_L", lambda robot: robot.base.wheelbase_m, "m"),
    Parameter("KINGPIN_L", lambda robot: robot.base.kingpin_distance_m, "m"),
    Parameter("SPD_MAX", lambda robot: robot.limits.speed_mps, "m/s"),
    Parameter("ACC_MAX", lambda robot: robot.limits.acceleration_mps2, "m/s2"),
    Parameter("STR_MAX", lambda robot: robot.limits.steer_angle_deg, "deg"),
    Parameter("RAD_MIN", lambda robot: robot.limits.turn_radius_m, "m"),
    Parameter("LIFT_RETR", lambda robot: robot.limits.lift_retracted_m, "m"),
    Parameter("LIFT_RATE", lambda robot: robot.limits.lift_rate_mps, "m/s"),
    Parameter("CMD_TMO", lambda robot: robot.operator.silent_ms / 1000.0, "s"),
    Parameter("CYCLE", lambda robot: robot.bus.cycle_ms / 1000.0, "s"),
    Parameter("BAT_VLOW", lambda robot: robot.battery.low_v, "V"),
    Parameter("MAV_SYSID", lambda robot: float(robot.operator.system_id), ""),
    Parameter("MAV_COMPID", lambda robot: float(robot.operator.component_id), ""),
    Parameter("RATE_ODOM", lambda _: 20.0, "Hz", (0.0, 20.0), dialect.MAVLINK_MSG_ID_ODOMETRY),
    Parameter("RATE_POS", lambda _: 20.0, "Hz", (0.0, 20.0), dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED),
    Parameter("RATE_ATT", lambda _: 20.0, "Hz", (0.0, 20.0), dialect.MAVLINK_MSG_ID_ATTITUDE),
)


class Store:
    """The values of one bridge, in the table's order, which never changes while it runs."""

    __slots__ = ("_index", "_values")

    def __init__(self, robot: Robot) -> None:
        self._values = [_as_float32(row.first(robot)) for row in PARAMETERS]
        self._index = {row.name: index for index, row in enumerate(PARAMETERS)}

    def find(self, index: int, name: bytes | str) -> int | None:
        """Return the index that a message means: by name where `index` is -1."""
        if index == -1:
            return self._index.get(text_of(name))
        return index if 0 <= index < len(PARAMETERS) else None

    def change(self, index: int, value: float) -> str | None:
        """Set a value, or return the reason for which the old one stays."""
        row = PARAMETERS[index]
        if row.writable is None:
            return f"{row.name} is read-only; it comes from the robot file"
        low, high = row.writable
        if not (math.isfinite(value) and low <= value <= high):
            return f"{row.name} takes {low:g} to {high:g} {row.unit}".rstrip()
        self._values[index] = _as_float32(value)
        return None

    def rate(self, index: int) -> tuple[int | None, float]:
        """Return the message whose rate this parameter is, and the rate in Hz."""
        return PARAMETERS[index].stream, self._values[index]

    def value(self, index: int) -> float:
        """Return a value as the link carries it."""
        return self._values[index]

    def message(self, index: int) -> Message:
        """Return the PARAM_VALUE of a row."""
        name = PARAMETERS[index].name.encode("ascii")
        kind = dialect.MAV_PARAM_TYPE_REAL32
        return dialect.MAVLink_param_value_message(name, self._values[index], kind, len(PARAMETERS), index)


def _as_float32(value: float) -> float:
    narrow: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return narrow
