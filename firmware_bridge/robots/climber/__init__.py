"""A climbing robot: two magnetic wheels, a joint, a caster, on a tank (Qualls et al., JAMRIS 10(3), 2016)."""

from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots.climber.drawing import DRAWING
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.kinematics import CLIMBER
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.open_loop import OPEN_LOOP, OpenLoopFollower
from firmware_bridge.robots.climber.path_follower import ClimberPathFollower
from firmware_bridge.robots.climber.paths import PATHS
from firmware_bridge.robots.climber.rules import INTERLOCKS, LIMITS
from firmware_bridge.robots.climber.station import STATION
from firmware_bridge.robots.climber.surface import unrolled

ROBOT_TYPE: Final[RobotType[ClimberGeometry, ClimberMotion, ClimberState]] = RobotType(
    name="climber",
    file=Path(__file__).with_name("climber.toml"),
    more={"cameras": Path(__file__).with_name("cameras.toml")},
    geometry=ClimberGeometry,
    standstill=ClimberMotion(),
    numbers=CLIMBER.numbers,
    kinematics=CLIMBER.kinematics,
    groups=CLIMBER.groups,
    travelling=CLIMBER.travelling,
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=CLIMBER.slowed,
    reach=CLIMBER.reach,
    station=STATION,
    drawing=DRAWING,
    unrolled=lambda robot: partial(unrolled, robot.geometry),
    path_followers={
        **{name: partial(ClimberPathFollower, name=name) for name in PATHS},
        **{name: partial(OpenLoopFollower, name=name) for name in OPEN_LOOP},
    },
)


__getattr__ = renamed.module(__name__, __name__, KIND="ROBOT_TYPE")
