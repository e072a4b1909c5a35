"""RARS that can tip over in numbers: those of fmu/rars, and where its masses are and what it stands on.

[R] is A. P. Das, "Design and control of a tele-operated mobile platform", PhD thesis, IIT Delhi, 2018.
"assumed" marks what the thesis leaves out.
"""

import math
from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.plants import Plant
from fmu.rars import parameters as base

MASSES: Final[tuple[Parameter, ...]] = (
    Parameter("scissor_mass", 8.0, "kg", "scissor, part of the platform's mass", "assumed; none in [R]"),
    Parameter(
        "table_height", 0.5, "m", "top of the retracted table over the floor", "[R] Tab. 2.1", least=0.0
    ),
    Parameter(
        "payload_ahead",
        0.0,
        "m",
        "payload ahead of the platform's centre of mass",
        "assumed, over which the table's middle lies",
        tunable=True,
    ),
    Parameter("payload_left", 0.0, "m", "payload to the left of the middle", "assumed", tunable=True),
    Parameter(
        "roll_inertia",
        1.18,
        "kg.m2",
        "robot without payload about its centre of mass, long axis",
        "[R] Tab. 3.1, element (1,1); which axis it is, is assumed",
    ),
    Parameter(
        "pitch_inertia",
        1.28,
        "kg.m2",
        "robot without payload about its centre of mass, across",
        "[R] Tab. 3.1, element (2,2); which axis it is, is assumed",
    ),
)

SUPPORT: Final[tuple[Parameter, ...]] = (
    Parameter(
        "slope_heading",
        0.0,
        "rad",
        "uphill direction, counter-clockwise from x of the world",
        "assumed: [R] (3.44) has one direction",
        tunable=True,
    ),
    Parameter(
        "front_track",
        0.336,
        "m",
        "front contact to front contact",
        "2 d of [R] 2.3.1, which is assumed to be the front contacts'",
        least=0.0,
    ),
    Parameter(
        "rear_contact_inset",
        0.0,
        "m",
        "rear wheel's middle to where it carries, inwards",
        "assumed; 0.032 m makes the rectangle of [R] 2.3.1",
        least=0.0,
        most=0.1,
    ),
    Parameter(
        "tip_angle",
        math.radians(60.0),
        "rad",
        "roll or pitch from which on the robot has tipped over",
        "assumed: on the level each load stands unstable below it",
        least=0.1,
        most=1.4,
    ),
)

PARAMETERS: Final[tuple[Parameter, ...]] = base.PARAMETERS + MASSES + SUPPORT

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    **base.SETS,
    "2.3.1": {"centre_offset": 0.141},
    "2.3.1_rectangle": {"centre_offset": 0.141, "wheel_mass": 0.0, "rear_contact_inset": 0.032},
}
"""Named start values: those of fmu/rars; 2.3.1 has the centre of mass that the limits printed there follow
from, and 2.3.1_rectangle the whole of that model: 70 kg with the wheels, on the front contacts' rectangle."""

PLANT: Final = Plant(
    "rars_tipping", "fmu.rars_tipping", PARAMETERS, SETS, base.ROBOT_FILE, made_of=("fmu.rars",)
)
