"""What the outputs of RARS's plants read, by their names, each with its meaning."""

from collections.abc import Sequence
from typing import Protocol

from fmu.export.model import Expression
from fmu.parts.battery import terminal_voltage
from fmu.parts.motor import Shaft
from fmu.parts.symbols import symbol
from fmu.rars.lift import Lift
from fmu.rars.platform import LEFT, RIGHT
from fmu.rars.steering import Steering
from fmu.rars.symbols import P

Readings = dict[str, tuple[Expression, str]]


class Body(Protocol):
    """A platform's motion in the plane."""

    @property
    def speed(self) -> Expression:
        """Of the rear axle's middle, forwards, m/s."""

    @property
    def yaw_rate(self) -> Expression:
        """Counter-clockwise, rad/s."""


def readings_of(body: Body, steering: Steering, lift: Lift, shafts: Sequence[Shaft]) -> Readings:
    """Return the readings of a robot that drives, steers and lifts."""
    readings: Readings = {
        "x": (symbol("x"), "rear axle's middle, world x"),
        "y": (symbol("y"), "rear axle's middle, world y"),
        "heading": (symbol("heading"), "heading, counter-clockwise from world x"),
        "speed": (body.speed, "speed of the rear axle's middle, forwards"),
        "yaw_rate": (body.yaw_rate, "yaw rate, counter-clockwise"),
        "rack": (steering.rack, "rack, positive steers left"),
        "steer_left": (steering.angle(LEFT), "left front wheel's angle, positive to the left"),
        "steer_right": (steering.angle(RIGHT), "right front wheel's angle, positive to the left"),
        "steer": (steering.inner_angle(), "inner front wheel's angle, positive to the left"),
        "lift_height": (lift.height, "lift above its collapsed height"),
        "battery_voltage": (terminal_voltage(shafts, P), "battery's terminal voltage"),
    }
    for shaft in shafts:
        readings[f"current_{shaft.axis}"] = (shaft.current, f"motor current, {shaft.axis}")
        readings[f"angle_{shaft.axis}"] = (shaft.angle, f"motor shaft's angle, {shaft.axis}")
        readings[f"speed_{shaft.axis}"] = (shaft.speed, f"motor shaft's speed, {shaft.axis}")
    return readings
