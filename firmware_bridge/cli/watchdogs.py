"""Boards without a watchdog: the warning about them, and the permission to drive their robot."""

from typing import Final

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.robot import AnyRobot

RUNS_ON: Final = "its motors run on as commanded when the bridge ends, is killed, or the line is cut"
SKETCH: Final = (
    "flash this project's sketch (emulators/arduino_omni/sketch, protocol ros-arduino-bridge), which stops "
    "them after 2 s"
)


def watched(machine: AnyRobot, *, accepted: bool) -> AnyRobot:
    """Return the robot; where nothing but the bridge stops its motors, only if that was accepted."""
    for name, link in machine.shield_links.items():
        if not link.unwatched:
            continue
        board = f"link '{name}': a board with {link.protocol.value} has no watchdog: {RUNS_ON}"
        if not (accepted or link.accept_no_watchdog):
            file = f"accept_no_watchdog = true in [links.{name}]"
            raise refusal(f"{board}; {SKETCH}, or use --accept-no-watchdog ({file})")
        say(f"{board}; keep the switch of their supply within reach")
    return machine
