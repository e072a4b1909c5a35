"""Pure pursuit over a slow link with and without the predictor, through the whole chain, [R] 6.1.

Ours is the mission `pursuit`: station, link, bridge, bus, drives and plant, by the plant's truth. What is
expected: a loop whose delay is foreseen settles on its path, as one without delay does; one whose delay is
above the critical one swings.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import ODOMETRY, POSE
from emulators.bench.mission import Mission
from emulators.bench.piloted import Pilot
from firmware_bridge.pilot.pursuit import critical_delay_s
from firmware_bridge.robot_types import find
from validation.studies.chain import driven
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

RADIUS: Final = 5.0
SPEED: Final = 0.5
LOOK_AHEAD: Final = 0.5
BESIDE_M: Final = 0.010
MOVES_MPS: Final = 0.01
SETTLES_S: Final = 20.0
WITHIN_MM: Final = 10.0
BELIEVED_MM: Final = 1.0
UNKNOWN_S: Final = 0.1
SETTLED: Final = "half of peak to peak from 20 s on; what is left is the odometry's drift"
NOTE: Final = (
    "Without the predictor 0.5 s and 0.8 s with the chain's own lag are above the critical delay of "
    "{critical:.3f} s: there RARS, which cannot turn tighter than 0.415 m, swings wider than the ideal robot "
    "of `study delay`, or loses its path for a while. How wide has no closed "
    "form, so it stands in the table without a bound."
)


@dataclass(frozen=True, slots=True)
class _Case:
    """One drive: delay there and back, s; a lag of the hand that no model knows, s."""

    delay_s: float
    predictor: bool
    unknown_s: float = 0.0

    @property
    def name(self) -> str:
        with_it = "predictor" if self.predictor else "no predictor"
        return f"{self.delay_s:g} s, {with_it}" + (
            f", {self.unknown_s:g} s unknown" if self.unknown_s else ""
        )


CASES: Final = (
    *(_Case(delay, predictor) for predictor in (False, True) for delay in (0.0, 0.5, 0.8)),
    _Case(0.8, True, UNKNOWN_S),  # noqa: FBT003 - in the order of its fields
)
QUICK: Final = (CASES[2], CASES[5])


@dataclass(frozen=True, slots=True)
class _Run:
    case: _Case
    seconds: Floats
    away_mm: Floats
    """Further from the center than the circle."""
    swing_mm: float
    believed_mm: float
    """The swing by the robot's odometry, by which it is driven."""


def predictor(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    runs = [_run(case, 32.0 if quick else None) for case in (QUICK if quick else CASES)]
    quiet = [run for run in runs if run.case.predictor or run.case.delay_s == 0.0]
    return Findings(
        compared=tuple(
            row
            for run in quiet
            for row in (
                Compared(f"swing, {run.case.name}", "mm", None, 0.0, run.swing_mm, WITHIN_MM, SETTLED),
                Compared("... by its odometry", "mm", None, 0.0, run.believed_mm, BELIEVED_MM),
            )
        ),
        plots=(
            Plot(
                "Without the predictor",
                "time since it drives [s]",
                "outside the circle of 5 m [mm]",
                tuple(_drawn(run) for run in runs if not run.case.predictor),
                "0.5 m/s, look-ahead 0.5 m, from 10 mm beside the circle (assumed); by the plant's truth.",
            ),
            Plot(
                "With the predictor",
                "time since it drives [s]",
                "outside the circle of 5 m [mm]",
                tuple(_drawn(run) for run in runs if run.case.predictor),
                "The same start. What is left is the drift of the odometry, by which it is driven. The "
                "hand's lag of 0.1 s is not in the predictor's model.",
            ),
        ),
        sheets=(
            Sheet(
                "Swing after 20 s, half of peak to peak",
                (
                    "link there and back [s]",
                    "predictor",
                    "lag not in the model [s]",
                    "swing [mm]",
                    "by its odometry [mm]",
                ),
                tuple(
                    (
                        run.case.delay_s,
                        "yes" if run.case.predictor else "no",
                        run.case.unknown_s,
                        run.swing_mm,
                        run.believed_mm,
                    )
                    for run in runs
                ),
            ),
        ),
        remarks=(NOTE.format(critical=critical_delay_s(SPEED, LOOK_AHEAD)),),
    )


def _run(case: _Case, until_s: float | None) -> _Run:
    samples = driven(find("rars"), _mission(case), until_s).samples
    at, moves = samples.seconds, np.abs(samples.column("speed_mps")) > MOVES_MPS
    began, ended = at[moves][0], at[moves][-1]
    shown = (at >= began) & (at <= ended)
    seconds = at[shown] - began
    true, believed = (
        1e3 * (np.hypot(samples.column(x)[shown], samples.column(y)[shown] - RADIUS + BESIDE_M) - RADIUS)
        for x, y, _ in (POSE, ODOMETRY)
    )
    swings = (float(np.ptp(away[seconds >= SETTLES_S])) / 2.0 for away in (true, believed))
    return _Run(case, seconds, true, *swings)


def _mission(case: _Case) -> Mission:
    """Return the mission `pursuit` over this link, with this pilot."""
    robot = find("rars")
    mission = missions.find("pursuit", robot, bench_setup_of(robot))
    pilot = Pilot(
        path="circle",
        size_m=RADIUS,
        speed_mps=SPEED,
        look_ahead_m=LOOK_AHEAD,
        offset_m=BESIDE_M,
        predictor=case.predictor,
        reaction_s=case.unknown_s,
    )
    return mission.model_copy(update={"pilot": pilot, "link": f"delay={case.delay_s:g}"})


def _drawn(run: _Run) -> Curve:
    return Curve(run.case.name, run.seconds[::5], run.away_mm[::5])
