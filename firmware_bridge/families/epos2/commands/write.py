"""`epos2 write`: one object of a drive."""

import json
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.families.epos2.commands.confirm import confirm
from firmware_bridge.families.epos2.commands.drive_options import JsonOption, NegativeValue, YesOption
from firmware_bridge.families.epos2.commands.object_text import object_line, object_record
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.client import Ask, CommissioningError, need
from firmware_bridge.families.epos2.commissioning.job import WriteJob
from firmware_bridge.families.epos2.commissioning.motion import why_it_may_move
from firmware_bridge.families.epos2.commissioning.names import find
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.commissioning.values import LONGEST_WRITE, parse
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 write profile-velocity 500rpm -i socketcan -c can0 --node 3`

`firmware-bridge epos2 write 0x1010:1 save --serial /dev/ttyUSB0`

`firmware-bridge epos2 write target-velocity -200rpm --yes -i socketcan -c can0`"""


@command(EXAMPLES, kind=NegativeValue)
@one_drive()
def write(
    drive: OneDrive,
    wanted: Annotated[
        str,
        typer.Argument(metavar="OBJECT", help="A name as `epos2 objects` lists it, or 0x6081, or 0x60F6:1."),
    ],
    value: Annotated[
        str,
        typer.Argument(
            metavar="VALUE",
            help="A number, decimal or 0x..., with the object's unit or without; a mode's name; save, load.",
        ),
    ],
    *,
    size: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=LONGEST_WRITE,
            help="Bytes to send; a serial line always carries four.",
            show_default="the object's own",
        ),
    ] = None,
    yes: YesOption = False,
    as_json: JsonOption = False,
) -> None:
    """Write one object of a drive. A refusal is shown in the drive's own terms, with exit status 1.

    A write that may start a motion needs a confirmation, or --yes. The drive keeps the value when this
    program ends, and until its next restart; `write 0x1010:1 save` makes it keep all of them.
    """
    with one_message(CommissioningError):
        address = find(wanted)
        raw = parse(address, value, size)
    if isinstance(drive.link, SerialAccess) and size is not None:
        raise refusal("--size: a serial line always carries four bytes; leave it out")
    why = why_it_may_move(address, raw)
    if why is not None:
        confirm(f"write {ANY_TYPE.called(address)} of {drive.title}", why, yes=yes)
    drive.finish((Ask(WriteJob(address, raw), need(lambda _raw: ())),))
    written = Reading([address])
    written.found[address] = raw
    if as_json:
        say(json.dumps({"node": drive.node, "written": object_record(written, address)}, indent=2))
    else:
        say(f"written: {' '.join(object_line(written, address).split())}")
