"""Results of a campaign's runs as rows: the key, the numbers but those of the clock, what failed."""

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from emulators.bench.summary import Summary
from emulators.campaign.campaign_file import Require
from emulators.campaign.plan import Run
from firmware_bridge.extras import from_extras

TIMED: Final = frozenset({"wall_s", "realtime_factor"})
"""Numbers of the machine: not the same in the next run."""
KEYS: Final = frozenset({"robot", "mission", "seed"})
"""What the key has, too."""
ERROR: Final = -1
"""In place of a requirement's: the run ended in an error."""
Value = float | int | str | bool | None


@dataclass(frozen=True, slots=True)
class Row:
    """One run: its key, its numbers, and each requirement that it breaks, by its place, or ERROR."""

    key: Mapping[str, Any]
    figures: Mapping[str, Value]
    broken: Mapping[int, str]

    @property
    def run(self) -> int:
        """Its number in the campaign."""
        return int(self.key["run"])

    def number(self, name: str) -> float | None:
        """Return a number of its summary; None where it has none."""
        return _number(self.figures, name)

    @property
    def flat(self) -> dict[str, Value]:
        """Everything, a column each."""
        return {**self.key, **self.figures, "failed": "; ".join(self.broken.values())}


def figures_of(summary: Summary) -> dict[str, Value]:
    """Return a summary's numbers, and the interlocks that became active, each once."""
    table = asdict(summary)
    flat = {key: value for key, value in table.items() if key not in TIMED | KEYS and _plain(value)}
    active = dict.fromkeys(event.name for event in summary.interlock_events)
    return {**flat, **summary.largest, **summary.figures, "interlocks": "; ".join(active)}


def broken(figures: Mapping[str, Value], require: Sequence[Require]) -> dict[int, str]:
    """Return the requirements that a run breaks, by their places."""
    stated = ((place, _broken(figures, row)) for place, row in enumerate(require))
    return {place: text for place, text in stated if text}


def error_row(run: Run, error: str) -> Row:
    """Return the row of a run that ended in an error."""
    return Row(run.key, {}, {ERROR: error})


def columns(rows: Iterable[Row]) -> list[str]:
    """Return the columns of all rows, in the order in which they come; `failed` is the last."""
    found = dict.fromkeys(name for row in rows for name in row.flat)
    found.pop("failed", None)
    return [*found, "failed"]


def as_csv(rows: Sequence[Row]) -> str:
    """Return the rows as CSV, in full precision; what a run has not is empty."""
    text = io.StringIO(newline="")
    table = csv.DictWriter(text, columns(rows), lineterminator="\n")
    table.writeheader()
    table.writerows(row.flat for row in rows)
    return text.getvalue()


def write_parquet(rows: Sequence[Row], path: Path) -> None:
    """Write the rows as Parquet; ExtraMissingError without its extra, OSError."""
    with from_extras():
        import pyarrow as pa  # type: ignore[import-untyped] # noqa: PLC0415 - an extra
        from pyarrow import parquet  # noqa: PLC0415 - as above

    flat = [row.flat for row in rows]
    parquet.write_table(
        pa.table({name: _column([row.get(name) for row in flat]) for name in columns(rows)}), path
    )


def as_json(row: Row) -> str:
    """Return a row in one line."""
    return json.dumps([dict(row.key), dict(row.figures), list(row.broken.items())], ensure_ascii=False)


def of_json(line: str) -> Row:
    """Return the row of such a line; ValueError where it is none."""
    key, figures, failed = json.loads(line)
    return Row(key, figures, dict(failed))


def _number(figures: Mapping[str, Value], name: str) -> float | None:
    value = figures.get(name)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value)


def _column(values: list[Value]) -> list[Value]:
    # A column has one kind: whole numbers beside others become such, and texts beside numbers texts.
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [None if value is None else str(value) for value in values]
    return values


def _plain(value: object) -> bool:
    return value is None or isinstance(value, (bool, int, float, str))


def _broken(figures: Mapping[str, Value], row: Require) -> str:
    active = str(figures.get("interlocks", "")).split("; ")
    if row.never:
        return f"'{row.never}' became active" if row.never in active else ""
    if row.always:
        return "" if row.always in active else f"'{row.always}' did not become active"
    value = _number(figures, row.key)
    if value is None:
        return f"{row.key} has no value"
    if row.most is not None and not value <= row.most:
        return f"{row.key} = {value:g} is above {row.most:g}"
    return (
        f"{row.key} = {value:g} is below {row.least:g}"
        if row.least is not None and not value >= row.least
        else ""
    )
