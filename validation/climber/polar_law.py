"""The polar law (27) to (29), as printed and corrected.

Ours is the path follower that drives the robot, over a robot that follows each command at once, pushed off
its path; the independent way is the corrected law's linear equation in closed form. To poses that stand, both
forms of the law are integrated.
"""

import cmath
import math
from collections.abc import Callable
from typing import Final, TypeAlias

import numpy as np

from firmware_bridge.drivers.driver import Feedback, Power
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.robots.climber.geometry import ClimberGains, ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.path_follower import ClimberPathFollower
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

CYCLE: Final[Nanoseconds] = MILLISECOND
"""Cycle so short that neither a held set-point nor a ramp is seen: the law alone is looked at."""
SETTLED_S: Final = 6.0
PUSH_M: Final = 0.001
LOOKED_AT_S: Final = (0.5, 1.0, 1.5, 2.0)
WITHIN: Final = 0.01
"""Tolerance as a share of the push."""
AROUND: Final = 8
RADIUS_M: Final = 0.5
APPROACH_S: Final = 15.0
SEEN_M: Final = 1.2
"""Distance from the aim up to which a path is drawn."""

Turn: TypeAlias = Callable[[float, float], tuple[float, float]]
"""Function from the aim's direction, in the surface's axes, and the heading to alpha and beta; rad."""


