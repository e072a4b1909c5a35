"""`doctor`: what this machine has, what is missing, and how to mend it."""

from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command

EXAMPLES: Final = """Examples:

`firmware-bridge doctor`

`firmware-bridge doctor --json > machine.json` for a bug report"""


@command(EXAMPLES, work="emulators.cli.doctor_work:doctor")
def doctor(
    *, as_json: Annotated[bool, typer.Option("--json", help="For programs, and for bug reports.")] = False
) -> None:
    """Look at this machine: what is there, what is missing, what to be careful of, and how to mend it.

    Python, libraries, compiler, plants, kernel, CAN interfaces, serial ports, clock, load. No bus and no port
    is opened. Exit status 1 where something is missing that nothing works without; what only some need, as a
    CAN interface, does not count.
    """
