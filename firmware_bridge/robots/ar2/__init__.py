"""The arm AR2 alone: six joints on stepper motors (Annin Robotics), as ROME carries it."""

from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge.kind import Kind
from firmware_bridge.robots.ar2.body import GROUPS, TOOL, Body, reach
from firmware_bridge.robots.ar2.geometry import Geometry
from firmware_bridge.robots.ar2.guide import COURSES, Follower
from firmware_bridge.robots.ar2.motion import Motion, State
from firmware_bridge.robots.ar2.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.ar2.station import STATION

KIND: Final[Kind[Geometry, Motion, State]] = Kind(
    name="ar2",
    file=Path(__file__).with_name("ar2.toml"),
    geometry=Geometry,
    rest=Motion(),
    numbers={
        "tool's speed ahead": lambda motion: motion.ahead_mps,
        "tool's speed to the left": lambda motion: motion.left_mps,
        "tool's speed upwards": lambda motion: motion.up_mps,
        "tool's turn about x": lambda motion: motion.roll_rad_s,
        "tool's turn about y": lambda motion: motion.pitch_rad_s,
        "tool's turn about z": lambda motion: motion.yaw_rad_s,
    },
    body=Body,
    groups=GROUPS,
    travelling=frozenset({TOOL}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    guides={name: partial(Follower, course=course) for name, course in COURSES.items()},
)
