"""The robot: two driven wheels on one axle, two castors."""

from pathlib import Path
from typing import Final

from firmware_bridge.differential.geometry import Geometry
from firmware_bridge.drivers.driver import Level
from firmware_bridge.robot_type import RobotType

from diff_drive.motion import Motion, State
from diff_drive.path_follower import FIGURE_EIGHT, FigureEight
from diff_drive.robot import ROBOT, STATION

LAMP: Final = "lamp"
"""The warning lamp; a robot file without this output has none."""

ROBOT_TYPE: Final[RobotType[Geometry, Motion, State]] = RobotType(
    name="diff_drive",
    file=Path(__file__).with_name("diff_drive.toml"),
    geometry=Geometry,
    standstill=Motion(),
    numbers=ROBOT.numbers,
    kinematics=ROBOT.kinematics,
    groups=ROBOT.groups,
    travelling=ROBOT.travelling,
    # A row of the robot's own stands beside these.
    interlocks=(ROBOT.turns_too_fast,),
    limits=ROBOT.limits,
    slowed=ROBOT.slowed,
    reach=ROBOT.reach,
    drawing=ROBOT.drawing,
    station=STATION,
    path_followers={FIGURE_EIGHT: FigureEight},
    switched=lambda motion: {LAMP: Level(motion.lamp)},
    on_stop={LAMP: Level(on=True)},
)
