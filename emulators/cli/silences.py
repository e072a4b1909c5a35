"""The option `--silence NODE@SECONDS`: a drive that leaves its bus."""

import re

from firmware_bridge.cli.console import refusal
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds, from_seconds


def silence_of(robot: AnyRobot, text: str) -> tuple[str, Nanoseconds]:
    """Read NODE@SECONDS, where the node may be a number or the name of an axis; return axis and time."""
    node, _, seconds = text.partition("@")
    for axis in robot.axes:
        if node in {str(axis.settings.number), axis.name}:
            if not re.fullmatch(r"\d+(\.\d+)?", seconds):
                raise refusal(f"--silence {text}: give NODE@SECONDS, as {axis.settings.number}@10")
            return axis.name, from_seconds(float(seconds))
    known = ", ".join(f"{axis.settings.number} ({axis.name})" for axis in robot.axes)
    raise refusal(f"--silence {text}: {robot.name} has no node '{node}'; it has {known}")
