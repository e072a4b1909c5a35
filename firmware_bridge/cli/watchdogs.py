"""Devices without a watchdog: the warning about them, and the permission to drive their robot."""

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.robot import AnyRobot


def watched(machine: AnyRobot, *, accepted: bool) -> AnyRobot:
    """Return the robot; where nothing but the bridge stops its motors, only if that was accepted."""
    for name, link in machine.links.items():
        if not link.unwatched:
            continue
        devices = f"link '{name}': {link.unwatched}"
        if not (accepted or link.accepts_unwatched):
            file = f"accept_no_watchdog = true in [links.{name}]"
            raise refusal(f"{devices}; {link.unwatched_remedy}, or use --accept-no-watchdog ({file})")
        say(f"{devices}; keep the switch of their supply within reach")
    return machine
