"""`epos2 read`: objects of a drive, once or again and again."""

import json
import sys
from functools import partial
from typing import Annotated, Final

import typer
from rich.live import Live
from rich.text import Text

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, one_message, say
from firmware_bridge.cli.options import DurationOption, until
from firmware_bridge.cli.tables import terminal
from firmware_bridge.families.epos2.commands.drive_options import JsonOption, OptionalPeriod
from firmware_bridge.families.epos2.commands.object_text import object_line, object_record
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.error_text import error_text
from firmware_bridge.families.epos2.commissioning.job import JobError
from firmware_bridge.families.epos2.commissioning.names import UnknownObjectError, find
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.units import Nanoseconds, from_seconds

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 read statusword profile-velocity -i socketcan -c can0 --node 3`

`firmware-bridge epos2 read 0x60F6:1 "position actual value" --serial /dev/ttyUSB0 --watch 0.5`"""

ObjectsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="OBJECT",
        help="Names as `epos2 objects` lists them, dashes for spaces; or 0x6081, or 0x60F6:1.",
        show_default=False,
    ),
]
WatchOption = Annotated[
    float | None,
    typer.Option(
        "--watch",
        "-w",
        min=0.001,
        max=3600.0,
        metavar="[SECONDS]",
        help="Read repeatedly, and show changes; without a value every 0.2 s. Ctrl-C ends it.",
        show_default=False,
    ),
]


@command(EXAMPLES, kind=OptionalPeriod)
@one_drive()
def read(
    drive: OneDrive,
    objects: ObjectsArgument,
    *,
    watch: WatchOption = None,
    duration: DurationOption = None,
    as_json: JsonOption = False,
) -> None:
    """Read objects of a drive, with their names, units, and decoded bits.

    Exit status 1 where the drive refuses one of them. Reading changes nothing in the drive.
    """
    with one_message(UnknownObjectError):
        reading = Reading([find(each) for each in objects])
    if watch is not None:
        _watch(drive, reading, from_seconds(watch), until(duration), as_json=as_json)
        return
    drive.finish(reading.once())
    say(_record(drive, reading) if as_json else _lines(reading))
    _end_where_refused(drive, reading)


def _lines(reading: Reading) -> str:
    return "\n".join(object_line(reading, address) for address in reading.addresses)


def _record(drive: OneDrive, reading: Reading, indent: int | None = 2) -> str:
    objects = [object_record(reading, address) for address in reading.addresses]
    return json.dumps({"node": drive.node, "objects": objects}, indent=indent)


def _end_where_refused(drive: OneDrive, reading: Reading) -> None:
    found = (reading.found.get(address) for address in reading.addresses)
    refused = [each for each in found if isinstance(each, JobError)]
    for each in refused:
        say(f"firmware-bridge: {error_text(each, drive.title, drive.silence)}", err=True)
    if refused:
        raise typer.Exit(FAILED)


def _watch(
    drive: OneDrive, reading: Reading, period: Nanoseconds, end: Nanoseconds, *, as_json: bool
) -> None:
    if as_json:
        drive.converse(
            reading.again_and_again(period, lambda: say(_record(drive, reading, indent=None))), end
        )
    elif sys.stdout.isatty():
        with Live(console=terminal(), auto_refresh=False) as shown:
            redraw = partial(_redraw, shown, reading)
            drive.converse(reading.again_and_again(period, redraw), end)
    else:
        changes = Changes(reading)
        drive.converse(reading.again_and_again(period, changes.show), end)


def _redraw(shown: Live, reading: Reading) -> None:
    shown.update(Text(_lines(reading)), refresh=True)


class Changes:
    """Reports each object in a line of its own when it first comes, and whenever it is another."""

    def __init__(self, reading: Reading) -> None:
        self._reading = reading
        self._shown: dict[str, str] = {}

    def show(self) -> None:
        """Print what has changed."""
        for address in self._reading.addresses:
            line = object_line(self._reading, address)
            if self._shown.get(str(address)) != line:
                self._shown[str(address)] = line
                say(line)
