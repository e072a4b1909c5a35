"""The diff_drive robot with cameras around it: its robot file, with a link and a sensor more."""

from functools import cache
from pathlib import Path
from typing import Final

from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.file import robot_of, table_of
from firmware_bridge.robot_types import find, robot_type_named

CAMERAS: Final = "cameras"
CAPTURE: Final = """
[links.cameras]
driver = "natnet"
server = "192.168.1.10:1510"
silent_ms = 500

[[sensors]]
name = "place"
title = "where the cameras see it"
link = "cameras"
every_ms = 50
silent_ms = 100
settings = { body = "diff_drive", fastest_mps = 1.0, fastest_rad_s = 2.0 }
"""


def written(change: tuple[str, str] = ("", ""), server: str = "192.168.1.10:1510") -> str:
    """Return the file's text with one change in what is more in it."""
    own = robot_type_named("diff_drive").file.read_text(encoding="utf-8")
    old, new = change
    assert old in CAPTURE
    return own + CAPTURE.replace(old, new, 1).replace("192.168.1.10:1510", server)


@cache
def captured_diff_drive() -> AnyRobot:
    kind = robot_type_named("diff_drive")
    return robot_of(table_of(written(), "diff_drive"), "diff_drive", kind.geometry, kind.groups)


def file_at(folder: Path, text: str) -> AnyRobot:
    """Write a robot file, and read it as a command does."""
    path = folder / "diff_drive.toml"
    path.write_text(text, encoding="utf-8")
    return find(str(path))
