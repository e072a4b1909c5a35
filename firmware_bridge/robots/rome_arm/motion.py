"""ROME's motion and state: those of its base, and those of its arm, each in its own terms."""

from firmware_bridge.robots.ar2 import motion as arms
from firmware_bridge.robots.rome import motion as bases
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class Motion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    base: bases.Motion = bases.Motion()
    arm: arms.Motion = arms.Motion()
    path_rate: float = 1.0
    """Rate of a path follower's path; below 1 where the base could not follow at its own pace."""


@valueclass(frozen=True, slots=True)
class State:
    """State of the wheels, measured, and of the joints, counted."""

    base: bases.State
    arm: arms.State
