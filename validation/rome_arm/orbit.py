"""The orbit (4.10): by F and G, by numerical integration, and flown by base and arm through the whole chain.

Ours is the bridge's propagation, and the plant's truth. The independent way is r'' = - r / r^3 in DU and TU
by Runge and Kutta's steps: from it come period, shape and the stretching of time, and the path that is flown.
"""

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.path_error import OFFSET
from firmware_bridge.motion.orbit import THESIS, functions, period, propagated
from firmware_bridge.motion.orbit_elements import elements
from firmware_bridge.motion.orbit_scale import real_seconds
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rome_arm.orbit import PATHS
from validation.studies.chain import driven
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

START: Final = (-0.5985, 1.6634, 0.0279, -0.9523, -0.0639, 0.0110)
"""(4.10) as printed, DU and DU/TU."""
PRINTED_TU: Final = 60.8844
"""Period as printed, of elements with more digits than (4.10) has."""
LASTS_TU: Final = 62.0
EVERY_TU: Final = 0.01
DU_KM: Final = 6378.137
MU_KM3_S2: Final = 398600.4418
USED: Final = 0.9
"""Share of the base's speed and acceleration that a path may ask for, as the bridge has it."""
BEGINS_S: Final = 5.0
"""Time at which the mission lets its path follower fly."""
SETTLES_S: Final = 8.0
WITHIN_MM: Final = 10.0
DEG: Final = math.degrees(1.0)
SCALES: Final = (0.4, 1.0)
"""m for 1 DU."""
BESIDE: Final = "the base begins 0.14 m beside (assumed), and has 8 s to come to its path"
ASSUMED: Final = (
    "The source does not print how many meters 1 DU is: 0.4 m is assumed, for height as for the floor. "
    "At 1 m the base would have to go faster than it can, so the path's time is stretched: the same way, "
    "flown later."
)


@dataclass(frozen=True, slots=True)
class _Flown:
    """A run: seconds since its path follower began, where base and tool were, and where they should be, m."""

    m_per_du: float
    stretch: float
    seconds: Floats
    true: Floats
    meant: Floats

    @property
    def off_mm(self) -> Floats:
        """Distance from the reference at the same instant."""
        apart: Floats = 1e3 * np.linalg.norm(self.true - self.meant, axis=1)
        return apart

    @property
    def settled_mm(self) -> float:
        return float(self.off_mm[self.seconds >= SETTLES_S].max())


