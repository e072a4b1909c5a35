"""The trolley on the bench: the input of a mission's step, the figures, the cases of its limit."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Final

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes, TwistAxes
from emulators.bench.cases import Case, Situation
from emulators.bench.columns import Column, Curve, Panel
from emulators.bench.step import Finite, Holds, Step
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import Snapshot

from toy_drive.trolley import Motion

BEYOND: Final = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""


class TrolleyStep(Step):
    """Operator input at one instant."""

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Forward positive; stays until a later step."""


def _stick(values: Mapping[str, float], robot: AnyRobot) -> StickAxes:
    return StickAxes(x=values["speed"] / robot.geometry.limits.speed_mps)


def _nothing(_seen: Snapshot[Any, Any]) -> float:
    """Return 0: a trolley stays on its rail."""
    return 0.0


def _set_point(seen: Snapshot[Any, Any]) -> float:
    return float(seen.commanded.speed_mps)


def _cases(robot: AnyRobot) -> Iterator[Case[Motion, Motion]]:
    limit = robot.geometry.limits.speed_mps
    for sign in (-1.0, 1.0):
        within, beyond = Motion(sign * limit), Motion(sign * BEYOND * limit)
        yield Case(
            "speed limit",
            trips=Situation(command=beyond, commanded=within),
            spares=Situation(command=within, commanded=within),
            reason=f"requested {sign * limit:.2f} m/s, allowed is {sign * limit:.2f} m/s",
        )


BENCH_SETUP: Final = BenchSetup(
    step=TrolleyStep,
    missions=Path(__file__).with_name("missions"),
    channels=(Channel("speed", lambda robot: robot.geometry.limits.speed_mps, trembles_with="speed"),),
    stick=_stick,
    twist=lambda values, _: TwistAxes(values["speed"]),
    columns=(
        Column("x_m", "along the rail", "m", plant="load_angle"),
        Column("speed_mps", "along the rail", "m/s", plant="load_speed"),
        Column("odometry_x_m", "as counted", "m", seen=lambda seen: seen.pose.x_m),
        Column("demanded_speed_mps", "the bridge's set-point", "m/s", seen=_set_point),
        *(
            Column(name, "a trolley stays on its rail", unit, seen=_nothing)
            for name, unit in (
                ("y_m", "m"),
                ("heading_rad", "rad"),
                ("yaw_rate_rad_s", "rad/s"),
                ("odometry_y_m", "m"),
                ("odometry_heading_rad", "rad"),
            )
        ),
    ),
    panels=(
        Panel(
            "Speed along the rail",
            "speed [m/s]",
            (Curve("demanded_speed_mps", "set-point", step=True), Curve("speed_mps", "actual (plant)")),
            limit=lambda robot: (robot.geometry.limits.speed_mps, "m/s"),
            shaded=True,
        ),
    ),
    remarks=lambda _robot: {},
    cases=_cases,
)
