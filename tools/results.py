# ruff: noqa: INP001 - a script's neighbor, not a package
"""Results of the campaign so far, in two files: the survivors, and the reasons to accept them.

`mutate_results.toml` is written by the campaign, module by module; `mutate_survivors.toml` by people.
"""

import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from mutants import Key

RESULTS: Final = Path(__file__).with_name("mutate_results.toml")
REASONS: Final = Path(__file__).with_name("mutate_survivors.toml")
HEAD: Final = """\
# What the mutation campaign has found, written by tools/mutate.py: for each module what it ran on, how many
# mutants it has, which of them survived, and what its tests and a mutant cost the processor in milliseconds.
"""


@dataclass(frozen=True, slots=True)
class Result:
    """One module's campaign, from its beginning to its end."""

    source: str
    tests: str
    operators: str
    """Hashes of what it ran on."""
    mutants: int
    tests_ms: int
    mutant_ms: int
    survived: tuple[tuple[str, str], ...]
    """Line of source, and change."""

    def ran_on(self, hashes: tuple[str, str, str]) -> bool:
        """Return whether it is of these sources."""
        return (self.source, self.tests, self.operators) == hashes


def read_results() -> dict[str, Result]:
    """Return what is known, by module."""
    if not RESULTS.exists():
        return {}
    found = tomllib.loads(RESULTS.read_text(encoding="utf-8")).get("module", [])
    return {
        row.pop("name"): Result(**row | {"survived": tuple((code, how) for code, how in row["survived"])})
        for row in found
    }


def write_results(results: Mapping[str, Result]) -> None:
    """Write all of it at once, or nothing."""
    text = HEAD + "".join(_row(name, results[name]) for name in sorted(results))
    new = RESULTS.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    os.replace(new, RESULTS)  # noqa: PTH105 - one step


def read_reasons() -> dict[Key, str]:
    """Return the known survivors and why nothing can notice them."""
    rows = tomllib.loads(REASONS.read_text(encoding="utf-8")).get("survivor", [])
    return {(row["module"], row["code"], row["change"]): row["reason"] for row in rows}


def _row(name: str, result: Result) -> str:
    survived = "".join(f"\n  [{_text(code)}, {_text(change)}]," for code, change in result.survived)
    return (
        f'\n[[module]]\nname = "{name}"\nsource = "{result.source}"\ntests = "{result.tests}"\n'
        f'operators = "{result.operators}"\nmutants = {result.mutants}\n'
        f"tests_ms = {result.tests_ms}\nmutant_ms = {result.mutant_ms}\n"
        f"survived = [{survived}{chr(10) if survived else ''}]\n"
    )


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
