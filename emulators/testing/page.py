"""A session of tests as one page of HTML that needs no other file: what failed, and what is known of it."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Final

from emulators.bench.web import document, picture

PICTURED: Final = 20
"""Number of failures with pictures; those of the others are in their folders. Each takes about 300 kB."""
LOOK: Final = ".failed, .error { color: #a00; font-weight: bold } .skipped { color: #666 }"


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """One test as it ended."""

    name: str
    outcome: str
    """passed, failed, error, skipped."""
    seconds: float
    of: str
    """Robot and seed, where it has them."""
    error: str = ""
    """The traceback; the reason, where it was skipped."""
    sections: tuple[tuple[str, str], ...] = ()
    """Reports on the robot and on programs, and the printed text: heading and text."""
    kept: str = ""
    """The folder of its recording, where there is one."""
    again: str = ""
    """The line that runs it again."""


def page(title: str, ended: Iterable[CaseOutcome]) -> str:
    """Return the page: the failures, each whole, and all tests in a table."""
    outcomes = tuple(ended)
    failed = [one for one in outcomes if one.outcome in {"failed", "error"}]
    counted = Counter(one.outcome for one in outcomes)
    summary = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counted.items())) or "no tests"
    body = "".join(part for place, one in enumerate(failed) for part in _failure(place, one))
    head, all_of_them = f"<h1>{escape(title)}</h1><p>{summary}</p>", f"<h2>All tests</h2>{_table(outcomes)}"
    return document(title, f"{head}{_contents(failed)}{body}{all_of_them}", LOOK)


def _contents(failed: Sequence[CaseOutcome]) -> str:
    rows = "".join(
        f'<li><a href="#failure{place}">{escape(one.name)}</a></li>' for place, one in enumerate(failed)
    )
    return f"<ol>{rows}</ol>"


def _failure(place: int, one: CaseOutcome) -> Iterator[str]:
    yield f'<h2 id="failure{place}">{escape(one.name)} <span class="{one.outcome}">{one.outcome}</span></h2>'
    yield f"<p>{escape(one.of)}</p><p>again: <code>{escape(one.again)}</code></p>"
    yield f"<pre>{escape(one.error)}</pre>"
    for heading, text in one.sections:
        yield f"<h3>{escape(heading)}</h3><pre>{escape(text)}</pre>"
    pictures = sorted(Path(one.kept).glob("*.png")) if one.kept else []
    if place < PICTURED:
        yield from map(_picture, pictures)
    elif pictures:
        yield f"<p>{len(pictures)} pictures are in {escape(one.kept)}</p>"


def _picture(path: Path) -> str:
    return f"<p>{picture(path.read_bytes(), 'png', path.stem)}</p>"


def _table(outcomes: Sequence[CaseOutcome]) -> str:
    heads = "".join(f"<th>{head}</th>" for head in ("", "test", "of", "took", "why"))
    return f"<table><tr>{heads}</tr>{''.join(map(_row, outcomes))}</table>"


def _row(one: CaseOutcome) -> str:
    why = one.error if one.outcome == "skipped" else ""
    return (
        f'<tr><td class="{one.outcome}">{one.outcome}</td><td>{escape(one.name)}</td>'
        f'<td>{escape(one.of)}</td><td class="number">{one.seconds:.2f} s</td><td>{escape(why)}</td></tr>'
    )
