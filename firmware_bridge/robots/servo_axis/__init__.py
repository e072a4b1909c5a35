"""One axis: a drive with a motor, a gear and a load, by position or by speed, turning or sliding."""

from pathlib import Path
from typing import Final

from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.kinematics import AXIS, GROUPS, ServoAxisKinematics, reach
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.robots.servo_axis.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.servo_axis.station import STATION

ROBOT_TYPE: Final[RobotType[AxisGeometry, AxisMotion, AxisState]] = RobotType(
    name="servo_axis",
    file=Path(__file__).with_name("servo_axis.toml"),
    geometry=AxisGeometry,
    standstill=AxisMotion(),
    numbers={"speed": lambda motion: motion.speed, "target": lambda motion: motion.target},
    kinematics=ServoAxisKinematics,
    groups=GROUPS,
    travelling=frozenset({AXIS}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
)
