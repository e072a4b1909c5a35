"""The report of a campaign as one page: failures, each with the line that drives it again, worst cases."""

import shlex
from collections.abc import Iterator, Sequence
from html import escape
from typing import Final

import numpy as np

from emulators.bench.web import document, table
from emulators.campaign.campaign_file import Require
from emulators.campaign.plan import Plan
from emulators.campaign.results import ERROR, Row
from emulators.campaign.sensitivity import sensitivities, varied_figures, varied_keys

SHOWN: Final = 20
WORST: Final = 5
BINS: Final = 24
WIDE, HIGH = 480, 90
STRONG: Final = 0.3
"""Below this a dependence is not listed: chance makes some, too."""
QUANTILES: Final = (0.0, 0.05, 0.5, 0.95, 1.0)


def rerun(plan: Plan, run: int, folder: str) -> str:
    """Return the line that drives one run again, with all of its results."""
    return shlex.join(("firmware-bridge", "campaign", plan.file, "--only", str(run), "--out", folder))


def page(plan: Plan, rows: Sequence[Row], folder: str, kept: Sequence[int] = ()) -> str:
    """Return the page; `kept` are the failing runs whose recordings are in `folder`."""
    title = plan.campaign.title or plan.file
    failed = [row for row in rows if row.broken]
    keys = varied_keys(rows)
    parts = (
        f"<h1>{escape(title)}</h1>",
        f"<p>{len(rows)} runs, {len(failed)} failed; of {escape(plan.file)}, {plan.sha256[:16]}</p>",
        "<h2>Requirements</h2>",
        _requirements(plan.campaign.require, rows),
        "<h2>Failures</h2>",
        _failures(plan, failed, keys, folder, kept),
        "<h2>Worst cases</h2>",
        *_worst(plan, rows, keys, folder),
        "<h2>Sensitivity</h2>",
        _sensitivity(rows),
        "<h2>Distributions</h2>",
        *_distributions(rows),
    )
    return document(title, "".join(parts))


def _requirements(require: Sequence[Require], rows: Sequence[Row]) -> str:
    lines = [(_stated(row), str(sum(place in it.broken for it in rows))) for place, row in enumerate(require)]
    errors = sum(ERROR in row.broken for row in rows)
    lines += [("no error", str(errors))]
    return table(("requirement", "broken in runs"), lines, (1,))


def _stated(row: Require) -> str:
    if row.never or row.always:
        return f"never '{row.never}'" if row.never else f"always '{row.always}'"
    bounds = (
        f"at least {row.least:g}" if row.least is not None else "",
        f"at most {row.most:g}" if row.most is not None else "",
    )
    return f"{row.key} {' and '.join(filter(None, bounds))}"


def _failures(
    plan: Plan, failed: Sequence[Row], keys: Sequence[str], folder: str, kept: Sequence[int]
) -> str:
    if not failed:
        return "<p>none</p>"
    lines = [
        (
            str(row.run),
            *(_text(row.key.get(key)) for key in keys),
            "; ".join(row.broken.values()),
            rerun(plan, row.run, folder),
            f"failures/{row.run:06d}/" if row.run in kept else "",
        )
        for row in failed[:SHOWN]
    ]
    more = f"<p>and {len(failed) - SHOWN} more, in results.csv</p>" if len(failed) > SHOWN else ""
    return table(("run", *keys, "what failed", "again", "recording and smaller mission"), lines, (0,)) + more


def _worst(plan: Plan, rows: Sequence[Row], keys: Sequence[str], folder: str) -> Iterator[str]:
    for row in plan.campaign.require:
        known = [(value, it) for it in rows if (value := it.number(row.key)) is not None]
        if not row.key or not known:
            continue
        # Nearest to the bound, or farthest beyond it.
        sign = -1.0 if row.most is not None else 1.0
        known.sort(key=lambda one: (sign * one[0], one[1].run))
        lines = [
            (
                str(it.run),
                *(_text(it.key.get(key)) for key in keys),
                _text(value),
                rerun(plan, it.run, folder),
            )
            for value, it in known[:WORST]
        ]
        yield f"<h3>{escape(_stated(row))}</h3>" + table(("run", *keys, row.key, "again"), lines, (0,))


def _sensitivity(rows: Sequence[Row]) -> str:
    found = [one for one in sensitivities(rows) if abs(one.strength) >= STRONG]
    if not found:
        return f"<p>no number depends on a parameter by {STRONG:g} or more</p>"
    lines = [
        (one.figure, one.parameter, f"{one.strength:+.2f}" if one.ranked else f"{one.strength:.2f}",
         "rank correlation (Spearman)" if one.ranked else "correlation ratio of its values (eta)")
        for one in found[:SHOWN]
    ]  # fmt: skip
    return table(("number", "depends on", "by", "as"), lines, (2,))


def _distributions(rows: Sequence[Row]) -> Iterator[str]:
    for name in varied_figures(rows):
        values = np.array([value for row in rows if (value := row.number(name)) is not None])
        if values.size < 2 or values.min() == values.max():  # noqa: PLR2004 - a spread needs two
            continue
        marks = [f"{value:.4g}" for value in np.quantile(values, QUANTILES)]
        heads = ("least", "5 %", "median", "95 %", "most")
        yield f"<figure><figcaption>{escape(name)}, {values.size} runs</figcaption>{_bars(values, name)}"
        yield table(heads, [marks], range(5)) + "</figure>"


def _bars(values: "np.ndarray[tuple[int], np.dtype[np.float64]]", name: str) -> str:
    counts, edges = np.histogram(values, BINS)
    width, most = WIDE / BINS, int(counts.max())
    bars = "".join(
        f'<rect x="{place * width:.1f}" y="{HIGH * (1 - count / most):.1f}" width="{width - 1:.1f}" '
        f'height="{HIGH * count / most:.1f}"><title>{edges[place]:.4g} to {edges[place + 1]:.4g}: {count}'
        "</title></rect>"
        for place, count in enumerate(counts)
        if count
    )
    least, greatest = f"{edges[0]:.4g}", f"{edges[-1]:.4g}"
    return (
        f'<svg role="img" aria-label="{escape(name)}: histogram" width="{WIDE}" height="{HIGH + 18}" '
        f'fill="#0072B2">{bars}<line x1="0" x2="{WIDE}" y1="{HIGH}" y2="{HIGH}" stroke="#222"/>'
        f'<g fill="#222" font-size="12"><text x="0" y="{HIGH + 14}">{least}</text>'
        f'<text x="{WIDE}" y="{HIGH + 14}" text-anchor="end">{greatest}</text></g></svg>'
    )


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
