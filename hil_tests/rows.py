"""Long tables of rows that take microseconds: one test for each table, which names every row that fails.

As a test of its own a row costs pytest two milliseconds, with its set-up, its reports and their way from one
process to another: more than a hundred times what the row takes. What rows could spoil for each other, and
rows of which one at a time is run by its name, stay with `pytest.mark.parametrize`.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from inspect import signature
from typing import Any, Final

import pytest

SHOWN: Final = 10
"""Number of failing rows that are shown whole; the others are named."""

Test = Callable[..., None]


class _Run:
    """Options of the command line."""

    stops_at_once = False
    """With -x the first row that fails ends its table, too."""


def configure(config: pytest.Config) -> None:
    """Take note of the command line."""
    _Run.stops_at_once = config.getoption("maxfail") == 1


def every(
    names: str | Sequence[str], rows: Iterable[Any], ids: Callable[[Any], object] = str
) -> Callable[[Test], Test]:
    """Run a test's body on all rows, as `pytest.mark.parametrize` would, but as one test.

    `names` are the test's parameters that a row fills: one takes the row itself, several take its values.
    `ids` names a value, and a row by its values. Fixtures are shared by all rows.
    """
    fields = (names,) if isinstance(names, str) else tuple(names)
    table = [(row,) if isinstance(names, str) else tuple(row) for row in rows]
    if not table:
        raise ValueError("a table without rows tests nothing")

    def joined(test: Test) -> Test:
        @wraps(test)
        def on_all(**fixtures: Any) -> None:
            failed: list[tuple[str, BaseException]] = []
            for row in table:
                values = dict(zip(fields, row, strict=True))
                try:
                    test(**fixtures, **values)
                except (Exception, pytest.fail.Exception) as error:
                    name = "-".join(str(ids(value)) for value in row)
                    error.add_note(f"in the row {name}")
                    if _Run.stops_at_once:
                        raise
                    failed.append((name, error))
            _report(failed, len(table))

        known = signature(test)
        kept = [one for one in known.parameters.values() if one.name not in fields]
        on_all.__signature__ = known.replace(parameters=kept)  # type: ignore[attr-defined] # pytest reads it
        del on_all.__wrapped__  # or pytest would ask there for fixtures
        return on_all

    return joined


def _report(failed: Sequence[tuple[str, BaseException]], rows: int) -> None:
    """Raise what has failed: one as it is, several with all their names in the first line."""
    if len(failed) == 1:
        raise failed[0][1]
    if failed:
        reported = ", ".join(name for name, _ in failed)
        raise BaseExceptionGroup(
            f"{len(failed)} of {rows} rows: {reported}", [error for _, error in failed[:SHOWN]]
        )
