"""A predictor by the robot's equation of motion, (6.1): I th'' = tau - C th', the wheels under PI loops.

Ours are the wheels' two equations, integrated by a predictor that starts from a delayed pose and the wheels'
speeds, with the commands sent since. The independent way has no wheel in it: the balance of force and of
moment about the rear axle's middle, by the body's speed and yaw rate. The loops' gains are not printed:
assumed.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmware_bridge.motion.model import Moving, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import circle, placed
from firmware_bridge.pilot.pursuit import Pursuit
from validation.rars.plant import P
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

RIM: Final = P["wheel_radius"]
TRACK: Final = P["rear_track"]
STEP: Final = 1e-3
RADIUS: Final = 5.0
SPEED: Final = 0.5
LOOK_AHEAD: Final = 0.5
CYCLE: Final = 0.050
LATE: Final = 0.8
"""s, of the link; above the critical delay."""
COARSE: Final = 0.010
"""s: step of the drives; 0.1 mm from 1 ms."""
BESIDE: Final = Pose(4.99, 0.0, math.pi / 2.0)
SECONDS: Final = 40.0


AT: Final = (0.5, 0.8)
"""s from rest at which the two ways are compared."""
SENT: Final = (0.5, 0.3)
"""m/s and rad/s, constant."""
NOTE: Final = (
    "The gains at the wheel are assumed: 5 N.m.s/rad and 20 N.m/rad, and a tenth and a twentieth of them as "
    "soft loops. With stiff ones a kinematic model is 1.4 mm ahead, so the pilot's predictor needs no "
    "dynamics; with soft ones it leaves a swing of some millimeters that the dynamic one does not. The "
    "loops' integrals, which no message carries, are those of the predictor's own model."
)


@dataclass(frozen=True, slots=True)
class Loop:
    """A wheel's PI loop."""

    title: str
    p: float
    """N.m.s/rad."""
    i: float
    """N.m/rad."""


STIFF: Final = Loop("stiff", 5.0, 20.0)
"""Assumed: the thesis prints no gains at the wheel."""
SOFT: Final = Loop("soft", 0.5, 1.0)
"""Assumed, a tenth and a twentieth: where the predictor's model begins to matter."""


def wheel_matrices() -> tuple[Floats, float]:
    """Return I in kg.m2 and the factor c of C = c (w_left - w_right) [[0, 1], [-1, 0]], (3.31)-(3.34)."""
    lam = RIM / TRACK
    body = P["platform_mass"] * P["centre_offset"] ** 2 + P["yaw_inertia"]
    yaw = 2.0 * lam**2 * P["wheel_yaw_inertia"]
    rear = P["wheel_spin_inertia"] + P["wheel_mass"] * RIM**2 + yaw
    mean, half = P["platform_mass"] * RIM**2 / 4.0, body * lam**2
    matrix = np.array([[rear + mean + half, mean - half - yaw], [mean - half - yaw, rear + mean + half]])
    return matrix, P["platform_mass"] * P["centre_offset"] * RIM**3 / TRACK**2


def by_wheels(loop: Loop, commands: Floats, start: Floats, step: float = STEP) -> Floats:
    """Return x, y, heading, w_left, w_right, and both loops' integrals, a row a step; a command a row."""
    matrix, factor = wheel_matrices()
    inverse = np.linalg.inv(matrix)
    rows = [start]
    for speed, turn in commands:
        wanted = np.array([speed - turn * TRACK / 2.0, speed + turn * TRACK / 2.0]) / RIM

        def rates(_at: float, state: Floats, wanted: Floats = wanted) -> Floats:
            spins = state[3:5]
            torque = loop.p * (wanted - spins) + loop.i * state[5:7]
            coupled = factor * (spins[0] - spins[1]) * np.array([spins[1], -spins[0]])
            ahead, yaw = RIM * spins.mean(), RIM / TRACK * (spins[1] - spins[0])
            pose = (ahead * math.cos(state[2]), ahead * math.sin(state[2]), yaw)
            return np.array([*pose, *(inverse @ (torque - coupled)), *(wanted - spins)])

        rows.append(integrate(rates, rows[-1], np.array([0.0, step]))[-1])
    return np.array(rows)


def by_balance(loop: Loop, commands: Floats) -> Floats:
    """Return x, y, heading, speed, yaw rate from rest, a row a ms: force and moment of the whole body."""
    mass, ahead = P["platform_mass"], P["centre_offset"]
    rolls = 2.0 * (P["wheel_mass"] + P["wheel_spin_inertia"] / RIM**2)
    # A rear wheel's rim moves by the yaw rate times half the track.
    turns = P["yaw_inertia"] + mass * ahead**2 + rolls * TRACK**2 / 4.0 + 2.0 * P["wheel_yaw_inertia"]
    state, owed = np.zeros(5), np.zeros(2)
    rows = [state]
    for speed, turn in commands:

        def rates(_at: float, now: Floats, speed: float = speed, turn: float = turn) -> Floats:
            _, _, heading, v, w, s_owed, w_owed = now
            # Both loops together push the body, their difference turns it.
            push = 2.0 / RIM**2 * (loop.p * (speed - v) + loop.i * s_owed)
            moment = TRACK**2 / 2.0 / RIM**2 * (loop.p * (turn - w) + loop.i * w_owed)
            return np.array(
                [
                    v * math.cos(heading),
                    v * math.sin(heading),
                    w,
                    (push + mass * ahead * w * w) / (mass + rolls),
                    (moment - mass * ahead * v * w) / turns,
                    speed - v,
                    turn - w,
                ]
            )

        both = integrate(rates, np.array([*state, *owed]), np.array([0.0, STEP]))[-1]
        state, owed = both[:5], both[5:]
        rows.append(state)
    return np.array(rows)