def polar_law(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    robot = find("climber")
    control = robot.geometry.control
    seconds, aside = _pushed(robot, max(LOOKED_AT_S))
    closed = _closed_form(robot, seconds)
    times = np.linspace(0.0, APPROACH_S, 151 if quick else 601)
    forms: dict[str, Turn] = {"corrected": _corrected, "as printed": _printed}
    signs = {"corrected": 1.0, "as printed": -1.0}
    ways = {
        (form, place): _approached(robot, turn, signs[form], math.tau * place / AROUND, times)
        for form, turn in forms.items()
        for place in range(AROUND)
    }
    half, swing = _poles(control)
    return Findings(
        compared=tuple(
            Compared(
                f"left of a push of 1 mm after {at:g} s",
                "mm",
                None,
                1e3 * float(np.interp(at, seconds, closed)),
                1e3 * float(np.interp(at, seconds, aside)),
                1e3 * PUSH_M * WITHIN,
            )
            for at in LOOKED_AT_S
        ),
        plots=(
            Plot(
                "Pushed off a straight path",
                "time after the push [s]",
                "off the path [mm]",
                (
                    Curve("path follower", seconds, 1e3 * aside),
                    Curve("closed form", seconds[::100], 1e3 * closed[::100], "points"),
                ),
                "The reference moves along the path, so far ahead that k_rho rho is the path's speed. Near "
                "the path that is y'' + k_alpha y' + (k_alpha - k_beta) k_rho y = 0.",
            ),
            *(
                Plot(
                    f"To a pose that stands, {form}",
                    "way round the tank [m]",
                    "way up [m]",
                    tuple(_drawn(ways[form, place]) for place in range(AROUND)),
                    f"From 0.5 m all round, looking up; the aim is in the middle, looking up. {caption}",
                    equal=True,
                )
                for form, caption in (
                    ("corrected", "Every one arrives, asymptotically."),
                    ("as printed", "Alpha lacks the heading and k_beta has the other sign."),
                )
            ),
        ),
        sheets=(
            Sheet(
                f"Distance from the aim after {APPROACH_S:g} s",
                ("starts at [°]", "corrected [mm]", "as printed [mm]"),
                tuple(
                    (
                        f"{360.0 * place / AROUND:g}",
                        *(_left(ways[form, place]) for form in forms),
                    )
                    for place in range(AROUND)
                ),
            ),
        ),
        remarks=(f"The robot file's gains give poles of {-half:g} ± {swing:.3g} 1/s; none are printed.",),
    )


def _pushed(robot: Robot[ClimberGeometry], seconds: float) -> tuple[Floats, Floats]:
    """Return instants after the push, s, and how far off the path the robot is then, m."""
    robot_type = robot_type_of(robot)
    path_follower = ClimberPathFollower(robot, "vertical")
    body = ClimberState(0.0, 0.0, 0.0, 1.0)
    commanded: ClimberMotion = robot_type.standstill
    ahead, left, heading = 0.0, 0.0, 0.0
    rows: list[float] = []
    now: Nanoseconds = 0
    pushed_at = round(SETTLED_S * 1e9)
    while len(rows) <= round(seconds * 1e9) // CYCLE:
        now += CYCLE
        if now == pushed_at:
            left += PUSH_M
        if now >= pushed_at:
            rows.append(left)
        axes = {axis.name: Feedback(axis.name, power=Power.ON, sampled_at=now) for axis in robot.axes}
        facts = Facts(now, True, False, now, True, axes, {}, {})  # noqa: FBT003 - in the order of its fields
        pose = Pose(ahead, left, heading)
        seen: Snapshot[ClimberMotion, ClimberState] = Snapshot(
            facts=facts, command=robot_type.standstill, commanded=commanded, body=body, pose=pose
        )
        commanded = path_follower.command(seen, CYCLE)
        step = to_seconds(CYCLE)
        middle = heading + 0.5 * commanded.turn_rad_s * step
        ahead += commanded.speed_mps * math.cos(middle) * step
        left += commanded.speed_mps * math.sin(middle) * step
        heading += commanded.turn_rad_s * step
    return to_seconds(CYCLE) * np.arange(len(rows), dtype=np.float64), np.array(rows, dtype=np.float64)


def _poles(control: ClimberGains) -> tuple[float, complex]:
    """Return decay and swing of y'' + k_alpha y' + (k_alpha - k_beta) k_rho y = 0, 1/s."""
    half = control.k_alpha_per_s / 2.0
    return half, cmath.sqrt(half**2 - (control.k_alpha_per_s - control.k_beta_per_s) * control.k_rho_per_s)


def _closed_form(robot: Robot[ClimberGeometry], seconds: Floats) -> Floats:
    """Return how a push dies out by the linear equation, m."""
    half, swing = _poles(robot.geometry.control)
    one, other = -half + swing, -half - swing
    way = (one * np.exp(other * seconds) - other * np.exp(one * seconds)) / (one - other)
    return np.asarray(PUSH_M * way.real)


def _approached(
    robot: Robot[ClimberGeometry], turn: Turn, sign: float, course: float, times: Floats
) -> Floats:
    """Return place and heading of a robot that goes to a pose that stands: m, m, rad."""
    control = robot.geometry.control

    def rates(_: float, at: Floats) -> Floats:
        aim = math.atan2(-at[1], -at[0])
        alpha, beta = turn(aim, at[2])
        speed = control.k_rho_per_s * math.hypot(at[0], at[1])
        turning = control.k_alpha_per_s * alpha + sign * control.k_beta_per_s * beta
        return np.array([speed * math.cos(at[2]), speed * math.sin(at[2]), turning])

    start = np.array([RADIUS_M * math.cos(course), RADIUS_M * math.sin(course), math.pi / 2.0])
    return integrate(rates, start, times, 10)


def _corrected(aim: float, theta: float) -> tuple[float, float]:
    alpha = math.remainder(aim - theta, math.tau)
    return alpha, math.remainder(math.pi / 2.0 - theta - alpha, math.tau)


def _printed(aim: float, theta: float) -> tuple[float, float]:
    return aim, math.remainder(math.pi / 2.0 - theta - aim, math.tau)


def _drawn(way: Floats) -> Curve:
    away = np.hypot(way[:, 0], way[:, 1]) > SEEN_M
    until = int(np.argmax(away)) if away.any() else len(way)
    return Curve("", way[:until, 0], way[:until, 1])


def _left(way: Floats) -> float | str:
    """Return how far it is from the aim in the end, mm."""
    distance = math.hypot(way[-1, 0], way[-1, 1])
    return "it runs away" if distance > RADIUS_M else 1e3 * distance
