"""ROME's way along the circle against an integration of (2.13) to (2.15) of its own: no board, no bridge.

The same cycle, the same whole counts, the same loop on the board in whole numbers, the same motors. What both
give differs by what is left out here: times of single bytes, the battery, rollers.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from emulators.rig import Rig
from hil_tests.scenarios.rome_ride import driven

Vector = NDArray[np.float64]
R, L, GEAR, COUNTS = 0.05, 0.16, 64.0, 3072
RESISTANCE, CONSTANT = 1.9 + 0.5, 13.4e-3
"""Winding and half bridge."""
MASS, YAW, WHEEL, ROTOR = 3.5, 0.05, 2.5e-4, 5.8e-7
KP, KI = 2.0, 0.5
RAMP: Final = 0.8 * 0.6
CYCLE, FRAME, STEP = 0.05, 0.033, 0.0005
REQUESTED, REPORTED = 0.010, 0.012
"""Delays from a cycle's begin to its command, when the path's clock begins; and from there to the board."""
SECONDS: Final = 7.0
ANGLES: Final = np.array([0.0, 2.0, 4.0]) * math.pi / 3.0
P: Final[Vector] = np.stack([-np.sin(ANGLES), np.cos(ANGLES), np.full(3, L)], axis=1)


def circle(t: float) -> tuple[Vector, Vector]:
    """Return the point of (2.20), from its begin, and its rate."""
    angle = 0.25 * t
    place = np.array([math.cos(angle) - 1.0, math.sin(angle), 0.0])
    return place, 0.25 * np.array([-math.sin(angle), math.cos(angle), 0.0])


class Loop:
    """ros_arduino_bridge's, of one wheel: whole numbers, gains of the robot file."""

    def __init__(self) -> None:
        self.target = self.output = self.before = self.moved_before = 0

    def frame(self, count: int) -> int:
        """Return the PWM after a frame."""
        moved = count - self.before
        change = int((50 * (self.target - moved) - 20 * (moved - self.moved_before)) / 50)
        self.output = min(max(self.output + change, -255), 255)
        self.before, self.moved_before = count, moved
        return self.output


def integrated() -> Vector:
    """Return the error of each 10 ms, actual less desired, m."""
    pose, rims, turned = np.zeros(3), np.zeros(3), np.zeros(3)
    loops, total, set_point, pwm = [Loop() for _ in range(3)], np.zeros(3), np.zeros(3), np.zeros(3)
    posed = sampled = (pose.copy(), -REQUESTED)
    inertia = (WHEEL + ROTOR * GEAR**2) / R**2
    masses = np.array([MASS + 1.5 * inertia, MASS + 1.5 * inertia, YAW + 3.0 * L**2 * inertia])
    per_tick = COUNTS / (2.0 * math.pi) * FRAME / R
    errors, commands_at, words = [], 0.0, None
    samples_at, frames_at = CYCLE - REQUESTED, FRAME
    for tick in range(round(SECONDS / STEP)):
        t = tick * STEP
        if t >= samples_at:
            posed, sampled, samples_at = sampled, (pose.copy(), t), samples_at + CYCLE
        if t >= commands_at:
            place, _ = circle(posed[1])
            error = posed[0] - place
            total = total + error * CYCLE
            world = circle(t)[1] - KP * error - KI * total
            sine, cosine = math.sin(posed[0][2]), math.cos(posed[0][2])
            command = np.array(
                [world[0] * cosine + world[1] * sine, world[1] * cosine - world[0] * sine, world[2]]
            )
            change = command - set_point
            needed = np.hypot(*change[:2]) / RAMP
            set_point = set_point + change * min(1.0, CYCLE / needed if needed else 1.0)
            words, commands_at = (t + REPORTED, np.round(P @ set_point * per_tick)), commands_at + CYCLE
        if words is not None and t >= words[0]:
            for loop, target in zip(loops, words[1], strict=True):
                loop.target = int(target)
            words = None
        if t >= frames_at:
            counts = np.floor(turned / (2.0 * math.pi * R) * COUNTS)
            pwm = np.array([loop.frame(int(count)) for loop, count in zip(loops, counts, strict=True)])
            frames_at += FRAME
        current = (12.0 * pwm / 255.0 - CONSTANT * GEAR * rims / R) / RESISTANCE
        dry = 0.0375 * np.tanh(rims / 1e-3) + 0.0375 * rims * GEAR / R / 885.0
        force = CONSTANT * (current - dry) * GEAR / R
        rims = rims + P @ (P.T @ force / masses) * STEP
        turned = turned + rims * STEP
        body = np.linalg.solve(P, rims)
        sine, cosine = math.sin(pose[2]), math.cos(pose[2])
        rate = np.array([body[0] * cosine - body[1] * sine, body[0] * sine + body[1] * cosine, body[2]])
        pose = pose + rate * STEP
        if tick % round(0.01 / STEP) == 0:
            errors.append((pose - circle(t)[0])[:2])
    return np.array(errors)


def measured(rig: Rig) -> Vector:
    """Return the same of the plant, from the first instant at which the path follower drives."""
    offset = rig.samples.column("path_offset_s")
    guided = np.flatnonzero(np.isfinite(offset))
    seconds = rig.samples.seconds[guided] + offset[guided]
    x, y = (rig.samples.column(name)[guided] for name in ("x_m", "y_m"))
    place = np.array([circle(float(t))[0] for t in seconds])
    return np.stack([x - place[:, 0], y - place[:, 1]], axis=1)


def test_the_error_on_the_circle_is_that_of_an_independent_integration() -> None:
    """From rest on: the ramp leaves the base behind, and the law brings it back."""
    with driven("ros-arduino-bridge", 'path_follower = "circle"', 12.0) as rig:
        rig.runs(4.7 + SECONDS)
        found = measured(rig)
    expected = integrated()
    count = min(len(found), len(expected))
    apart = np.hypot(*(found[:count] - expected[:count]).T)
    size = np.hypot(*expected[:count].T)
    assert size.max() > 0.03, "the start leaves it behind by centimeters"
    assert np.all(apart <= np.maximum(0.05 * size.max(), 0.003)), (apart.max(), size.max())
