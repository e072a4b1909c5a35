"""ROME whole: the arm AR2 on its base, a board for each, an orbit for both (A. Seleit, MSc thesis, 2020)."""

from pathlib import Path
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.robot_type import RobotType
from firmware_bridge.robots import ar2, rome
from firmware_bridge.robots.rome_arm.drawing import DRAWING
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE
from firmware_bridge.robots.rome_arm.kinematics import GROUPS, RomeArmKinematics, reach
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState
from firmware_bridge.robots.rome_arm.path_follower import PATH_FOLLOWERS
from firmware_bridge.robots.rome_arm.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rome_arm.station import STATION

ROBOT_TYPE: Final[RobotType[RomeArmGeometry, RomeArmMotion, RomeArmState]] = RobotType(
    name="rome_arm",
    file=Path(__file__).with_name("rome_arm.toml"),
    more=dict(rome.ROBOT_TYPE.more),
    geometry=RomeArmGeometry,
    standstill=RomeArmMotion(),
    numbers=BASE.numbers(rome.ROBOT_TYPE) | ARM.numbers(ar2.ROBOT_TYPE),
    kinematics=RomeArmKinematics,
    groups=GROUPS,
    travelling=rome.ROBOT_TYPE.travelling | ar2.ROBOT_TYPE.travelling,
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    drawing=DRAWING,
    path_followers=PATH_FOLLOWERS,
)


__getattr__ = renamed.module(__name__, __name__, KIND="ROBOT_TYPE")
