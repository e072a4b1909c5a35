"""Line and circles of section 4.2.2, driven through the whole chain: command, motion, and odometry.

Ours is the plant's truth. The independent way follows from the profile alone: distance and speed of a
trapezium, and of a circle its radius. The odometry's error is printed for the line alone.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import ODOMETRY, POSE, Samples
from emulators.bench.summary import odometry_errors
from firmware_bridge.robot_types import find
from validation.studies.chain import driven
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

LINE_MPS: Final = 0.240
"""Speed as printed, and 24 mm/s2."""
FROM_TO: Final = (0.1, 0.9)
"""Shares of its speed between which its acceleration is taken."""
BRAKES_S: Final = 15.0
"""Time from its acceleration to braking; the thesis's hold is not printed, assumed 5 s at full speed."""
CIRCLE_MPS: Final = 0.300
CHANGES_S: Final = 125.0
"""Time as printed; the radii are not, assumed."""
RADII_M: Final = (1.0, 1.5)
SETTLED_S: Final = ((15.0, 120.0), (140.0, 240.0))
"""Times in which each circle is driven at its speed."""
QUICK_S: Final = 60.0
PRINTED_ASIDE_MM: Final = 50.0
PRINTED_LONGER: Final = 0.15
"""Odometry at Fig. 4.12, by the text: 300 mm too long on a line of 2000 mm."""
CALIBRATION: Final = (
    "the print's robot rolls on radii 13 % smaller than computed with, 0.76 % apart (derived): as slip it "
    "would take 104 N of drag on a flat floor"
)
DRIFTS: Final = (
    "Of the line the thesis prints how far odometry is off, of the circles (Fig. 4.18, 4.19) only that no "
    "side slip is seen. Here the wheels' tread slips as the plant's floor lets it, the encoders report what "
    "the wheels turn, and the bridge knows the plant's radius and track."
)


@dataclass(frozen=True, slots=True)
class _Run:
    name: str
    samples: Samples
    seconds: Floats
    speed: Floats
    away_m: Floats
    """Distance of the odometry's place from the true one."""
    way_m: Floats

    def ends_off(self, axis: int) -> float:
        """Return how far the odometry's end is from the true one along x (0) or y (1), m."""
        return float(self.samples.column(ODOMETRY[axis])[-1] - self.samples.column(POSE[axis])[-1])

    def off(self) -> tuple[str, float, float, float, float]:
        """Return its row of the table of what odometry is off."""
        end, way = 1e3 * float(self.away_m[-1]), float(self.way_m[-1])
        return self.name, way, end, 1e3 * float(self.away_m.max()), end / (10.0 * way)


def line_and_circles(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    line, circles = _driven("line", None), _driven("circles", QUICK_S if quick else None)
    return Findings(
        compared=(*_of_line(line), *_of_circles(circles, RADII_M[: 1 if quick else 2])),
        plots=(
            Plot(
                "Line: speed",
                "time [s]",
                "speed [m/s]",
                (
                    Curve("plant", line.seconds, line.speed),
                    Curve("demanded", line.seconds, line.samples.column("demanded_speed_mps"), "dashed"),
                ),
                "0 to 240 mm/s at 24 mm/s2 and back (4.2.2).",
            ),
            Plot(
                "Circles: path",
                "x [m]",
                "y [m]",
                (
                    Curve("plant", circles.samples.column(POSE[0]), circles.samples.column(POSE[1])),
                    Curve(
                        "odometry",
                        circles.samples.column(ODOMETRY[0]),
                        circles.samples.column(ODOMETRY[1]),
                        "dashed",
                    ),
                ),
                "300 mm/s; the radius becomes larger at 125 s, as the text at Fig. 4.18 and 4.19 has it.",
                equal=True,
            ),
            Plot(
                "What the odometry is off",
                "way driven [m]",
                "distance from the true place [mm]",
                tuple(Curve(run.name, run.way_m, 1e3 * run.away_m) for run in (line, circles)),
                "Of each run, over its way.",
            ),
        ),
        sheets=(
            Sheet(
                "Odometry",
                ("run", "way [m]", "off at the end [mm]", "at most [mm]", "off, of the way [%]"),
                (line.off(), circles.off()),
            ),
        ),
        remarks=(DRIFTS,),
    )


def _of_line(run: _Run) -> tuple[Compared, ...]:
    # It brakes before it has come to its speed and stayed there for long: a trapezium all the same.
    way = LINE_MPS * BRAKES_S
    first, last = (run.seconds[int(np.argmax(run.speed >= share * LINE_MPS))] for share in FROM_TO)
    gained = (FROM_TO[1] - FROM_TO[0]) * LINE_MPS / float(last - first)
    why = "a set-point comes every 50 ms, and a regulator turns the wheels"
    return (
        Compared("line: speed", "mm/s", 240.0, 240.0, 1e3 * float(run.speed.max()), 3.0, why),
        Compared("line: acceleration", "mm/s2", 24.0, 24.0, 1e3 * gained, 0.5, why),
        Compared("line: way", "m", None, way, float(run.way_m[-1]), 0.02, "slip, and the ramps' steps"),
        Compared("line: way aside", "mm", None, 0.0, 1e3 * float(run.samples.column("y_m")[-1]), 5.0),
        Compared(
            "line: odometry aside", "mm", PRINTED_ASIDE_MM, 0.0, 1e3 * run.ends_off(1), 5.0, CALIBRATION
        ),
        Compared(
            "line: odometry too long",
            "%",
            100.0 * PRINTED_LONGER,
            0.0,
            100.0 * run.ends_off(0) / float(run.way_m[-1]),
            0.5,
            CALIBRATION,
        ),
    )


def _of_circles(run: _Run, radii: tuple[float, ...]) -> tuple[Compared, ...]:
    rows = []
    for radius, (begin, end) in zip(radii, SETTLED_S, strict=False):
        on_it = (run.seconds > begin) & (run.seconds < min(end, float(run.seconds[-1])))
        turns = float(np.mean(run.samples.column("yaw_rate_rad_s")[on_it]))
        goes = float(np.mean(run.speed[on_it]))
        title = f"circle of {radius:g} m"
        why = "the front tyres slip sideways: the robot turns a little less than its wheels point"
        rows += [
            Compared(
                f"{title}: speed", "mm/s", 300.0, 1e3 * CIRCLE_MPS, 1e3 * goes, 4.0, "a hand that trembles"
            ),
            Compared(f"{title}: radius", "m", None, radius, goes / turns, 0.03 * radius, why),
            Compared(
                f"{title}: turn rate",
                "deg/s",
                None,
                math.degrees(CIRCLE_MPS / radius),
                math.degrees(turns),
                0.6,
                why,
            ),
        ]
    return tuple(rows)


def _driven(name: str, seconds: float | None) -> _Run:
    robot = find("rars")
    samples = driven(robot, missions.find(name, robot, bench_setup_of(robot)), seconds).samples
    x, y = (samples.column(column) for column in POSE[:2])
    away = odometry_errors(samples)
    believed = np.isfinite(samples.column(ODOMETRY[0]))
    apart = np.zeros(len(x))
    apart[believed] = away
    way = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    return _Run(name, samples, samples.seconds, samples.column("speed_mps"), apart, way)
