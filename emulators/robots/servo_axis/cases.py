"""The axis's interlocks at the edges of their thresholds; for the inherited tests."""

import math
from collections.abc import Iterator
from typing import Final, TypeAlias

from emulators.bench import cases as bench
from firmware_bridge.robot import Robot
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState

Case: TypeAlias = bench.Case[AxisMotion, AxisState]
Situation: TypeAlias = bench.Situation[AxisMotion, AxisState]
JUST: Final = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""
SLACK: Final = 0.02
REST: Final = AxisState(0.0, 0.0)


def cases(robot: Robot[AxisGeometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    axis, limits = robot.axes[0], robot.geometry.limits
    unit = axis.unit
    for unknown in (None, math.nan):
        yield Case(
            "position unknown",
            trips=Situation(body=AxisState(unknown, 0.0)),
            spares=Situation(body=REST),
            reason="the position of the axis is not known",
        )
    over = JUST * limits.speed
    yield Case(
        "speed limit",
        trips=_moving(AxisMotion(over)),
        spares=_moving(AxisMotion(limits.speed)),
        reason=f"requested {over:.2f} {unit}/s, allowed is {limits.speed:.2f} {unit}/s",
    )
    step = limits.acceleration * robot.cycle_ms / 1000.0
    yield Case(
        "acceleration limit",
        trips=Situation(command=AxisMotion(1.2 * step), body=REST),
        spares=Situation(command=AxisMotion(step), body=REST),
        reason=f"requested a change of {1.2 * step:.3g} {unit}/s at once",
    )
    if axis.travel is None:
        return
    low, high = axis.travel
    slack = SLACK * (high - low)
    for end, sign in ((low, -1.0), (high, 1.0)):
        inside, outside = end + 0.999 * sign * slack, end + 1.001 * sign * slack
        yield Case(
            "axis outside",
            trips=Situation(body=AxisState(outside, 0.0)),
            spares=Situation(body=AxisState(inside, 0.0)),
            reason=f"the axis stands at {outside:.4g} {unit}, its travel is {low:.4g} to {high:.4g} {unit}",
        )
        yield Case(
            "travel limit",
            trips=_moving(AxisMotion(limits.speed, end + sign * 0.1)),
            spares=_moving(AxisMotion(limits.speed, end)),
            reason=f"requested {end + sign * 0.1:.4g} {unit}, allowed is {end:.4g} {unit}",
        )
        yield Case(
            "travel limit",
            trips=_moving(AxisMotion(sign * limits.speed), AxisState(end, 0.0)),
            spares=_moving(AxisMotion(-sign * limits.speed), AxisState(end, 0.0)),
            reason=f"the axis is at the end of its travel, {end:.4g} {unit}",
        )


def _moving(motion: AxisMotion, body: AxisState = REST) -> Situation:
    """Return the situation of an axis that moves so already."""
    return Situation(command=motion, commanded=motion, body=body)
