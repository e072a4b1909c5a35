"""Effect of a disconnected encoder on a base whose board regulates by it: measured."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from emulators.testing.rig import STEP_S, VirtualRig
from hil_tests.failures.kept import Kept
from hil_tests.safety.driving import DRIVES_FOR_S, robot_of, speed
from validation.pages.pages import table

LINES: Final = {"rome": ("rome:ros-arduino-bridge", "rome:mw:3"), "rome_arm": ("rome_arm",)}
SPEEDS: Final = (0.1, 0.2, 0.3)
"""m/s, ahead: wheels two and three carry it."""
WHEELS: Final = ("two", "three")
PHASES: Final = tuple(place * 0.0071 for place in range(8))
"""s: when it fails between two samples."""
WATCHED_S: Final = 4.0
TURNING: Final = "while it drives"
STARTING: Final = "before it starts"
TEXT: Final = """A board's own speed regulator increases the output of a wheel whose encoder reports nothing:
full power after 0.1 s. Worst of the wheels two and three and of eight instants between two samples, measured
in the plant. A wheel that turned as commanded and then shows no count at all is released by the bridge:
the board can do no more, and the wheel coasts. From standstill, a wheel whose encoder is off cannot be
distinguished from one that has not begun to turn yet, for the lag that the robot file allows."""


@dataclass(frozen=True, slots=True)
class Off:
    """Result at one speed."""

    line: str
    when: str
    commanded_mm_s: int
    worst_mm_s: int
    yaw_mrad_s: int
    above_twice_ms: int
    """Time for which the base was faster than twice its command."""
    rest_ms: int


KEPT: Final = Kept(Off, "encoders")


def wanted() -> Iterator[tuple[str, str, float]]:
    """Yield each line, the time at which the encoder goes, and the commanded speed of the base."""
    for lines in LINES.values():
        for line in lines:
            for when in (TURNING, STARTING):
                for reported in SPEEDS:
                    yield line, when, reported


def measured(line: str, when: str, reported: float) -> Off:
    """Drive it with each wheel's encoder, and at each instant; keep the worst of each figure."""
    rig = VirtualRig(robot_of(line))
    rig.arms()
    if when == TURNING:
        rig.operator.drives(reported)
        rig.runs(DRIVES_FOR_S)
    found = []
    for wheel in WHEELS:
        for phase in PHASES if when == TURNING else PHASES[:1]:
            with rig.branch():
                rig.runs(phase)
                rig.fault("encoder_cable_off", node=wheel)
                rig.operator.drives(reported)
                found.append(_watched(rig, reported))
    worst = [round(1000 * max(figures)) for figures in zip(*found, strict=True)]
    return Off(line, when, round(1000 * reported), *worst)


def _watched(rig: VirtualRig, reported: float) -> tuple[float, float, float, float]:
    """Return the greatest speed and yaw rate, for how long it was too fast, and when it stood."""
    began, worst, yaw, above, rest = rig.now, 0.0, 0.0, 0.0, 0.0
    while rig.now < began + WATCHED_S:
        rig.runs(STEP_S)
        body = rig.body
        now = math.hypot(body.speed_mps, body.speed_left_mps)
        worst, yaw = max(worst, now), max(yaw, abs(body.yaw_rate_rad_s))
        above += STEP_S * (now > 2.0 * reported)
        if speed(rig) > 0.005:
            rest = rig.now - began
    return worst, yaw, above, rest


def sections(robot: str) -> tuple[str, ...]:
    """Return the part of the page on safety, in Markdown."""
    lines = LINES.get(robot, ())
    if not lines:
        return ()
    headings = (
        "line",
        "encoder off",
        "commanded",
        "worst speed",
        "yaw rate",
        "above twice",
        "standstill after",
    )
    cells = (
        (
            row.line,
            row.when,
            f"{row.commanded_mm_s / 1000:g} m/s",
            f"{row.worst_mm_s / 1000:.2f} m/s",
            f"{row.yaw_mrad_s / 1000:.2f} rad/s",
            f"{row.above_twice_ms / 1000:.2f} s",
            f"{row.rest_ms / 1000:.2f} s",
        )
        for row in KEPT.read()
        if row.line in lines
    )
    return ("### An encoder that is off", table(headings, cells))


def general() -> tuple[str, ...]:
    """Return what the tables of all robots have in common."""
    return ("### An encoder that is off", TEXT)
