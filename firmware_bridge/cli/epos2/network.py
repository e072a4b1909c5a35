"""`epos2 nmt`: network commands to one drive or to all."""

import json
from enum import Enum
from typing import Annotated, Final

import typer

from firmware_bridge.cli.epos2.line import line_to
from firmware_bridge.cli.epos2.options import (
    BaudOption,
    GatewayOption,
    JsonOption,
    LineProtocolOption,
    NetworkNodeOption,
    SerialPortOption,
)
from firmware_bridge.cli.options import BitRateOption, ChannelOption, InterfaceOption
from firmware_bridge.drivers.commissioning.network import NetworkCommand
from firmware_bridge.wire.canopen import NmtCommand

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


def nmt(
    command: Annotated[
        Named, typer.Argument(metavar="COMMAND", help=f"One of: {', '.join(each.value for each in Named)}.")
    ],
    *,
    node: NetworkNodeOption = None,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    bit_rate: BitRateOption = None,
    serial: SerialPortOption = None,
    baud: BaudOption = None,
    protocol: LineProtocolOption = None,
    gateway: GatewayOption = None,
    as_json: JsonOption = False,
) -> None:
    """Send a network command, and see that one drive obeys it; --node 0 means all, and looks at none.

    A reset switches the power stage off: a motor that turned runs out, and only a brake holds a load. In
    Stopped a drive answers nothing but network commands. The drive is left in the state that it was sent to.
    """
    drive = line_to(
        node,
        interface=interface,
        channel=channel,
        bit_rate=bit_rate,
        serial=serial,
        baud=baud,
        protocol=protocol,
        gateway=gateway,
    )
    sent = NetworkCommand(NmtCommand[command.name], drive.node)
    drive.finish(sent.script())
    if as_json:
        typer.echo(json.dumps({"node": sent.node, "command": command.value, "seen": sent.seen}))
        return
    effect = "and the drive did so" if sent.seen else "and nobody answers that"
    typer.echo(f"sent: {command.value} to {drive.title}, {effect}")
