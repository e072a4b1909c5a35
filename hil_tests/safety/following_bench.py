"""One axis of RARS, its follower, and what a test has it do."""

from dataclasses import replace
from typing import Any, Final

from firmware_bridge.drivers.driver import Feedback, Power, SetPoint
from firmware_bridge.robot import Axis
from firmware_bridge.robot.plausibility import Plausibility
from firmware_bridge.robot_types import find
from firmware_bridge.safety.snapshot import Tracking
from firmware_bridge.safety.tracking import TrackingMonitor, bounds_of
from firmware_bridge.units import SECOND, Nanoseconds

RARS: Final = find("rars")
CYCLE: Final = RARS.cycle
WHEEL: Final = next(axis for axis in RARS.axes if axis.name == "left")
STEERING: Final = next(axis for axis in RARS.axes if axis.name == "steer")
SLACK: Final = 0.4
"""rad/s: a 40th of the wheels' top speed."""
GIVES: Final = 0.02
"""Share of the commanded speed, beside it."""


class Axle:
    """One axis, its follower, and what a test has it do."""

    def __init__(self, axis: Axis = WHEEL, **plausibility: Any) -> None:
        self.axis = axis.model_copy(update={"plausibility": Plausibility(**plausibility)})
        self.follower = TrackingMonitor(self.axis, bounds_of(RARS, self.axis))
        self.now: Nanoseconds = SECOND
        self.position = 0.0
        self.does(0.0)

    def commanded(self, set_point: SetPoint) -> None:
        """Send it a set-point."""
        self.follower.on_set_point(set_point, self.now)

    def does(self, speed: float, cycles: int = 1, power: Power = Power.ON, **changed: Any) -> Tracking:
        """Let it move with a speed for some cycles; return what is known then."""
        for _ in range(cycles):
            self.now += CYCLE
            self.position += speed * CYCLE / SECOND
            known = self.known(speed, power, **changed)
        return known

    def known(self, speed: float, power: Power = Power.ON, **changed: Any) -> Tracking:
        """Show the newest sample."""
        seen = Feedback(self.axis.name, power, self.now, self.now, position=self.position, velocity=speed)
        return self.follower.saw(replace(seen, **changed))

    def known_later(self, speed: float) -> Tracking:
        """Show a cycle later a speed, and the same place."""
        self.now += CYCLE
        return self.known(speed)

    def deviates(self, speed: float, **changed: Any) -> bool:
        """Return True if one more cycle with this speed is beside its range."""
        known = self.does(speed, **changed)
        return known.obeyed_at != known.sampled_at


def still(set_point: SetPoint, axis: Axis = WHEEL, **plausibility: Any) -> Axle:
    """Return an axis that stood for two seconds and then received this set-point, long ago."""
    one = Axle(axis, **plausibility)
    one.does(0.0, 40)
    one.commanded(set_point)
    return one


def settled(set_point: SetPoint, speed: float) -> Axle:
    """Return a wheel that has followed a set-point for so long that its range has shrunk to it."""
    one = still(set_point)
    one.does(speed, 200)
    return one
