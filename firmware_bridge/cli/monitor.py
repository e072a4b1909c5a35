"""`monitor`: a CAN bus decoded, live or from a recording, without a frame of one's own."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, TypeAlias

import typer

from firmware_bridge.cli.bus_options import (
    BusLinkOption,
    BusRobotOption,
    DcfOption,
    DeviceOption,
    EdsOption,
    stated_bus,
)
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import refusal, say
from firmware_bridge.cli.live_page import LiveOption, page_port
from firmware_bridge.cli.monitor_files import Frame, candump, foreign, numbered, of_one_bus
from firmware_bridge.cli.options import (
    ChannelOption,
    DurationOption,
    FirmwareOption,
    InterfaceOption,
    RobotBitRateOption,
    until,
)
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime import can_files
from firmware_bridge.units import MILLISECOND, Nanoseconds

if TYPE_CHECKING:
    from rich.live import Live

    from firmware_bridge.cli.monitor_frames import FrameLines
    from firmware_bridge.dissector.bus_picture import BusPicture
    from firmware_bridge.node import Node
    from firmware_bridge.runtime.ports import Port


EXAMPLES: Final = """Examples:

`firmware-bridge monitor -i socketcan -c can0`

`firmware-bridge monitor -i socketcan -c can0 --robot rars` names the drives, and knows their PDOs at once.

`firmware-bridge monitor --log out/rars-circles/can.log`

`firmware-bridge monitor --log can.log --device epos2`, or `--dcf drive.dcf`, reads PDOs whose mapping was
not seen to be written.

`firmware-bridge monitor -i socketcan -c can0 --lines --filter sdo,nmt --node 3` shows those frames in words.

`firmware-bridge monitor --log out/rome-circle/serial.log --robot rome --protocol mw` shows the commands and
answers of a board line by line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorOptions:
    """Show a CAN bus decoded: nodes, PDOs, statuswords, emergencies, rates, load, the last error.

    It sends nothing, unless with --ask. On a terminal the display is refreshed; elsewhere each change
    is a line, and the display comes at the end. A PDO is read by the robot file's mapping, or by one
    that was seen to be written; one that is merely the default of a known maker is marked, and the bytes
    of others are shown as they are. Ends on Ctrl-C. A recording of serial lines or of cameras is shown
    line by line, by the protocols of --robot.
    """

    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: RobotBitRateOption = None
    robot: BusRobotOption = None
    link: BusLinkOption = None
    log: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="In place of a bus: a recording in candump's format, or serial.log or capture.log, may be "
            ".gz or .xz; -c chooses one of several buses or lines in it.",
            show_default=False,
        ),
    ] = None
    protocol: FirmwareOption = None
    device: DeviceOption = None
    eds: EdsOption = None
    dcf: DcfOption = None
    ask: Annotated[
        bool,
        typer.Option(
            "--ask",
            help="Read the mapping of each node's PDOs by SDO, the only frames that it sends; no other "
            "program may be the nodes' SDO client meanwhile.",
        ),
    ] = False
    lines: Annotated[bool, typer.Option("--lines", help="Each frame in words, a line each.")] = False
    changes: Annotated[
        bool,
        typer.Option(
            "--changes",
            help="A line for each event, and for each frame that differs from the last with its identifier.",
        ),
    ] = False
    filter_: Annotated[
        str | None,
        typer.Option(
            "--filter",
            metavar="WORDS",
            help="With --lines or --changes only these frames: nmt, sync, emergency, time, sdo, heartbeat, "
            "lss, pdo, other, or identifiers as 181 or 180-1FF; several with commas.",
        ),
    ] = None
    node: Annotated[
        str | None,
        typer.Option(
            "--node",
            "-n",
            metavar="NUMBERS",
            help="Only frames and events of these nodes, and frames to them: 1, or 1-8, or 1,3.",
        ),
    ] = None
    live: LiveOption = False
    duration: DurationOption = None


DRAW_EVERY: Final[Nanoseconds] = 500 * MILLISECOND

