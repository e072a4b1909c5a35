"""RARS with axes that find their zero: the lift on its lower stop, the steering on one of its two."""

from typing import Final

from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import parse, robot_type_named

TEXT: Final = robot_type_named("rars").file.read_text(encoding="utf-8")
CONFIRMED: Final = '[axes.zero]\nhow = "confirm"'
LIFT: Final = """
method = -4                 # down, onto the stop
speed = 4.0
zero_speed = 1.0
acceleration = 40.0
offset = 0.21               # the stop lies so far below collapsed
current_a = 0.5             # going down takes 0.3
within_s = 100.0
"""
STEER: Final = """
method = -4
speed = 1.0
zero_speed = 0.1
acceleration = 10.0
offset = 0.15               # the stop lies at 2.8 rad of the pinion
at = -2.65
current_a = 0.35
within_s = 12.0
after = ["lift"]
"""


def text_of(lift: str | None = LIFT, steer: str | None = None) -> str:
    """Return RARS's file with these tables `[axes.zero.homing]`; None: confirmed by the operator, as ever."""
    head, steering, lifting = TEXT.split(CONFIRMED)
    return head + _zero(steer) + steering + _zero(lift) + lifting


def homed(lift: str | None = LIFT, steer: str | None = None) -> AnyRobot:
    """The robot of that file."""
    return parse(text_of(lift, steer), "homed.toml")


def _zero(homing: str | None) -> str:
    return CONFIRMED if homing is None else f'[axes.zero]\nhow = "home"\n[axes.zero.homing]{homing}#'
