"""RARS: two driven rear wheels, Davis steering, scissor lift (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

from pathlib import Path
from typing import Final

from firmware_bridge.kind import Kind
from firmware_bridge.robots.rars.body import BASE, GROUPS, Rars, reach
from firmware_bridge.robots.rars.geometry import Geometry
from firmware_bridge.robots.rars.model import RarsModel
from firmware_bridge.robots.rars.modes import MODES
from firmware_bridge.robots.rars.motion import Motion, State
from firmware_bridge.robots.rars.rules import INTERLOCKS, LIMITS, slowed
from firmware_bridge.robots.rars.station import STATION

KIND: Final[Kind[Geometry, Motion, State]] = Kind(
    name="rars",
    file=Path(__file__).with_name("rars.toml"),
    geometry=Geometry,
    rest=Motion(),
    numbers={
        "speed": lambda motion: motion.speed_mps,
        "steer angle": lambda motion: motion.steer_rad,
        "lift height": lambda motion: motion.lift_m,
        "lift rate": lambda motion: motion.lift_rate_mps,
    },
    body=Rars,
    groups=GROUPS,
    travelling=frozenset({BASE}),
    interlocks=INTERLOCKS,
    limits=LIMITS,
    slowed=slowed,
    reach=reach,
    station=STATION,
    model=RarsModel,
    modes=MODES,
)
