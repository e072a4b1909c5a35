"""ROME's base: three omni wheels on an Arduino with a motor shield (A. Seleit, MSc thesis, UCF, 2020)."""

from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots.rome.drawing import DRAWING
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.kinematics import BASE, GROUPS, RomeKinematics, reach
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.robots.rome.path_follower import named
from firmware_bridge.robots.rome.paths import PATHS
from firmware_bridge.robots.rome.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rome.station import STATION

ROBOT_TYPE: Final[RobotType[RomeGeometry, RomeMotion, RomeState]] = RobotType(
    name="rome",
    file=Path(__file__).with_name("rome.toml"),
    more={"cameras": Path(__file__).with_name("cameras.toml")},
    geometry=RomeGeometry,
    standstill=RomeMotion(),
    numbers={
        "speed ahead": lambda motion: motion.ahead_mps,
        "speed to the left": lambda motion: motion.left_mps,
        "turn rate": lambda motion: motion.turn_rad_s,
    },
    kinematics=RomeKinematics,
    groups=GROUPS,
    travelling=frozenset({BASE}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    drawing=DRAWING,
    path_followers={name: partial(named, name=name) for name in PATHS},
)


__getattr__ = renamed.module(__name__, __name__, KIND="ROBOT_TYPE")
