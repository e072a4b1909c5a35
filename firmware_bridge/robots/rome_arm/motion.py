"""ROME's motion and state: those of its base, and those of its arm, each in its own words."""

from firmware_bridge.robots.ar2 import motion as arms
from firmware_bridge.robots.rome import motion as bases
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Motion:
    """What the operator commands, what the gate allows, and what the bridge demands."""

    base: bases.Motion = bases.Motion()
    arm: arms.Motion = arms.Motion()
    path_rate: float = 1.0
    """How fast a guide's path goes by; below 1, as it is meant, where the base could not follow."""


@valueclass(frozen=True, slots=True)
class State:
    """What the wheels tell, and what the joints count."""

    base: bases.State
    arm: arms.State
