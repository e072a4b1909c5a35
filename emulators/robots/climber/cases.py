"""The climber's rows at the edges of their thresholds; the tests that every robot gets go through them."""

import math
from collections.abc import Iterator
from typing import TypeAlias

from emulators.bench import cases as bench
from firmware_bridge.robot import Robot

from firmware_bridge.robots.climber.body import ramp_of
from firmware_bridge.robots.climber.geometry import Geometry
from firmware_bridge.robots.climber.motion import Motion, State
from firmware_bridge.robots.climber.rules import SPIN

Case: TypeAlias = bench.Case[Motion, State]
Situation: TypeAlias = bench.Situation[Motion, State]
JUST: float = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""


def cases(robot: Robot[Geometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    limits = robot.geometry.limits
    for side in (-1.0, 1.0):
        spin = side * SPIN * limits.turn_rate_rad_s
        yield Case(
            "turns too fast",
            trips=Situation(body=State(0.0, math.nextafter(spin, side * math.inf))),
            spares=Situation(body=State(0.0, spin)),
            reason=f"the robot turns with {spin:.2f} rad/s, limit {limits.turn_rate_rad_s:.2f} rad/s",
        )
        yield _limited("speed limit", Motion(side * limits.speed_mps), Motion(side * JUST * limits.speed_mps))
        yield _limited(
            "turn rate limit",
            Motion(turn_rad_s=side * limits.turn_rate_rad_s),
            Motion(turn_rad_s=side * JUST * limits.turn_rate_rad_s),
        )
        turn = side * limits.sideways_mps2 / limits.speed_mps
        yield _limited(
            "sideways limit", Motion(limits.speed_mps, turn), Motion(limits.speed_mps, JUST * turn)
        )
    yield Case(
        "turns too fast",
        trips=Situation(body=State(0.0, math.nan)),
        spares=Situation(body=State(limits.speed_mps, 0.0)),
        reason=f"the robot turns with nan rad/s, limit {limits.turn_rate_rad_s:.2f} rad/s",
    )
    speed, _ = ramp_of(robot).step((0.0, 0.0), (limits.speed_mps, 0.0), robot.cycle)
    yield Case(
        "acceleration limit",
        trips=Situation(wish=Motion(2.0 * speed)),
        spares=Situation(wish=Motion(speed)),
        reason=(f"asked to go from 0.00 m/s and 0.00 rad/s to {2.0 * speed:.2f} m/s and 0.00 rad/s at once"),
    )


def _limited(row: str, within: Motion, beyond: Motion) -> Case:
    """Return the case of a limit that is passed at the pace that the robot has already."""
    asked, allowed, unit = beyond.speed_mps, within.speed_mps, "m/s"
    if row == "turn rate limit":
        asked, allowed, unit = beyond.turn_rad_s, within.turn_rad_s, "rad/s"
    elif row == "sideways limit":
        allowed = within.speed_mps / JUST
    return Case(
        row,
        trips=Situation(wish=beyond, demanded=within),
        spares=Situation(wish=within, demanded=within),
        reason=f"asked for {asked:.2f} {unit}, allowed is {allowed:.2f} {unit}",
    )
