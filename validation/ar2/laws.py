"""Open loop, PI and PID of the tool's position, through the whole chain; and the tool's workspace.

Ours are the bridge's path follower, and the plant's truth of the missions `ramp_open`, `sine_pi`, `orbit_z`.
Independent are the courses' own formulas, the closed form of the error's equation
(1 + K_d) e'' + K_p e' + K_i e = 0, and three joints in their plane under the same law, cycle by cycle.
"""

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.resolved_rate import PoseControl, PoseGains, resolved
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.kinematics import Ar2Kinematics
from firmware_bridge.robots.ar2.motion import STILL, Ar2Motion, Ar2State
from firmware_bridge.robots.ar2.path_follower import LAWS, Ar2PathFollower
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.units import from_seconds
from validation.ar2 import workspace
from validation.studies.chain import driven
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

HIGH_M: Final = 0.080
LASTS_S: Final = 60.0
"""As printed, (3.24) and (3.25)."""
BEGINS_S: Final = 5.0
"""Time at which the missions let the path follower move the tool."""
QUICK_S: Final = 25.0
CYCLE_S: Final = 0.1
STANDSTILL: Final = (0.0, -90.0, 90.0, 0.0, 60.0, 0.0)
OFF_M: Final = (0.006, -0.004, 0.005)
STEP_S: Final = 1e-3
AFTER_S: Final = (0.5, 1.0, 2.0)
M_PER_DU: Final = 0.9
"""Height scale of the orbit; assumed, as all gains are."""
PLACE_DU: Final = np.array((-0.5985, 1.6634, 0.0279))
SPEED_DU_TU: Final = np.array((-0.9523, -0.0639, 0.0110))
"""(4.10); 1 TU is 1 s."""
PRINTED_MM: Final = 1.0
"""About so much is the sine's mean error in print (Fig. 3.10)."""
STEPS: Final = "half steps of the motors, and moves of 72 ms that stand at their end"
LAW: Final = {
    "ramp_open": PoseGains(0.0, 0.0),
    "sine_pi": PoseGains(3.0, 1.5, 1.0),
    "orbit_z": PoseGains(3.0, 1.5, 1.0, 0.2),
}
"""The gains of the robot file, written here again: assumed, the print has none."""
TITLES: Final = {"ramp_open": "open loop", "sine_pi": "PI", "orbit_z": "PID"}


class Motion(NamedTuple):
    """Heights above the begin, m, and speeds upwards, m/s, a number for each instant."""

    height: Floats
    speed: Floats


def _ramp(seconds: Floats) -> Motion:
    rises = seconds < LASTS_S
    return Motion(np.minimum(HIGH_M / LASTS_S * seconds, HIGH_M), np.where(rises, HIGH_M / LASTS_S, 0.0))


def _sine(seconds: Floats) -> Motion:
    rate = math.tau / LASTS_S
    height, speed = HIGH_M * np.sin(rate * seconds), HIGH_M * rate * np.cos(rate * seconds)
    return Motion(np.where(seconds < LASTS_S, height, 0.0), np.where(seconds < LASTS_S, speed, 0.0))


def _orbit(seconds: Floats) -> Motion:
    """Return z of r'' = - r / r^3 from (4.10), by Runge and Kutta's steps."""

    def rates(_: float, at: Floats) -> Floats:
        return np.concatenate((at[3:], -at[:3] / np.linalg.norm(at[:3]) ** 3))

    times = np.concatenate(((0.0,), seconds))
    found = integrate(rates, np.concatenate((PLACE_DU, SPEED_DU_TU)), times, 2)[1:]
    return Motion(M_PER_DU * (found[:, 2] - PLACE_DU[2]), M_PER_DU * found[:, 5])


COURSES: Final[Mapping[str, Callable[[Floats], Motion]]] = {
    "ramp_open": _ramp,
    "sine_pi": _sine,
    "orbit_z": _orbit,
}
REMARKS: Final = (
    "No gain is printed: all are assumed, and so is the orbit's scale of 0.9 m for 1 DU.",
    (
        "The law counts the joints' set-points as their positions, because nothing measures them: it takes "
        "away what limits and cycles leave of the error, and sees neither play nor bending of the arm."
    ),
    (
        "In print the error is largest near the turning points. The plant's gears are stiff and have no "
        "play: here it is largest where the tool is fast, by the length of a move."
    ),
    (
        "In print the middle about the first axis stays empty. With the public limits of the AR2 it does "
        "below 0.45 m; above, the arm reaches back over its first axis."
    ),
)


@dataclass(frozen=True, slots=True)
class Drive:
    """A course that was driven: seconds since it began, and the tool's heights above its begin, m."""

    name: str
    seconds: Floats
    true_m: Floats
    meant_m: Floats

    @property
    def off_mm(self) -> Floats:
        """Height above the meant one, mm."""
        return 1e3 * (self.true_m - self.meant_m)

    @property
    def mean_mm(self) -> float:
        """Mean distance from the course."""
        return float(np.abs(self.off_mm).mean())

    @property
    def most_mm(self) -> float:
        """Largest distance from the course."""
        return float(np.abs(self.off_mm).max())


