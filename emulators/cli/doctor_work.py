"""Looks at the machine, and says what it found."""

import json
from typing import Final

import typer
from rich.table import Table
from rich.text import Text

from emulators.doctor.gather import gather
from emulators.doctor.rows import ROWS, Verdict, lacks
from firmware_bridge.cli.console import FAILED, say
from firmware_bridge.cli.tables import terminal

_STYLES: Final = {Verdict.OK: "green", Verdict.CAREFUL: "yellow", Verdict.MISSING: "yellow"}
_NEEDED: Final = "red"


def doctor(*, as_json: bool) -> None:
    """Do what `doctor` says."""
    facts = gather()
    said = [(row, row.judge(facts)) for row in ROWS]
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
            for row, one in said
        ]
        say(json.dumps({"rows": rows, "missing": list(missing)}, indent=2))
    else:
        table = Table(title="this machine")
        for heading in ("looked at", "found", "", "how to mend it"):
            table.add_column(heading, overflow="fold")
        for row, one in said:
            style = _NEEDED if row.title in missing else _STYLES[one.verdict]
            verdict = Text(one.verdict.value, style)
            table.add_row(Text(row.title), Text(one.found), verdict, Text(one.remedy))
        terminal().print(table)
        say(f"needed, and missing: {', '.join(missing)}" if missing else "nothing that is needed is missing")
    if missing:
        raise typer.Exit(FAILED)