TELEMETRY: Final = ".tlog"
_Show: TypeAlias = Callable[[tuple[str, ...]], None]


class Listening:
    """A node that receives everything and sends nothing."""

    def __init__(
        self,
        picture: "BusPicture",
        show: _Show,
        draw: Callable[[], None],
        frames: "FrameLines | None" = None,
        end: Callable[[], None] = lambda: None,
    ) -> None:
        self._picture = picture
        self._show = show
        self._frames = frames
        self._draw = draw
        self._end = end
        self._reaction = Reaction((), 0)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a frame."""
        if self._frames is not None:
            self._frames.note(now, packet)
        elif texts := self._picture.note(now, packet):
            self._show(texts)
        return self._reaction

    def wake(self, now: Nanoseconds) -> Reaction:
        """Draw the picture, and again a little later."""
        self._show(self._picture.pass_time(now) if self._frames is None else self._frames.late(now))
        self._draw()
        self._reaction = Reaction((), now + DRAW_EVERY)
        return self._reaction

    def stop(self, _now: Nanoseconds) -> Reaction:
        """Draw for the last time: what is printed after it stands below."""
        self._draw()
        self._end()
        return Reaction()


def run(given: MonitorOptions) -> None:
    """Run `monitor` with these options; an error ends the program with a message."""
    if given.ask and given.log is not None:
        raise refusal("--ask: a recording answers no one; leave out --ask or --log")
    if (given.filter_ or given.node) and not (given.lines or given.changes):
        raise refusal("--filter and --node choose among frames: add --lines or --changes")
    if given.log is None:
        _live(given, _picture(given))
        return
    _show_log(given, given.log)


def _show_log(given: MonitorOptions, log: Path) -> None:
    from firmware_bridge.recording import is_chunk

    if given.interface is not None or given.duration is not None:
        raise refusal("--log: a recording has no interface and no duration; leave out -i and --duration")
    if given.live:
        raise refusal("--live: `firmware-bridge live` plays recordings in MCAP; leave out --live or --log")
    if TELEMETRY in log.suffixes:
        raise refusal(
            f"{log}: a telemetry log is no bus: `firmware-bridge replay` plays it, and MAVLink's tools "
            "show it (QGroundControl, mavlogdump.py)"
        )
    if can_files.is_foreign(log):
        _show_frames(given, foreign(log))
        return
    lines = numbered(log)
    first = list(islice(lines, 1))
    # The first line decides the format, and is put back before the others.
    if first and is_chunk(first[0][1]):
        _show_lines(given, log, chain(first, lines))
        return
    _show_frames(given, candump(log, chain(first, lines)))


def _show_frames(given: MonitorOptions, frames: Iterator[Frame]) -> None:
    """Draw what a bus has carried."""
    from firmware_bridge.cli.monitor_table import drawn
    from firmware_bridge.cli.tables import terminal

    picture = _picture(given)
    shown = _frame_lines(given, picture)
    note = picture.note if shown is None else shown.note
    for at, packet in of_one_bus(str(given.log), given.channel, frames):
        note(at, packet)
    if shown is None:
        terminal().print(drawn(picture))


def _frame_lines(given: MonitorOptions, picture: "BusPicture") -> "FrameLines | None":
    """Return what prints frames; None where the picture is drawn."""
    if not (given.lines or given.changes):
        return None
    from firmware_bridge.cli.monitor_frames import FrameLines, chosen

    return FrameLines(picture, chosen(given.filter_, given.node), changes=given.changes)


def _show_lines(given: MonitorOptions, log: Path, lines: Iterator[tuple[int, str]]) -> None:
    """Show the decoded traffic of lines."""
    numbered = iter(lines)
    first = list(islice(numbered, 1))
    if given.robot is None and not _names_its_side(first):
        raise refusal(
            f"{log}: holds the bytes of lines; name their robot with --robot, as its protocols read them"
        )
    # With it come pydantic and every installed robot.
    from firmware_bridge.cli.monitor_lines import LinesOrder, show_lines

    show_lines(LinesOrder(log, given.robot, given.protocol, given.channel), chain(first, numbered))


def _names_its_side(first: list[tuple[int, str]]) -> bool:
    """Return whether a device has recorded it, with its protocol."""
    from firmware_bridge.recording import RecordingError, parse_chunk, side_of

    try:
        return bool(first) and side_of(parse_chunk(first[0][1].rstrip("\r\n"))[2].link)[1] is not None
    except RecordingError:
        return False


def _live(given: MonitorOptions, picture: "BusPicture") -> None:
    from rich.live import Live

    from firmware_bridge.cli.monitor_clock import GatheringClock
    from firmware_bridge.cli.monitor_mappings import MappingReader
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.cli.tables import terminal
    from firmware_bridge.live.messages import LIVE
    from firmware_bridge.node import CAN
    from firmware_bridge.runtime.ports import open_can

    frames, clock = _frame_lines(given, picture), None
    with ExitStack() as stack:
        if frames is not None:
            node = Listening(picture, lambda texts: _lines(picture, texts), lambda: None, frames)
        elif on_a_terminal():
            # Only the node draws: a thread of its own would read the picture while a frame changes it.
            live = Live(console=terminal(), auto_refresh=False, redirect_stdout=False, redirect_stderr=False)
            shown, clock = stack.enter_context(live), GatheringClock()
            draw = partial(_draw, shown, picture)
            node = Listening(picture, lambda _: None, draw, end=shown.stop)
        else:
            stack.callback(_at_the_end, picture)
            node = Listening(picture, lambda texts: _lines(picture, texts), lambda: None)
        bus: Node = MappingReader(node, picture) if given.ask else node
        page: dict[str, Callable[[], Port]] = {}
        if given.live:
            bus, page = _on_page(bus, picture, given), {LIVE: page_port}
        carry(
            bus,
            {CAN: lambda: open_can(given.interface, given.channel, picture.bit_rate, say=say), **page},
            until(given.duration),
            f"listening on {given.channel or 'the configured bus'}",
            clock=clock,
        )


def _on_page(node: "Node", picture: "BusPicture", given: MonitorOptions) -> "Node":
    from firmware_bridge.explain.explainer import BusExplainer, Setup
    from firmware_bridge.live.bus import LiveBus
    from firmware_bridge.live.monitor import LiveMonitor

    known = stated_bus(given)
    setup = Setup(
        bit_rate=known.bit_rate, device=known.device, sheet=known.sheet, expected=tuple(known.expected)
    )
    title = given.channel or "the configured bus"
    return LiveMonitor(node, LiveBus(picture, BusExplainer(setup), title), title)


def _draw(shown: "Live", picture: "BusPicture") -> None:
    from firmware_bridge.cli.monitor_table import drawn

    shown.update(drawn(picture), refresh=True)


def _at_the_end(picture: "BusPicture") -> None:
    """Print the received traffic, also where the bus was lost; an empty table would hide the message."""
    from firmware_bridge.cli.monitor_table import drawn
    from firmware_bridge.cli.tables import terminal

    if picture.frames:
        terminal().print(drawn(picture))
    elif sys.exc_info()[0] is None:
        say("nothing was received")


def on_a_terminal() -> bool:
    """Return whether the output is a terminal."""
    return sys.stdout.isatty()


def _lines(picture: "BusPicture", texts: tuple[str, ...]) -> None:
    from firmware_bridge.cli.monitor_grid import printable
    from firmware_bridge.cli.monitor_table import instant

    for text in texts:
        say(f"{instant(picture, picture.now)}  {printable(text)}")


def _picture(given: MonitorOptions) -> "BusPicture":
    """Return a picture without traffic; with the drives of a robot where one was named."""
    from firmware_bridge.dissector.bus_picture import BusPicture

    bus = stated_bus(given)
    return BusPicture(bus.bit_rate, bus.expected, bus.sheet, device=bus.device)


monitor: Final = command(EXAMPLES, work=run)(MonitorOptions)