def swing(rows: Floats) -> float:
    """Return half of peak to peak of the distance to the center in the last 15 s, m."""
    return float(np.ptp(np.hypot(*rows[-round(15.0 / COARSE) :, :2].T))) / 2.0


def followed(loop: Loop, predictor: str, seconds: float = SECONDS) -> Floats:
    """Return the plant's states: pure pursuit over the slow link, by a "dynamic" or a "kinematic" predictor.

    "none" steers by the delayed pose, "" by the pose without delay.
    """
    pursuit = Pursuit(placed(circle(RADIUS), Pose(RADIUS, 0.0, math.pi / 2.0)), LOOK_AHEAD)
    late, each = (round(LATE / COARSE) if predictor else 0), round(CYCLE / COARSE)
    states = [np.array([BESIDE.x_m, BESIDE.y_m, BESIDE.heading_rad, *(SPEED / RIM,) * 2, 0.0, 0.0])]
    sent: list[tuple[float, float]] = []
    for place in range(round(seconds / COARSE)):
        if place % each == 0:
            seen = max(place - late, 0)
            known = states[seen]
            if predictor == "dynamic":
                known = by_wheels(loop, np.array(sent[seen:]).reshape(-1, 2), known, COARSE)[-1]
            pose = Pose(*known[:3])
            if predictor == "kinematic":
                moving = Moving(pose)
                for speed, turn in sent[seen:]:
                    moving = Unicycle().step(moving, speed, turn, COARSE)
                pose = moving.pose
            bend = pursuit.arc(pose).curvature_per_m
        sent.append((SPEED, SPEED * bend))
        states.append(by_wheels(loop, np.array(sent[-1:]), states[-1], COARSE)[-1])
    return np.array(states)


def dynamic_predictor(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    seconds = 20.0 if quick else SECONDS
    commands = np.tile(SENT, (round(max(AT) / STEP), 1))
    wheels, body = by_wheels(STIFF, commands, np.zeros(7)), by_balance(STIFF, commands)
    drives = {
        (loop.title, predictor): followed(loop, predictor, seconds)
        for loop in (STIFF, SOFT)
        for predictor in ("", "none", "kinematic", "dynamic")
    }
    return Findings(
        compared=(
            *(
                Compared(
                    f"{quantity} after {at:g} s from rest", unit, None, body[n][place], ours[place], 1e-9
                )
                for at in AT
                for n in (round(at / STEP),)
                for ours in (_as_body(wheels[n]),)
                for place, (quantity, unit) in enumerate(
                    (("x", "m"), ("y", "m"), ("heading", "rad"), ("speed", "m/s"), ("yaw rate", "rad/s"))
                )
            ),
            *(
                Compared(
                    f"swing about the circle at {LATE:g} s of delay, {loop.title} loops, dynamic predictor",
                    "mm",
                    None,
                    1e3 * swing(drives[loop.title, ""]),
                    1e3 * swing(drives[loop.title, "dynamic"]),
                    0.5,
                    "beside the same without delay",
                )
                for loop in (STIFF, SOFT)
            ),
        ),
        plots=tuple(
            Plot(
                f"Pure pursuit at {LATE:g} s of delay, {loop.title} wheel loops",
                "time [s]",
                "distance from the center [m]",
                tuple(
                    Curve(title, *_radius(drives[loop.title, predictor]))
                    for predictor, title in (
                        ("", "no delay"),
                        ("kinematic", "kinematic predictor"),
                        ("dynamic", "dynamic predictor, (6.1)"),
                    )
                ),
                f"P {loop.p:g} N.m.s/rad, I {loop.i:g} N.m/rad at each wheel, assumed. From 10 mm beside the "
                "circle of 5 m at 0.5 m/s, look-ahead 0.5 m.",
            )
            for loop in (STIFF, SOFT)
        ),
        sheets=(
            Sheet(
                f"Swing in the last 15 s of {seconds:g} s, half of peak to peak, {LATE:g} s of delay",
                ("loops", "predictor", "swing [mm]"),
                tuple(
                    (loop, predictor or "no delay", 1e3 * swing(rows))
                    for (loop, predictor), rows in drives.items()
                ),
            ),
        ),
        remarks=(NOTE,),
    )


def _as_body(state: Floats) -> tuple[float, ...]:
    left, right = state[3:5]
    return (*map(float, state[:3]), RIM * float(left + right) / 2.0, RIM / TRACK * float(right - left))


def _radius(rows: Floats) -> tuple[Floats, Floats]:
    radius: Floats = np.hypot(*rows[:, :2].T)
    return COARSE * np.arange(len(rows), dtype=float), radius
