"""`doctor`: what this machine has, what is missing, and how to fix it."""

import json
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, say

_NEEDED: Final = "red"


EXAMPLES: Final = """Examples:

`firmware-bridge doctor`

`firmware-bridge doctor --json > machine.json` for a bug report"""


@command(EXAMPLES)
def doctor(
    *,
    as_json: Annotated[
        bool, typer.Option("--json", help="Output for programs and bug reports, as JSON.")
    ] = False,
) -> None:
    """Check this machine: available, missing and critical items, and how to fix them.

    Python, libraries, compiler, plants, kernel, CAN interfaces, serial ports, clock, load. No bus and no port
    is opened. Exit status 1 where something is missing that nothing works without; what only some need, as a
    CAN interface, does not count.
    """
    from rich.table import Table
    from rich.text import Text

    from emulators.doctor.gather import gather
    from emulators.doctor.rows import ROWS, CheckResult, lacks
    from firmware_bridge.cli.tables import terminal

    styles = {CheckResult.OK: "green", CheckResult.CAREFUL: "yellow", CheckResult.MISSING: "yellow"}
    facts = gather()
    findings = [(row, row.judge(facts)) for row in ROWS]
    missing = lacks(facts)
    if as_json:
        rows = [
            {
                "looked_at": row.title,
                "found": one.found,
                "verdict": one.verdict.value,
                "remedy": one.remedy,
                "needed": row.needed,
            }
            for row, one in findings
        ]
        say(json.dumps({"rows": rows, "missing": list(missing)}, indent=2))
    else:
        table = Table(title="this machine")
        for heading in ("looked at", "found", "", "how to fix it"):
            table.add_column(heading, overflow="fold")
        for row, one in findings:
            style = _NEEDED if row.title in missing else styles[one.verdict]
            verdict = Text(one.verdict.value, style)
            table.add_row(Text(row.title), Text(one.found), verdict, Text(one.remedy))
        terminal().print(table)
        say(f"needed, and missing: {', '.join(missing)}" if missing else "nothing that is needed is missing")
    if missing:
        raise typer.Exit(FAILED)
