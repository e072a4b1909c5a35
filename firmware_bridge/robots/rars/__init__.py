"""RARS: two driven rear wheels, Davis steering, scissor lift (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

from pathlib import Path
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots.rars.drawing import DRAWING
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.kinematics import BASE, GROUPS, LED, Rars, reach
from firmware_bridge.robots.rars.model import RarsModel
from firmware_bridge.robots.rars.modes import MODES
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.robots.rars.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rars.station import STATION

ROBOT_TYPE: Final[RobotType[RarsGeometry, RarsMotion, RarsState]] = RobotType(
    name="rars",
    file=Path(__file__).with_name("rars.toml"),
    more={name: Path(__file__).with_name(f"{name}.toml") for name in ("cameras", "imu", "thesis")},
    geometry=RarsGeometry,
    standstill=RarsMotion(),
    numbers={
        "speed": lambda motion: motion.speed_mps,
        "steer angle": lambda motion: motion.steer_rad,
        "lift height": lambda motion: motion.lift_m,
        "lift rate": lambda motion: motion.lift_rate_mps,
    },
    kinematics=Rars,
    groups=GROUPS,
    led=LED,
    travelling=frozenset({BASE}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    drawing=DRAWING,
    model=RarsModel,
    modes=MODES,
)


__getattr__ = renamed.module(__name__, __name__, KIND="ROBOT_TYPE")
