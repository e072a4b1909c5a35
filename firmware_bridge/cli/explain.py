"""`explain`: what a recording of a bus shows, with causes and remedies; and what a number means."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

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
from firmware_bridge.cli.console import FAILED, one_message, refusal, say
from firmware_bridge.cli.options import FirmwareOption, RobotBitRateOption

if TYPE_CHECKING:
    from firmware_bridge.explain.codes import Reading
    from firmware_bridge.explain.explainer import Explained, Setup
    from firmware_bridge.explain.line_explainer import Lines

UNREADABLE: Final = 3
BIT_RATE: Final = 1_000_000
"""Bit rate in bit/s, where neither the robot file nor an option gives it."""
EXAMPLES: Final = """Examples:

`firmware-bridge explain can.log`, or the folder of a run, as `out/rars-faults`

`firmware-bridge explain can.log --robot rars` names the drives, and knows their PDOs at once.

`firmware-bridge explain serial.log --robot rome --protocol mw`, the bytes of a serial line

`firmware-bridge explain capture.pcapng --device epos2 --markdown >> $GITHUB_STEP_SUMMARY`

`firmware-bridge explain 0x8130`, `firmware-bridge explain 0x06090011`

`firmware-bridge explain statusword 0x0537`, `firmware-bridge explain controlword 0x1F`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainOptions:
    """Explain a recording of a bus or a line, or a code: incidents, causes, why a drive does not move.

    It reads candump's logs (also .gz and .xz), .mcap, .asc, .blf and .trc, pcap and pcapng with SocketCAN
    frames, serial.log of a run or of a device, and the folder of a run. In place of a recording it takes a
    number: an error code, an SDO abort code, a statusword or a controlword. Exit status 0: no incident, or
    the number is known; 1: incidents; 2: a wrong argument, or an unknown number; 3: the recording cannot be
    read.
    """

    what: Annotated[
        list[str],
        typer.Argument(
            metavar="LOG|FOLDER|CODE",
            help="A recording, the folder of a run, or a number: alone, or after a word as statusword.",
            show_default=False,
        ),
    ]
    robot: BusRobotOption = None
    link: BusLinkOption = None
    channel: Annotated[
        str | None,
        typer.Option(
            "--channel",
            "-c",
            metavar="BUS",
            help="One of several buses or lines in the recording.",
            show_default="each by itself",
        ),
    ] = None
    bit_rate: RobotBitRateOption = None
    protocol: FirmwareOption = None
    device: DeviceOption = None
    eds: EdsOption = None
    dcf: DcfOption = None
    as_json: Annotated[bool, typer.Option("--json", help="Print data for programs.")] = False
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print a table for a CI summary.")] = False


def run(given: ExplainOptions) -> None:
    """Run `explain` with these options; an error ends the program with a message."""
    if given.as_json and given.as_markdown:
        raise refusal("--json and --markdown: choose one of them")
    words = tuple(word for argument in given.what for word in argument.split())
    path = Path(given.what[0])
    if len(given.what) == 1 and path.exists():
        _explain_log(given, path)
        return
    from firmware_bridge.explain.codes import names, readings

    found = readings(words)
    if found is None:
        if len(given.what) == 1 and (path.suffix or len(path.parts) > 1):
            raise refusal(f"{path}: no such file or folder; name a recording as can.log", UNREADABLE)
        raise refusal(
            f"'{' '.join(words)}': neither a recording nor a number; use can.log, 0x8130, or one of "
            f"{', '.join(names())} before a number"
        )
    if not found:
        raise refusal(f"'{' '.join(words)}': a number that is in no list; is it complete, as 0x06090011?")
    _show_readings(given, " ".join(words), found)


def _show_readings(given: ExplainOptions, words: str, found: "tuple[Reading, ...]") -> None:
    if given.as_json:
        rows = [{"kind": one.kind, "title": one.title, "lines": list(one.lines)} for one in found]
        say(json.dumps({"format": 1, "number": words, "readings": rows}, indent=2))
        return
    mark = "* " if given.as_markdown else ""
    for one in found:
        say(f"{mark}{one.title}")
        for line in one.lines:
            say(f"    {mark}{line}" if mark else f"    {line}")


def _explain_log(given: ExplainOptions, path: Path) -> None:
    from firmware_bridge.explain.explainer import explain
    from firmware_bridge.explain.line_source import beside, line_log
    from firmware_bridge.explain.source import UnreadableError, frames

    notes = list(beside(path))
    log = line_log(path)
    if log is None and given.protocol is not None:
        raise refusal(f"--protocol {given.protocol}: {path} is a recording of frames, not of serial lines")
    with one_message(UnreadableError, status=UNREADABLE):
        if log is not None:
            explained = _explain_lines(given, log, notes)
        else:
            explained = explain(frames(path, notes.append), _setup(given), given.channel)
    for note in dict.fromkeys(notes):
        say(f"firmware-bridge: {note}", err=True)
    if not explained.frames:
        channel = "" if given.channel is None else f" of '{given.channel}'"
        raise refusal(f"{path}: holds no frame{channel}; record a bus with `candump -L`", UNREADABLE)
    _show(given, explained, str(path))
    if explained.incidents:
        raise typer.Exit(FAILED)


def _explain_lines(given: ExplainOptions, log: Path, notes: list[str]) -> "Explained":
    """Explain the lines of a recording, by the robot that is named, or as it was driven."""
    from firmware_bridge.explain.line_explainer import explain_lines
    from firmware_bridge.explain.line_source import chunks

    return explain_lines(chunks(log, notes.append), _lines(given, log))


def _lines(given: ExplainOptions, log: Path) -> "Lines":
    """Return what the options, or the file of the run beside the recording, state of the lines."""
    from firmware_bridge.cli.fitted import linked
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.dissector import kinds_of
    from firmware_bridge.explain.explainer import Setup
    from firmware_bridge.explain.line_explainer import Lines
    from firmware_bridge.family import LinkOptions, family_of
    from firmware_bridge.node import CAN, SERIAL
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.runtime.run_file import read_run

    with one_message(RobotFileError):
        if given.robot is None:
            run = read_run(log.parent)
            robot = None if run is None else run.robot
        else:
            robot = find_robot(given.robot)
        if robot is None:
            spoken = {} if given.protocol is None else {given.channel or "": given.protocol}
            return Lines(spoken, Setup(), given.channel)
        if given.protocol is not None:
            robot = linked(robot, LinkOptions(given.protocol))
    # A link with bytes in a log of lines was driven over a line, whatever the robot file gives.
    kinds = {name: SERIAL if kind == CAN else kind for name, kind in kinds_of(robot).items()}
    nodes = tuple(one for name, link in robot.links.items() for one in family_of(link).expected(robot, name))
    return Lines(kinds, Setup(expected=nodes), given.channel)


def _show(given: ExplainOptions, explained: "Explained", source: str) -> None:
    from firmware_bridge.explain import report

    if given.as_json:
        say(json.dumps(report.data(explained, source), indent=2))
        return
    for line in (report.markdown if given.as_markdown else report.text)(explained, source):
        say(line)


def _setup(given: ExplainOptions) -> "Setup":
    """Return what the options state of the bus."""
    from firmware_bridge.explain.explainer import Setup

    bus = stated_bus(given)
    return Setup(bit_rate=bus.bit_rate, device=bus.device, sheet=bus.sheet, expected=bus.expected)


explain: Final = command(EXAMPLES, work=run)(ExplainOptions)
