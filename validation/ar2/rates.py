"""Decay of an error under the law of resolved rates, and ramp and sine of 80 mm through the whole chain.

Ours are the bridge's law, and the plant's truth of the missions `ramp` and `sine`. The independent way is the
law's own promise, e' = - K e, and the courses' own formulas.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.motion.resolved_rate import pose_law, resolved
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2.arm import AR2
from validation.studies.chain import driven
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

HIGH_M: Final = 0.080
LASTS_S: Final = 60.0
"""Duration as printed, (3.24) and (3.25)."""
BEGINS_S: Final = 5.0
"""Time at which the mission lets its path follower move the tool."""
SETTLED_S: Final = 2.0
QUICK_S: Final = 30.0
WANTED_MM: Final = 1.5
GAINS: Final = (3.0, 1.5)
"""1/s, of the robot file; the thesis's own are not printed."""
STANDSTILL: Final = (0.0, -90.0, 90.0, 0.0, 60.0, 0.0)
OFF_M: Final = (0.006, -0.004, 0.005)
STEP_S: Final = 1e-3
AFTER_S: Final = (0.5, 1.0, 2.0)
STEPS: Final = "half steps of the motors, and moves of 72 ms that stand at their end"


@dataclass(frozen=True, slots=True)
class _Course:
    """A course that was driven: seconds since it began, how high the tool was then, and was meant to be."""

    name: str
    seconds: Floats
    true_m: Floats
    meant_m: Floats

    @property
    def off_mm(self) -> Floats:
        return 1e3 * (self.true_m - self.meant_m)


def resolved_rate(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    errors = _decays()
    passed = STEP_S * np.arange(len(errors), dtype=np.float64)
    courses = [_driven(name, QUICK_S if quick else None) for name in ("ramp", "sine")]
    begin = math.hypot(*OFF_M)
    return Findings(
        compared=(
            *(
                Compared(
                    f"error {after:g} s later, gain {GAINS[0]:g} 1/s",
                    "mm",
                    None,
                    1e3 * begin * math.exp(-GAINS[0] * after),
                    1e3 * float(errors[round(after / STEP_S)]),
                    0.01,
                )
                for after in AFTER_S
            ),
            Compared("ramp: slope", "mm/s", 80.0 / 60.0, 80.0 / 60.0, _slope(courses[0]), 0.01, STEPS),
            Compared("sine: amplitude", "mm", 80.0, 80.0, _amplitude(courses[1]), 0.5, STEPS),
            *(
                Compared(
                    f"{course.name}: furthest from its course",
                    "mm",
                    None,
                    0.0,
                    float(np.abs(course.off_mm[course.seconds > SETTLED_S]).max()),
                    WANTED_MM,
                    f"a bound; {STEPS}",
                )
                for course in courses
            ),
        ),
        plots=(
            Plot(
                "Height of the tool",
                "time since it began [s]",
                "above its begin [mm]",
                tuple(
                    curve
                    for course in courses
                    for curve in (
                        Curve(f"{course.name}, plant", course.seconds, 1e3 * course.true_m),
                        Curve(
                            f"{course.name}, (3.24), (3.25)", course.seconds, 1e3 * course.meant_m, "dashed"
                        ),
                    )
                ),
                "80 mm, 60 s, through the whole chain.",
            ),
            Plot(
                "From its course",
                "time since it began [s]",
                "higher than meant [mm]",
                tuple(Curve(course.name, course.seconds, course.off_mm) for course in courses),
                "By the plant's truth.",
            ),
            Plot(
                "How an error dies away",
                "time [s]",
                "error [mm]",
                (
                    Curve("law", passed, 1e3 * errors),
                    Curve(
                        "e' = - K e",
                        passed[::100],
                        1e3 * begin * np.exp(-GAINS[0] * passed[::100]),
                        "points",
                    ),
                ),
                "From 9 mm beside, without limits of speed; K is 3 1/s (assumed).",
            ),
        ),
        sheets=(
            Sheet(
                "Courses through the whole chain",
                ("course", "root mean square [mm]", "at most [mm]"),
                tuple(
                    (
                        course.name,
                        float(np.sqrt(np.mean(course.off_mm**2))),
                        float(np.abs(course.off_mm).max()),
                    )
                    for course in courses
                ),
            ),
        ),
    )


def _decays() -> Floats:
    """Return the error in m, step by step, of a tool whose set-point steps to another place."""
    angles = np.radians(STANDSTILL)
    desired = AR2.pose(angles).copy()
    desired[:3, 3] += OFF_M
    errors = []
    for _ in range(round(max(AFTER_S) / STEP_S) + 1):
        actual = AR2.pose(angles)
        errors.append(math.dist(desired[:3, 3], actual[:3, 3]))
        angles = angles + STEP_S * resolved(AR2, angles, pose_law(desired, actual, np.zeros(6), GAINS)).joints
    return np.array(errors)


def _slope(course: _Course) -> float:
    """Return the ramp's slope in mm/s, fitted to where it rises."""
    rises = (course.seconds > SETTLED_S) & (course.seconds < min(LASTS_S, float(course.seconds[-1])))
    return 1e3 * float(np.polyfit(course.seconds[rises], course.true_m[rises], 1)[0])


def _amplitude(course: _Course) -> float:
    """Return the sine's amplitude in mm, fitted with its phase."""
    within = course.seconds < LASTS_S
    angle = math.tau * course.seconds[within] / LASTS_S
    parts = np.column_stack((np.sin(angle), np.cos(angle)))
    found, *_ = np.linalg.lstsq(parts, course.true_m[within], rcond=None)
    return 1e3 * math.hypot(*found)


def _driven(name: str, seconds: float | None) -> _Course:
    robot = find("ar2")
    samples = driven(robot, missions.find(name, robot, bench_setup_of(robot)), seconds).samples
    since = samples.seconds - BEGINS_S
    on_it = (since >= 0.0) & (since <= LASTS_S)
    seconds_of, height = since[on_it], samples.column("y_m")[on_it]
    share = seconds_of / LASTS_S
    meant = HIGH_M * (share if name == "ramp" else np.sin(math.tau * share))
    return _Course(name, seconds_of, height - float(samples.column("y_m")[~on_it & (since < 0.0)][-1]), meant)