def orbit(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    times = np.arange(0.0, LASTS_TU, EVERY_TU)
    apart = integrate(_rates, np.array(START), times, 2)
    looked = slice(None, None, 200 if quick else 20)
    ours = np.array([_ours(at) for at in times[looked]])
    late = np.abs(ours - apart[looked]).max(axis=1)
    wronskian = [abs(_wronskian(at) - 1.0) for at in times[looked]]
    stretches = {scale: _stretch(apart, scale) for scale in SCALES}
    runs = [_fly(SCALES[0], apart, stretches[SCALES[0]], 24.0 if quick else None)]
    runs += (
        []
        if quick
        else [_fly(SCALES[1], apart, stretches[SCALES[1]], BEGINS_S + 61.5 * stretches[SCALES[1]])]
    )
    return Findings(
        compared=(
            *_shape(times, apart),
            Compared(
                "F and G from numerical integration, at most", "DU, DU/TU", None, 0.0, float(late.max()), 1e-9
            ),
            Compared("f g' - f' g less 1, at most", "-", None, 0.0, max(wronskian), 1e-11),
            *(
                Compared(
                    f"stretching of time at {scale:g} m/DU",
                    "-",
                    None,
                    stretch,
                    PATHS["orbit"](_scaled(scale).geometry).stretch,
                    5e-4,
                    "the bridge looks at 720 instants of a revolution",
                )
                for scale, stretch in stretches.items()
            ),
            *(
                Compared(
                    f"furthest from the orbit at {run.m_per_du:g} m/DU, settled",
                    "mm",
                    None,
                    0.0,
                    run.settled_mm,
                    WITHIN_MM,
                    BESIDE,
                )
                for run in runs
            ),
        ),
        plots=(
            *(_from_above(run) for run in runs),
            Plot(
                "Distance from where it should be at the same instant",
                "share of a revolution [-]",
                "distance [mm]",
                tuple(
                    Curve(_named(run), _turns(run)[shown], run.off_mm[shown])
                    for run in runs
                    for shown in [run.seconds >= SETTLES_S]
                ),
                "Base and tool together, by the plant's truth, after the first 8 s, in which it comes from "
                "0.14 m beside.",
            ),
            Plot(
                "Height of the tool above its begin",
                "share of a revolution [-]",
                "height [mm]",
                tuple(
                    curve
                    for run in runs[:1]
                    for curve in (
                        Curve("plant", _turns(run), 1e3 * run.true[:, 2]),
                        Curve("numerical integration", _turns(run), 1e3 * run.meant[:, 2], "dashed"),
                    )
                ),
                "The arm's part of the orbit, inclined by 1°, at 0.4 m/DU.",
            ),
        ),
        sheets=(
            Sheet(
                "Runs",
                ("m/DU", "stretched [-]", "a revolution takes [s]", "settled, at most [mm]", "mean [mm]"),
                tuple(
                    (
                        run.m_per_du,
                        run.stretch,
                        run.stretch * period(THESIS),
                        run.settled_mm,
                        float(run.off_mm[run.seconds >= SETTLES_S].mean()),
                    )
                    for run in runs
                ),
            ),
        ),
        remarks=(ASSUMED,),
    )


def _shape(times: Floats, apart: Floats) -> tuple[Compared, ...]:
    """Return what follows from (4.10): the independent way reads it off the integrated path."""
    away = np.linalg.norm(apart[:, :3], axis=1)
    near, far = _turning(away, -1.0), _turning(away, 1.0)
    size = (near + far) / 2.0
    back = _returns(times, apart)
    normal = np.cross(apart[:, :3], apart[:, 3:]).mean(axis=0)
    orbit, whole = elements(THESIS), period(THESIS)
    tilt = math.atan2(math.hypot(normal[0], normal[1]), normal[2])
    return (
        Compared("semi-major axis", "DU", None, size, orbit.axis, 1e-6, "half of nearest and furthest place"),
        Compared("eccentricity", "-", None, (far - near) / (far + near), orbit.eccentricity, 1e-6),
        Compared("inclination", "°", None, DEG * tilt, DEG * orbit.inclination, 1e-9),
        Compared(
            "period",
            "TU",
            PRINTED_TU,
            back,
            whole,
            1e-6,
            "1 TU is 1 s of the experiment; the rounding of (4.10) spans 60.778 to 60.890",
        ),
        Compared(
            "period about the Earth",
            "h",
            None,
            back * math.sqrt(DU_KM**3 / MU_KM3_S2) / 3600.0,
            real_seconds(whole) / 3600.0,
            1e-6,
        ),
    )


def _rates(_: float, at: Floats) -> Floats:
    return np.concatenate((at[3:], -at[:3] / math.sqrt(at[0] ** 2 + at[1] ** 2 + at[2] ** 2) ** 3))


def _ours(time: float) -> Floats:
    at = propagated(THESIS, float(time))
    return np.concatenate((at.place, at.speed))


def _wronskian(time: float) -> float:
    by = functions(THESIS, float(time))
    return by.f * by.g_rate - by.f_rate * by.g


def _turning(values: Floats, sign: float) -> float:
    """Return the largest value, or the least for a sign of -1, by the parabola through its neighbors."""
    place = int(np.argmax(sign * values[1:-1])) + 1
    before, here, after = values[place - 1 : place + 2]
    return float(here - (after - before) ** 2 / (8.0 * (before - 2.0 * here + after)))


def _returns(times: Floats, apart: Floats) -> float:
    """Return when it comes by its first place again, TU: where the angle from there is 0."""
    ahead = (apart[:, :3] - apart[0, :3]) @ apart[0, 3:]
    last = np.flatnonzero((ahead[:-1] < 0.0) & (ahead[1:] >= 0.0) & (times[1:] > LASTS_TU / 2.0))[-1]
    shown = slice(last - 2, last + 4)
    return float(np.polyval(np.polyfit(ahead[shown], times[shown], 3), 0.0))


def _stretch(apart: Floats, m_per_du: float) -> float:
    """Return how many times its time the path takes, so that the base can follow, at 1 s for 1 TU."""
    limits = find("rome_arm").geometry.base.limits
    speeds = m_per_du * np.hypot(apart[:, 3], apart[:, 4])
    bends = m_per_du * np.hypot(apart[:, 0], apart[:, 1]) / np.linalg.norm(apart[:, :3], axis=1) ** 3
    fastest, hardest = speeds.max() / limits.speed_mps, bends.max() / limits.acceleration_mps2
    return float(max(1.0, fastest / USED, math.sqrt(hardest / USED)))


def _scaled(m_per_du: float) -> Robot[Any]:
    robot: Robot[Any] = find("rome_arm")
    table = robot.geometry.orbit.model_copy(update={"m_per_du": m_per_du})
    return robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"orbit": table})})


def _fly(m_per_du: float, apart: Floats, stretch: float, until_s: float | None) -> _Flown:
    """Fly the mission `orbit`; one that lasts longer keeps flying, without its end."""
    robot = _scaled(m_per_du)
    mission = missions.find("orbit", robot, bench_setup_of(robot))
    if until_s is not None:
        steps = tuple(step for step in mission.step if step.at_s <= BEGINS_S)
        mission = mission.model_copy(update={"step": steps, "duration_s": until_s})
    samples = driven(robot, mission).samples
    rows = np.flatnonzero(np.isfinite(samples.column(OFFSET)))
    seconds = samples.seconds[rows]
    flown = np.maximum(seconds + samples.column(OFFSET)[rows], 0.0) / stretch
    table = robot.geometry.orbit
    sizes = np.array((table.m_per_du, table.m_per_du, table.height_per_du))
    times = EVERY_TU * np.arange(len(apart))
    way = np.array([np.interp(flown, times, apart[:, axis]) - apart[0, axis] for axis in range(3)]).T * sizes
    true = np.array([samples.column(name)[rows] for name in ("x_m", "y_m", "height_m")]).T
    course = float(samples.column("heading_rad")[rows[0]])
    sine, cosine = math.sin(course), math.cos(course)
    turned = np.array(((cosine, sine, 0.0), (-sine, cosine, 0.0), (0.0, 0.0, 1.0)))
    meant = true[0] + (way - np.array((*table.sideways_m, 0.0))) @ turned
    floor = np.array((0.0, 0.0, true[0, 2]))
    return _Flown(m_per_du, stretch, seconds - seconds[0], true - floor, meant - floor)


def _turns(run: _Flown) -> Floats:
    return run.seconds / (run.stretch * period(THESIS))


def _named(run: _Flown) -> str:
    return f"{run.m_per_du:g} m/DU, time x {run.stretch:.3g}"


def _from_above(run: _Flown) -> Plot:
    return Plot(
        f"On the floor, {_named(run)}",
        "x [m]",
        "y [m]",
        (
            Curve("plant, middle of the base", run.true[:, 0], run.true[:, 1]),
            Curve("numerical integration", run.meant[:, 0], run.meant[:, 1], "dashed"),
        ),
        "From where the base stands at its begin, 0.14 m beside the orbit (assumed).",
        equal=True,
    )
