"""ROME whole: the arm AR2 on its base, a board for each, an orbit for both (A. Seleit, MSc thesis, 2020)."""

from pathlib import Path
from typing import Final

from firmware_bridge.kind import Kind
from firmware_bridge.robots import ar2, rome
from firmware_bridge.robots.rome_arm.body import GROUPS, Body, reach
from firmware_bridge.robots.rome_arm.geometry import Geometry
from firmware_bridge.robots.rome_arm.guide import GUIDES
from firmware_bridge.robots.rome_arm.halves import ARM, BASE
from firmware_bridge.robots.rome_arm.motion import Motion, State
from firmware_bridge.robots.rome_arm.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rome_arm.station import STATION

KIND: Final[Kind[Geometry, Motion, State]] = Kind(
    name="rome_arm",
    file=Path(__file__).with_name("rome_arm.toml"),
    more=dict(rome.KIND.more),
    geometry=Geometry,
    rest=Motion(),
    numbers=BASE.numbers(rome.KIND) | ARM.numbers(ar2.KIND),
    body=Body,
    groups=GROUPS,
    travelling=rome.KIND.travelling | ar2.KIND.travelling,
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    guides=GUIDES,
)
