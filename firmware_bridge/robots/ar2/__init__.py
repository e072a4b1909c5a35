"""The arm AR2 alone: six joints on stepper motors (Annin Robotics), as ROME carries it."""

from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots.ar2.drawing import DRAWING
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.kinematics import GROUPS, TOOL, Ar2Kinematics, reach
from firmware_bridge.robots.ar2.motion import Ar2Motion, Ar2State
from firmware_bridge.robots.ar2.path_follower import COURSES, LAWS, Ar2PathFollower
from firmware_bridge.robots.ar2.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.ar2.station import STATION

ROBOT_TYPE: Final[RobotType[Ar2Geometry, Ar2Motion, Ar2State]] = RobotType(
    name="ar2",
    file=Path(__file__).with_name("ar2.toml"),
    geometry=Ar2Geometry,
    standstill=Ar2Motion(),
    numbers={
        "tool's speed ahead": lambda motion: motion.ahead_mps,
        "tool's speed to the left": lambda motion: motion.left_mps,
        "tool's speed upwards": lambda motion: motion.up_mps,
        "tool's turn about x": lambda motion: motion.roll_rad_s,
        "tool's turn about y": lambda motion: motion.pitch_rad_s,
        "tool's turn about z": lambda motion: motion.yaw_rad_s,
    },
    kinematics=Ar2Kinematics,
    groups=GROUPS,
    travelling=frozenset({TOOL}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    drawing=DRAWING,
    path_followers={
        **{name: partial(Ar2PathFollower, course=course) for name, course in COURSES.items()},
        **{name: partial(Ar2PathFollower, course=course, law=name) for name, course in LAWS.items()},
    },
)


__getattr__ = renamed.module(__name__, __name__, KIND="ROBOT_TYPE")
