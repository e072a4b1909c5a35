"""`epos2 state`: how a drive stands, and bringing it into another state."""

import json
from typing import Annotated, Any, Final

import typer

from firmware_bridge.canopen import objects as od
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import say
from firmware_bridge.families.epos2.commands.confirm import confirm
from firmware_bridge.families.epos2.commands.drive_options import JsonOption, YesOption
from firmware_bridge.families.epos2.commands.object_text import object_record, value_text
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.overview import Overview
from firmware_bridge.families.epos2.commissioning.power import PowerCommand, Wanted
from firmware_bridge.families.epos2.commissioning.words import WORDS

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 state -i socketcan -c can0 --node 3`

`firmware-bridge epos2 state quick-stop --serial /dev/ttyUSB0`

`firmware-bridge epos2 state enable --yes -i socketcan -c can0`"""


@command(EXAMPLES)
@one_drive()
def state(
    drive: OneDrive,
    wanted: Annotated[
        Wanted | None,
        typer.Argument(metavar="COMMAND", help=f"One of: {', '.join(each.value for each in Wanted)}."),
    ] = None,
    *,
    yes: YesOption = False,
    as_json: JsonOption = False,
) -> None:
    """Show a drive's power state, mode, network state and errors; a command changes the power state first.

    `enable` may start a motion, so it needs a confirmation, or --yes. The drive is left in the state that it
    was brought to: an enabled drive stays enabled when this program ends, and nothing watches over it.
    `quick-stop` and `disable` are sent before anything else.
    """
    overview = Overview(alone=drive.alone)
    command = None if wanted is None else PowerCommand(wanted)
    if command is None:
        drive.finish(overview.script())
    else:
        if command.procedure.may_move:
            confirm(f"{command.wanted.value} {drive.title}", "it may start to move", yes=yes)
        drive.finish((*command.script(), *overview.script()))
    if as_json:
        say(json.dumps(_record(drive, overview), indent=2))
        return
    say(_text(drive, overview))
    if command is not None:
        say(f"left so: {command.procedure.leaves}")
    if overview.next_step:
        say(f"next:        {overview.next_step}")


def _text(drive: OneDrive, overview: Overview) -> str:
    standing, history = overview.readings
    errors = [value_text(history, address).partition("  ")[2] for address in history.addresses]
    rows = (
        ("drive", drive.title),
        ("state", "unknown" if overview.state is None else overview.state.title),
        ("statusword", value_text(standing, od.STATUSWORD)),
        ("controlword", value_text(standing, od.CONTROLWORD)),
        ("mode", WORDS.title(overview.mode)),
        ("network", " or ".join(each.title for each in overview.network) or "unknown"),
        ("errors", value_text(standing, od.ERROR_REGISTER)),
        ("history", "\n             ".join(errors) or "empty"),
    )
    return "\n".join(f"{name:<11}  {text}" for name, text in rows)


def _record(drive: OneDrive, overview: Overview) -> dict[str, Any]:
    standing, history = overview.readings
    return {
        "node": drive.node,
        "state": None if overview.state is None else overview.state.title,
        "mode": None
        if overview.mode is None
        else {"number": overview.mode.value, "name": WORDS.title(overview.mode)},
        "network": [each.title for each in overview.network],
        "next": overview.next_step or None,
        "history": [object_record(history, address) for address in history.addresses],
        "objects": [object_record(standing, address) for address in standing.addresses],
    }
