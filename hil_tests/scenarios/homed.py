"""RARS with axes that find their zero: the lift on its lower stop, the steering on its left one."""

from typing import Final

from firmware_bridge.kinds import kind_named, parse
from firmware_bridge.robot import AnyRobot

TEXT: Final = kind_named("rars").file.read_text(encoding="utf-8")
CONFIRMED: Final = '[axes.zero]\nhow = "confirm"'
LIFT: Final = """method = -4
speed = 10.0
zero_speed = 1.0
acceleration = 40.0
offset = 0.21
current_a = 0.5
within_s = 45.0"""
STEER: Final = """method = -4
speed = 1.0
zero_speed = 0.1
acceleration = 10.0
offset = 0.15
at = -2.6
current_a = 0.6
within_s = 12.0
after = ["lift"]"""


def homed(lift: str = LIFT, steer: str | None = None) -> AnyRobot:
    """Return RARS with these tables `[axes.zero.homing]`; None: told where it stands, as ever."""
    head, steering, lifting = TEXT.split(CONFIRMED)
    return parse(
        head + _zero(steer) + steering + _zero(lift) + lifting,
        "homed.toml",
    )


def _zero(homing: str | None) -> str:
    return CONFIRMED if homing is None else f'[axes.zero]\nhow = "home"\n[axes.zero.homing]\n{homing}\n#'
