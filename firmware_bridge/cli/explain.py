"""`explain`: what a recording of a bus shows, with causes and remedies; and what a number means."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import FAILED, WRONG_INPUT, one_message, refusal, say
from firmware_bridge.cli.options import RobotBitRateOption

if TYPE_CHECKING:
    from collections.abc import Mapping

    from firmware_bridge.canopen.address import Address
    from firmware_bridge.canopen.object_row import ObjectRow
    from firmware_bridge.dissector.expected import Expected
    from firmware_bridge.explain.codes import Reading
    from firmware_bridge.explain.explainer import Explained, Setup

UNREADABLE: Final = 3
BIT_RATE: Final = 1_000_000
"""Bit rate in bit/s, where neither the robot file nor an option gives it."""
EXAMPLES: Final = """Examples:

`firmware-bridge explain can.log`, or the folder of a run, as `out/rars-faults`

`firmware-bridge explain can.log --robot rars` names the drives, and knows their PDOs at once.

`firmware-bridge explain capture.pcapng --device epos2 --markdown >> $GITHUB_STEP_SUMMARY`

`firmware-bridge explain 0x8130`, `firmware-bridge explain 0x06090011`

`firmware-bridge explain statusword 0x0537`, `firmware-bridge explain controlword 0x1F`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainOptions:
    """Explain a recording of a CAN bus, or a code: incidents, causes, why a drive does not move.

    It reads candump's logs (also .gz and .xz), .asc, .blf and .trc, pcap and pcapng with SocketCAN frames,
    and the folder of a run. In place of a recording it takes a number: an error code, an SDO abort code, a
    statusword or a controlword. Exit status 0: no incident, or the number is known; 1: incidents; 2: a wrong
    argument, or an unknown number; 3: the recording cannot be read.
    """

    what: Annotated[
        list[str],
        typer.Argument(
            metavar="LOG|FOLDER|CODE",
            help="A recording, the folder of a run, or a number: alone, or after a word as statusword.",
            show_default=False,
        ),
    ]
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT",
            help="Robot on the bus: a name that `robots` lists, or the path of a robot file.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None
    link: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="The bus of a robot with several CAN buses.", show_default="the only one"
        ),
    ] = None
    channel: Annotated[
        str | None,
        typer.Option(
            "--channel",
            "-c",
            metavar="BUS",
            help="One of several buses in the recording.",
            show_default="each by itself",
        ),
    ] = None
    bit_rate: RobotBitRateOption = None
    device: Annotated[
        str | None,
        typer.Option(
            metavar="FAMILY",
            help="Family of nodes whose PDO mapping was not seen to be written, as epos2: they have "
            "its defaults.",
            show_default="by the vendor number that a node reports (0x1018:1), else not known",
        ),
    ] = None
    eds: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Electronic data sheet with such defaults.", show_default=False),
    ] = None
    dcf: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Device configuration file of a node; may be repeated.",
            show_default=False,
        ),
    ] = None
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
    from firmware_bridge.explain.source import UnreadableError, frames

    setup = _setup(given)
    notes: list[str] = []
    with one_message(UnreadableError, status=UNREADABLE):
        explained = explain(frames(path, notes.append), setup, given.channel)
    for note in dict.fromkeys(notes):
        say(f"firmware-bridge: {note}", err=True)
    if not explained.frames:
        channel = "" if given.channel is None else f" of '{given.channel}'"
        raise refusal(f"{path}: holds no frame{channel}; record a bus with `candump -L`", UNREADABLE)
    _show(given, explained, str(path))
    if explained.incidents:
        raise typer.Exit(FAILED)


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

    device, sheet = _device(given), _sheet(given)
    if given.robot is None:
        if given.link is not None:
            raise refusal(f"--link {given.link}: only a robot has links; use --robot, too")
        return Setup(
            bit_rate=given.bit_rate or BIT_RATE, device=device, sheet=sheet, expected=_configured(given)
        )
    # With them come pydantic and every installed robot.
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.dissector.expected import can_links, expected_on

    robot = find_robot(given.robot)
    links = can_links(robot)
    if not links:
        raise refusal(f"--robot {given.robot}: {robot.name} has no drives on a CAN bus; leave --robot out")
    link = links[0] if given.link is None and len(links) == 1 else given.link
    if link not in links:
        raise refusal(f"{robot.name} is on these buses: {', '.join(links)}; select one with --link")
    return Setup(
        bit_rate=given.bit_rate or robot.links[link].rate,
        device=device,
        sheet=sheet,
        expected=(*expected_on(robot, link), *_configured(given)),
    )


def _device(given: ExplainOptions) -> str:
    from firmware_bridge.dissector.dictionary import dictionaries

    if given.device is None:
        return ""
    known = dictionaries()
    if given.device not in known:
        raise refusal(f"--device {given.device}: there is {', '.join(known)}; for any other use --eds FILE")
    return given.device


def _rows(given: ExplainOptions) -> "Mapping[Address, ObjectRow]":
    """Return the objects that a data sheet may have: the named family's, or those of all."""
    from firmware_bridge.dissector.dictionary import dictionaries

    named, every = _device(given), dictionaries()
    return {at: row for name in ([named] if named else every) for at, row in every[name].rows.items()}


def _sheet(given: ExplainOptions) -> "Mapping[Address, int] | None":
    from firmware_bridge.runtime.data_sheets import SheetError, defaults

    with one_message(SheetError):
        return None if given.eds is None else defaults(given.eds, _rows(given)).values


def _configured(given: ExplainOptions) -> "tuple[Expected, ...]":
    """Return the nodes of configuration files; one that names none ends the program with a message."""
    from firmware_bridge.dissector.expected import Expected
    from firmware_bridge.runtime.data_sheets import SheetError, configured

    found, rows = [], _rows(given) if given.dcf else {}
    for file in given.dcf or ():
        with one_message(SheetError, status=WRONG_INPUT):
            sheet = configured(file, rows)
        if not sheet.node:
            raise refusal(f"--dcf {file}: it names no node; give [DeviceComissioning] its NodeID")
        # As if a controller had written these values, so that the PDOs' mapping is known.
        written = tuple((address, rows[address].type.encode(v)) for address, v in sheet.values.items())
        found.append(Expected(sheet.node, "", written))
    return tuple(found)


explain: Final = command(EXAMPLES, work=run)(ExplainOptions)
