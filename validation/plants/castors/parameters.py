"""A platform on castors in numbers; [R] is A. P. Das, PhD thesis, IIT Delhi, 2018, 3.2 and 3.3."""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.plants import Plant

TABLE: Final = "[R] Tab. 3.1"

PARAMETERS: Final[tuple[Parameter, ...]] = (
    Parameter("rear_track", 0.4, "m", "l, wheel to wheel", TABLE, least=0.0),
    Parameter("wheel_radius", 0.05, "m", "r, all wheels", TABLE, least=0.0),
    Parameter("centre_offset", 0.22, "m", "a, rear axle to center of mass", TABLE),
    Parameter("pivots_ahead", 0.295, "m", "b, center of mass to the castors' pivots", "assumed"),
    Parameter("pivot_aside", 0.105, "m", "m, middle to pivot", "assumed", least=0.0),
    Parameter("platform_mass", 70.0, "kg", "m_p", "assumed"),
    Parameter("yaw_inertia", 3.2, "kg.m2", "I_p", TABLE),
    Parameter("wheel_mass", 0.3, "kg", "m_w, a driven wheel", "assumed"),
    Parameter("wheel_spin_inertia", 4.65e-4, "kg.m2", "I_w", TABLE),
    Parameter("wheel_yaw_inertia", 2.42e-4, "kg.m2", "H", TABLE),
    Parameter("castor_mass", 0.35, "kg", "m_c, a castor's wheel", "assumed"),
    Parameter("castor_across", 0.0, "m", "d1, pivot beside its wheel", "assumed"),
    Parameter("castor_trail", 0.04, "m", "d2, pivot behind its wheel at a swivel of 0", "assumed"),
)
SETS: Final[Mapping[str, Mapping[str, float]]] = {"offset": {"castor_across": 0.01}}

PLANT: Final = Plant("castors", "validation.plants.castors", PARAMETERS, SETS)
