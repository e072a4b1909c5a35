"""`epos2`: one drive at the command line. Other packages add commands of their own to the group."""

from typing import Final

import typer

from firmware_bridge.cli.epos2 import network, read, state, version, write
from firmware_bridge.cli.epos2.arguments import NegativeValue, OptionalPeriod

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 read statusword "profile velocity" -i socketcan -c can0 --node 3`

`firmware-bridge epos2 write profile-velocity 500rpm --serial /dev/ttyUSB0`

`firmware-bridge epos2 state --serial /dev/ttyUSB0 --protocol v2`"""

group = typer.Typer(
    help="One EPOS2 drive, real or emulated, over CAN or a serial line: its objects, its state.",
    no_args_is_help=True,
)
group.command(epilog=read.EXAMPLES, cls=OptionalPeriod)(read.read)
group.command(epilog=write.EXAMPLES, cls=NegativeValue)(write.write)
group.command(epilog=state.EXAMPLES)(state.state)
group.command(epilog=version.EXAMPLES)(version.version)
group.command(epilog=network.EXAMPLES)(network.nmt)
