"""The bench's half of robots with two driven wheels on one axle; packages add what else they have.

Signs and scales are written here again, not taken from the bridge's half: a mistake there is not repeated.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, Final

from emulators.bench.bench_setup import Channel, StickAxes, TwistAxes
from emulators.bench.cases import Case, Situation
from emulators.bench.columns import Column, Curve, Panel
from emulators.bench.step import Finite, Holds, Positive, Slope, Step
from firmware_bridge.differential.kinematics import G, M, S, ramp_of
from firmware_bridge.robot import AnyRobot, Robot
from firmware_bridge.safety.snapshot import Snapshot

JUST: Final = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""


class DifferentialStep(Step):
    """Operator input at one instant; speed and turn stay until a later step.

    A mission's input is one field: its annotation gives the action on the controls.
    """

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Forward positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    turn_deg_s: Annotated[Finite | None, Holds("turn", lambda turn, _: math.radians(turn))] = None
    """Turn rate, to the left positive."""


CHANNELS: Final = (
    Channel("speed", lambda robot: robot.geometry.limits.speed_mps, trembles_with="speed"),
    Channel("turn", lambda robot: robot.geometry.limits.turn_rate_rad_s, trembles_with="speed"),
)


def stick(values: Mapping[str, float], robot: AnyRobot) -> StickAxes:
    """Return the stick for a speed and a turn rate."""
    limits = robot.geometry.limits
    # MAVLink's r is clockwise positive; the mission's turn is to the left.
    return StickAxes(x=values["speed"] / limits.speed_mps, r=-values["turn"] / limits.turn_rate_rad_s)


def twist(values: Mapping[str, float], _robot: AnyRobot) -> TwistAxes:
    """Return the velocity for a speed and a turn rate."""
    return TwistAxes(values["speed"], yaw_rate=-values["turn"])


def remarks(robot: AnyRobot) -> Mapping[str, str]:
    """Return the limits that stand beside the summary's numbers."""
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed_mps:g}",
        "max_acceleration_mps2": f"limit {limits.acceleration_mps2:g}",
    }


def _commanded_speed(seen: Snapshot[Any, Any]) -> float:
    return float(seen.commanded.speed_mps)


def _commanded_turn(seen: Snapshot[Any, Any]) -> float:
    return float(seen.commanded.turn_rad_s)


DEMANDED: Final = (
    Column("demanded_speed_mps", "the bridge's set-points of the wheels", "m/s", seen=_commanded_speed),
    Column("demanded_turn_rad_s", "the bridge's set-points of the wheels", "rad/s", seen=_commanded_turn),
)
SPEED_PANEL: Final = Panel(
    "Forward speed",
    "speed [m/s]",
    (Curve("demanded_speed_mps", "set-point", step=True), Curve("speed_mps", "actual (plant)")),
    limit=lambda robot: (robot.geometry.limits.speed_mps, "m/s"),
    shaded=True,
    height=2.5,
)
TURN_PANEL: Final = Panel(
    "Turn rate, left is positive",
    "turn rate [rad/s]",
    (Curve("demanded_turn_rad_s", "set-point", step=True), Curve("yaw_rate_rad_s", "actual (plant)")),
    limit=lambda robot: (robot.geometry.limits.turn_rate_rad_s, "rad/s"),
    shaded=True,
    height=2.5,
)


def cases(
    robot: Robot[G], motion: Callable[[float, float], M], well: S, *, spin: float, ahead: float = 1.0
) -> Iterator[Case[M, S]]:
    """Yield the cases of the rows that all of them have.

    `well` is the state of a robot that stands and lacks nothing. Where a row of its own clips the way ahead,
    `ahead` is -1, and the turns are driven tail first.
    """
    limits = robot.geometry.limits
    for side in (-1.0, 1.0):
        bound = side * spin * limits.turn_rate_rad_s
        # The next double beyond the bound has to trip the row; the bound itself is spared.
        yield _turns(robot, replace(well, turn_rad_s=math.nextafter(bound, side * math.inf)), bound, well)
        speed, turn = side * limits.speed_mps, side * limits.turn_rate_rad_s
        yield _limited("speed limit", motion(speed, 0.0), motion(JUST * speed, 0.0), (speed, "m/s"))
        yield _limited("turn rate limit", motion(0.0, turn), motion(0.0, JUST * turn), (turn, "rad/s"))
        # Sideways acceleration is v times the turn rate: at full speed this turn is just at its limit.
        speed, turn = ahead * limits.speed_mps, side * limits.sideways_mps2 / limits.speed_mps
        yield _limited("sideways limit", motion(speed, turn), motion(speed, JUST * turn), (speed, "m/s"))
    # Each comparison with NaN is false: a turn rate that is no number must trip the row all the same.
    yield _turns(robot, replace(well, turn_rad_s=math.nan), 0.0, replace(well, speed_mps=limits.speed_mps))
    speed, _ = ramp_of(robot).step((0.0, 0.0), (limits.speed_mps, 0.0), robot.cycle)
    yield Case(
        "acceleration limit",
        trips=Situation(command=motion(2.0 * speed, 0.0)),
        spares=Situation(command=motion(speed, 0.0)),
        reason="requested a step from 0.00 m/s and 0.00 rad/s "
        f"to {2.0 * speed:.2f} m/s and 0.00 rad/s at once",
    )


def _turns(robot: Robot[G], body: S, bound: float, well: S) -> Case[M, S]:
    limit = robot.geometry.limits.turn_rate_rad_s
    return Case(
        "turns too fast",
        trips=Situation(body=body),
        spares=Situation(body=replace(well, turn_rad_s=bound)),
        reason=f"the robot turns with {body.turn_rad_s:.2f} rad/s, limit {limit:.2f} rad/s",
    )


def _limited(row: str, within: M, beyond: M, bound: tuple[float, str]) -> Case[M, S]:
    """Return the case of a limit that is passed at the pace that the robot has already."""
    requested = beyond.turn_rad_s if row == "turn rate limit" else beyond.speed_mps
    value, unit = bound
    allowed = value / JUST if row == "sideways limit" else value
    return Case(
        row,
        trips=Situation(command=beyond, commanded=within),
        spares=Situation(command=within, commanded=within),
        reason=f"requested {requested:.2f} {unit}, allowed is {allowed:.2f} {unit}",
    )
