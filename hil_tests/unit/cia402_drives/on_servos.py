"""RARS with CiA 402 drives of any maker in the places of its EPOS2: its file with other tables on them."""

import re
from functools import cache
from typing import Final

from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import parse, robots

INERTIAS: Final = ("1.9e-4", "1.9e-4", "2e-6", "1e-6")
"""At the motors' shafts, kg m2: what the gains of the EPOS2 are for."""
_LINES: Final = (
    (r'driver = "epos2-can"', 'driver = "cia402-can"'),
    (r'(?m)^device = "70/10".*$', 'device = "cia402"\nvendor_id = 0\ntuned_for_kg_m2 = INERTIA'),
    (r"(?m)^product_code = .*$", "product_code = 402"),
    (r"(?m)^encoder_lines = (\d+).*$", "encoder_counts = 2_000"),
    (r"(?m)^(motor_type|thermal_time_constant_100ms) = .*\n", ""),
    (r"(?m)^\[axes\.settings\.gains\](.|\n)*?(?=^\[\[axes|^# Gains)", ""),
    (
        r'settings = \{ axis = "left", input = 1, per_volt = 6.0 \}',
        'settings = { axis = "left", measures = "supply" }',
    ),
)


@cache
def text() -> str:
    """Return the file's text."""
    made = robots()["rars"].read_text(encoding="utf-8")
    for pattern, new in _LINES:
        made, times = re.subn(pattern, new, made)
        assert times, pattern
    for inertia in INERTIAS:
        made = made.replace("= INERTIA", f"= {inertia}", 1)
    return made


def rars(*changes: tuple[str, str]) -> AnyRobot:
    """Return the robot, with texts of its file replaced; RobotFileError."""
    made = text()
    for old, new in changes:
        assert old in made, old
        made = made.replace(old, new)
    return parse(made, "rars on servos.toml")
