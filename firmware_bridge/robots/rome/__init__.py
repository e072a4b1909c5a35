"""ROME's base: three omni wheels on an Arduino with a motor shield (A. Seleit, MSc thesis, UCF, 2020)."""

from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge.kind import Kind
from firmware_bridge.robots.rome.body import BASE, GROUPS, Body, reach
from firmware_bridge.robots.rome.geometry import Geometry
from firmware_bridge.robots.rome.guide import named
from firmware_bridge.robots.rome.motion import Motion, State
from firmware_bridge.robots.rome.paths import PATHS
from firmware_bridge.robots.rome.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rome.station import STATION

KIND: Final[Kind[Geometry, Motion, State]] = Kind(
    name="rome",
    file=Path(__file__).with_name("rome.toml"),
    more={"cameras": Path(__file__).with_name("cameras.toml")},
    geometry=Geometry,
    rest=Motion(),
    numbers={
        "speed ahead": lambda motion: motion.ahead_mps,
        "speed to the left": lambda motion: motion.left_mps,
        "turn rate": lambda motion: motion.turn_rad_s,
    },
    body=Body,
    groups=GROUPS,
    travelling=frozenset({BASE}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    guides={name: partial(named, name=name) for name in PATHS},
)
