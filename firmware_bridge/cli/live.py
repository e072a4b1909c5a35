"""`live`: a recording on the live page."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from firmware_bridge.cli.bus_options import DeviceOption
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import WRONG_INPUT, refusal, say
from firmware_bridge.cli.live_page import page_port
from firmware_bridge.cli.options import DurationOption, until

if TYPE_CHECKING:
    from firmware_bridge.dissector.expected import Expected

EXAMPLES: Final = """Examples:

`firmware-bridge live run.mcap` plays a recording of `bench`, `drive` or `emulate` in a browser.

`firmware-bridge bench rars --mission circles --record run.mcap` makes one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveOptions:
    """Play a recording in MCAP on a page for a browser of this machine, whose address is printed.

    The page pauses, plays slower or faster, and goes to any instant. Ends on Ctrl-C.
    """

    recording: Annotated[
        Path, typer.Argument(metavar="FILE", help="A recording that `--record FILE.mcap` has made.")
    ]
    device: DeviceOption = None
    duration: DurationOption = None


def run(given: LiveOptions) -> None:
    """Run `live` with these options; an error ends the program with a message."""
    from firmware_bridge.cli.console import one_message
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.extras import ExtraMissingError, from_extras
    from firmware_bridge.live.messages import LIVE
    from firmware_bridge.recording import RecordingError
    from firmware_bridge.runtime.clock import LivedClock

    path = given.recording
    with one_message(ExtraMissingError), from_extras():
        from firmware_bridge.live.player import Player
        from firmware_bridge.live.recording import Recording
        from firmware_bridge.live.state import outline_named
        from firmware_bridge.mcap_file.reader import metadata

        try:
            about = metadata(path)
            recording = Recording(path, lambda remark: say(f"{path}: {remark}", err=True))
        except (RecordingError, OSError) as error:
            reason = getattr(error, "strerror", None) or error
            raise refusal(f"{path}: cannot be read as a recording in MCAP: {reason}", WRONG_INPUT) from None
    title = ", ".join(filter(None, (about.get("robot", ""), about.get("mission", "")))) or path.name
    robot = about.get("robot", "")
    player = Player(recording, title, given.device or "", incidents(path, robot), outline_named(robot))
    carry(player, {LIVE: page_port}, until(given.duration), f"playing {path}", clock=LivedClock())


def incidents(path: Path, name: str) -> list[dict[str, Any]]:
    """Return what `explain` finds in the frames of a recording, for the page; none of several buses."""
    from firmware_bridge.dissector.expected import can_links, expected_on
    from firmware_bridge.explain.explainer import Setup, explain
    from firmware_bridge.explain.source import UnreadableError, frames
    from firmware_bridge.live.bus import incidents as shown
    from firmware_bridge.robot_types import find, robots

    expected: list[Expected] = []
    # A robot of the user's own may be known by its name only where it was driven.
    if name in robots():
        robot = find(name)
        expected = [node for link in can_links(robot) for node in expected_on(robot, link)]
    try:
        explained = explain(frames(path, lambda _: None), Setup(expected=tuple(expected)), None)
    except UnreadableError:
        return []
    return shown(explained.incidents)


live: Final = command(EXAMPLES, work=run)(LiveOptions)