def laws(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    drives = [drive(name, QUICK_S if quick else None) for name in COURSES]
    errors = {name: decay(gains) for name, gains in LAW.items()}
    reached = workspace.random_places(workspace.MANY)
    return Findings(
        compared=(
            *_decay_rows(errors),
            *_set_point_rows(),
            *_drive_rows(drives),
            *workspace.compared(reached),
        ),
        plots=(*_drive_plots(drives), _decay_plot(errors), *workspace.plots(reached)),
        sheets=(
            Sheet(
                "Laws through the whole chain",
                ("mission", "law", "mean distance [mm]", "at most [mm]"),
                tuple((it.name, TITLES[it.name], it.mean_mm, it.most_mm) for it in drives),
            ),
            Sheet(
                "Least distance of the tool from the first axis, by its height",
                ("height [m]", "20,000 random places [mm]", "grid [mm]"),
                workspace.by_height(reached),
            ),
        ),
        remarks=REMARKS,
    )


def drive(name: str, seconds: float | None = None) -> Drive:
    """Drive a mission through the whole chain, for so many seconds or to its end."""
    robot = find("ar2")
    samples = driven(robot, missions.find(name, robot, bench_setup_of(robot)), seconds).samples
    since = samples.seconds - BEGINS_S
    on_it = (since >= 0.0) & (since <= LASTS_S)
    height = samples.column("y_m")
    meant = COURSES[name](since[on_it]).height
    return Drive(name, since[on_it], height[on_it] - float(height[since < 0.0][-1]), meant)


def followed(name: str, seconds: float = LASTS_S) -> Floats:
    """Return the tool's places by the path follower's set-points, m, a row a cycle, without interlocks."""
    robot = find("ar2")
    path_follower, body = Ar2PathFollower(robot, LAWS[name], name), Ar2Kinematics(robot)
    state, commanded = Ar2State(tuple(map(math.radians, STANDSTILL)), STILL), Ar2Motion()
    places = []
    for tick in range(round(seconds / CYCLE_S) + 1):
        places.append(AR2.pose(state.angles)[:3, 3])
        facts = Facts(tick * robot.cycle, True, False, 0, True, {}, {}, {})  # noqa: FBT003 - by its fields
        seen = Snapshot(facts=facts, command=commanded, commanded=commanded, body=state, pose=Pose())
        command = path_follower.command(seen, robot.cycle)
        commanded = body.ramped(commanded, command, state, from_seconds(CYCLE_S))
        state = Ar2State(commanded.angles or state.angles, STILL)
    return np.array(places)


def in_plane(name: str, seconds: float = LASTS_S) -> Floats:
    """Return the same by the joints 2, 3 and 5 in their plane: x and z in m, a row a cycle."""
    gains, (shoulder, elbow, bend) = LAW[name], np.radians((-90.0, 90.0, 60.0))
    meant = COURSES[name](CYCLE_S * np.arange(round(seconds / CYCLE_S) + 1, dtype=np.float64))
    total, last, places = np.zeros(2), np.zeros(2), []
    for height, speed in zip(*meant, strict=True):
        upper, fore, tool = (
            size * np.array((math.cos(angle), -math.sin(angle)))
            for size, angle in (
                (workspace.UPPER_M, shoulder),
                (workspace.FORE_M, shoulder + elbow),
                (workspace.TOOL_M, shoulder + elbow + bend),
            )
        )
        place = np.array((workspace.SHOULDER_M, workspace.HIGH_M)) + upper + fore + tool
        places.append(place)
        error = places[0] + (0.0, height) - place
        total = total + CYCLE_S * error
        wanted = np.array((0.0, speed)) + gains.kp_per_s * error + gains.ki_per_s2 * total
        wanted = wanted + gains.kd * (error - last) / CYCLE_S
        last = error
        # The tool does not turn: its angle, the sum of all three, stays, so it goes as the wrist does.
        sides = np.array([(it[1], -it[0]) for it in (upper, fore)]).T
        one, both = np.linalg.solve(sides, wanted)
        shoulder, elbow, bend = (
            shoulder + CYCLE_S * one,
            elbow + CYCLE_S * (both - one),
            bend - CYCLE_S * both,
        )
    return np.array(places)


def decay(gains: PoseGains, seconds: float = AFTER_S[-1]) -> Floats:
    """Return the error in m, step by step, of a tool beside a place that stays, by the law through J+."""
    angles, control = np.radians(STANDSTILL), PoseControl(gains)
    desired = AR2.pose(angles).copy()
    desired[:3, 3] += OFF_M
    errors = []
    for _ in range(round(seconds / STEP_S) + 1):
        actual = AR2.pose(angles)
        errors.append(float((desired[:3, 3] - actual[:3, 3]) @ OFF_M) / math.hypot(*OFF_M))
        twist = control.twist(desired, actual, np.zeros(6), STEP_S)
        angles = angles + STEP_S * resolved(AR2, angles, twist).joints
    return np.array(errors)


def decayed(gains: PoseGains, seconds: Floats) -> Floats:
    """Return the same in closed form: (1 + K_d) e'' + K_p e' + K_i e = 0, with no integral at its begin."""
    begin = math.hypot(*OFF_M)
    if not gains.kp_per_s:
        return np.full_like(seconds, begin)
    half, stiff = gains.kp_per_s / (1.0 + gains.kd) / 2.0, gains.ki_per_s2 / (1.0 + gains.kd)
    swing = cmath.sqrt(half**2 - stiff)
    one, other = -half + swing, -half - swing
    # The integral is 0 at the begin, so e'(0) = - K_p e(0) / (1 + K_d) there.
    way = (one * np.exp(one * seconds) - other * np.exp(other * seconds)) / (one - other)
    return np.asarray(begin * way.real)


def _decay_rows(errors: Mapping[str, Floats]) -> tuple[Compared, ...]:
    return tuple(
        Compared(
            f"{TITLES[name]}: error {after:g} s later",
            "mm",
            None,
            1e3 * float(decayed(gains, np.array((after,)))[0]),
            1e3 * float(errors[name][round(after / STEP_S)]),
            0.02,
        )
        for name, gains in LAW.items()
        for after in AFTER_S
    )


def _set_point_rows() -> tuple[Compared, ...]:
    """Compare the set-points' largest distance from their course, which only the law and its cycle leave."""
    rows = []
    for name in COURSES:
        ours, plane = followed(name), in_plane(name)
        meant = COURSES[name](CYCLE_S * np.arange(len(ours), dtype=np.float64)).height
        there, here = (
            1e3 * float(np.abs(it - it[0] - meant).max()) for it in (plane[:, 1], np.asarray(ours[:, 2]))
        )
        what = f"{name}: set-points furthest from their course"
        rows.append(Compared(what, "mm", None, there, here, 1e-4))
    return tuple(rows)


def _drive_rows(drives: list[Drive]) -> tuple[Compared, ...]:
    ramp, sine, orbit = drives
    rows = [
        Compared("ramp_open: slope", "mm/s", 80.0 / 60.0, 80.0 / 60.0, _slope(ramp), 0.01, STEPS),
        Compared("sine_pi: amplitude", "mm", 80.0, 80.0, _amplitude(sine), 0.5, STEPS),
        Compared(
            "orbit_z: lowest height",
            "mm",
            None,
            1e3 * float(orbit.meant_m.min()),
            1e3 * float(orbit.true_m.min()),
            0.5,
            STEPS,
        ),
    ]
    for it in drives:
        printed = PRINTED_MM if it.name == "sine_pi" else None
        why = f"a bound; {STEPS}" + ("; the print's arm bends and plays" if printed else "")
        rows.append(
            Compared(f"{it.name}: mean distance from its course", "mm", printed, 0.0, it.mean_mm, 0.2, why)
        )
        rows.append(
            Compared(
                f"{it.name}: furthest from its course", "mm", None, 0.0, it.most_mm, 0.6, f"a bound; {STEPS}"
            )
        )
    return tuple(rows)


def _slope(it: Drive) -> float:
    """Return the ramp's slope in mm/s, fitted."""
    return 1e3 * float(np.polyfit(it.seconds, it.true_m, 1)[0])


def _amplitude(it: Drive) -> float:
    """Return the sine's amplitude in mm, fitted with its phase."""
    angle = math.tau * it.seconds / LASTS_S
    found, *_ = np.linalg.lstsq(np.column_stack((np.sin(angle), np.cos(angle))), it.true_m, rcond=None)
    return 1e3 * math.hypot(*found)


def _drive_plots(drives: list[Drive]) -> tuple[Plot, ...]:
    heights = tuple(
        curve
        for it in drives
        for curve in (
            Curve(f"{it.name}, {TITLES[it.name]}, plant", it.seconds, 1e3 * it.true_m),
            Curve(f"{it.name}, formula", it.seconds, 1e3 * it.meant_m, "dashed"),
        )
    )
    errors = tuple(Curve(f"{it.name}, {TITLES[it.name]}", it.seconds, it.off_mm) for it in drives)
    return (
        Plot(
            "Height of the tool",
            "time since it began [s]",
            "above its begin [mm]",
            heights,
            "Fig. 3.9 to 3.11, through the whole chain; gains and the orbit's scale are assumed.",
        ),
        Plot(
            "From its course",
            "time since it began [s]",
            "higher than meant [mm]",
            errors,
            "By the plant's truth.",
        ),
    )


def _decay_plot(errors: Mapping[str, Floats]) -> Plot:
    curves = []
    for name, gains in LAW.items():
        passed = STEP_S * np.arange(len(errors[name]), dtype=np.float64)
        curves.append(Curve(f"{TITLES[name]}, law", passed, 1e3 * errors[name]))
        points = passed[::100]
        curves.append(Curve(f"{TITLES[name]}, closed form", points, 1e3 * decayed(gains, points), "points"))
    return Plot(
        "How an error dies away under each law",
        "time [s]",
        "error [mm]",
        tuple(curves),
        "From 9 mm beside, without limits of speed; (1 + K_d) e'' + K_p e' + K_i e = 0.",
    )
