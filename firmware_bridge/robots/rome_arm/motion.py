"""ROME's motion and state: those of its base, and those of its arm, each in its own terms."""

from firmware_bridge import renamed
from firmware_bridge.robots.ar2 import motion as arms
from firmware_bridge.robots.rome import motion as bases
from firmware_bridge.value import valueclass


@valueclass(frozen=True, slots=True)
class RomeArmMotion:
    """A motion: the operator's command, the permitted one, or the bridge's set-point."""

    base: bases.RomeMotion = bases.RomeMotion()
    arm: arms.Ar2Motion = arms.Ar2Motion()
    path_rate: float = 1.0
    """Rate of a path follower's path; below 1 where the base could not follow at its own pace."""


@valueclass(frozen=True, slots=True)
class RomeArmState:
    """State of the wheels, measured, and of the joints, counted."""

    base: bases.RomeState
    arm: arms.Ar2State


__getattr__ = renamed.module(__name__, __name__, Motion="RomeArmMotion", State="RomeArmState")
