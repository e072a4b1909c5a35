"""The robot: two driven wheels on one axle, two castors."""

from pathlib import Path
from typing import Final

from firmware_bridge.drivers.driver import Level
from firmware_bridge.kind import Kind

from carrier.body import BASE, GROUPS, Body, reach
from carrier.geometry import Geometry
from carrier.guide import FIGURE_EIGHT, FigureEight
from carrier.motion import Motion, State
from carrier.rules import INTERLOCKS, LIMITS, slowed
from carrier.station import STATION

LAMP: Final = "lamp"
"""The warning lamp; a robot file without this output has none."""

KIND: Final[Kind[Geometry, Motion, State]] = Kind(
    name="carrier",
    file=Path(__file__).with_name("carrier.toml"),
    geometry=Geometry,
    rest=Motion(),
    numbers={
        "speed": lambda motion: motion.speed_mps,
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
    guides={FIGURE_EIGHT: FigureEight},
    switched=lambda motion: {LAMP: Level(motion.lamp)},
    on_stop={LAMP: Level(on=True)},
)
