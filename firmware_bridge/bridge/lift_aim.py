"""Where the lift shall be in this cycle: a target that travels at the allowed rate, near the platform."""

from typing import Final

from firmware_bridge.drivers.drive import Demand, Position, Stop
from firmware_bridge.motion import lift
from firmware_bridge.robot import Robot, Role
from firmware_bridge.safety.gate import Ruling
from firmware_bridge.units import Nanoseconds, to_seconds

LEASH_S: Final = 0.3
"""How far the target may run ahead, in seconds at the highest rate: near the top the screw is slower than the
rate, and a target that ran away would go on after the stick is let go."""


class LiftAim:
    """The lift's demand, from a height or a rate."""

    __slots__ = ("_axis", "_highest_m", "_lift", "_rate_mps", "_target_m")

    def __init__(self, robot: Robot) -> None:
        self._axis = robot.axis(Role.LIFT)
        self._lift = robot.lift
        self._rate_mps = robot.limits.lift_rate_mps
        self._highest_m = lift.highest(robot.lift)
        self._target_m: float | None = None

    def demand(self, ruling: Ruling, height_m: float | None, elapsed: Nanoseconds) -> Demand:
        """Return the demand for this cycle; without a known height, or without a wish, the lift rests."""
        rests = ruling.lift_m is None and ruling.lift_rate_mps == 0.0
        if not ruling.lifting or height_m is None or rests:
            self._target_m = None
            return Stop.REST
        before = height_m if self._target_m is None else self._target_m
        self._target_m = self._next(before, ruling, height_m, to_seconds(elapsed))
        return Position(lift.lift_quadcounts(self._lift, self._axis, self._target_m))

    def _next(self, before_m: float, ruling: Ruling, height_m: float, seconds: float) -> float:
        if ruling.lift_m is None:
            target = before_m + ruling.lift_rate_mps * seconds
        else:
            reach = self._rate_mps * seconds
            target = min(max(ruling.lift_m, before_m - reach), before_m + reach)
        leash = self._rate_mps * LEASH_S
        target = min(max(target, height_m - leash), height_m + leash)
        return min(max(target, 0.0), self._highest_m)
