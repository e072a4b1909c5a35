"""`epos2 nmt`: network commands to one drive or to all."""

import json
from enum import Enum
from typing import Annotated, Final

import typer

from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import say
from firmware_bridge.families.epos2.commands.drive_options import JsonOption, NetworkNodeOption
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.network_command import NetworkCommand

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 nmt start --node 0 -i socketcan -c can0` starts all nodes.

`firmware-bridge epos2 nmt reset-node --node 3 --serial /dev/ttyUSB0` goes through the drive on the line."""


class Named(Enum):
    """Network commands as they are spelt here."""

    START = "start"
    STOP = "stop"
    ENTER_PRE_OPERATIONAL = "pre-operational"
    RESET_NODE = "reset-node"
    RESET_COMMUNICATION = "reset-communication"


@command(EXAMPLES)
@one_drive(NetworkNodeOption)
def nmt(
    drive: OneDrive,
    command: Annotated[
        Named, typer.Argument(metavar="COMMAND", help=f"One of: {', '.join(each.value for each in Named)}.")
    ],
    *,
    as_json: JsonOption = False,
) -> None:
    """Send a network command, and check that one drive executes it; --node 0 addresses all, unchecked.

    A reset switches the power stage off: a motor that turned runs out, and only a brake holds a load. In
    Stopped a drive answers nothing but network commands. The drive is left in the state that it was sent to.
    """
    sent = NetworkCommand(NmtCommand[command.name], drive.node)
    drive.finish(sent.script())
    if as_json:
        say(json.dumps({"node": sent.node, "command": command.value, "seen": sent.seen}))
        return
    effect = "and the drive did so" if sent.seen else "and no one answers that"
    say(f"sent: {command.value} to {drive.title}, {effect}")
