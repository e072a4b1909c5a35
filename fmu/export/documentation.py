"""documentation/ of an FMU: a page with variables, parameters, events and equations, and the license."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Final

import sympy as sp

from fmu.export.about import About
from fmu.export.blocks import ModelCode
from fmu.export.model import Expression, Model
from fmu.export.variables import Variable, variables

_STYLE: Final = "body{font-family:sans-serif;max-width:60em}td,th{text-align:left;padding-right:1em}"
_WRITTEN_OUT: Final = 5000
"""Terms of equations that are still read."""
_CAUSALITIES: Final[Mapping[str, str]] = {
    "input": "Inputs",
    "output": "Outputs",
    "parameter": "Parameters",
    "local": "Inside",
}


def documentation(program: ModelCode, about: About) -> dict[str, str]:
    """Return the files of documentation/ by their path in the FMU (FMI 2.0.5, 2.2; FMI 3.0.2, 2.5.1.2)."""
    files = {"documentation/index.html": "\n".join(_page(program, about)) + "\n"}
    if about.licence_text:
        files["documentation/licenses/license.txt"] = about.licence_text
    return files


def _page(program: ModelCode, about: About) -> Iterator[str]:
    model = program.model
    yield f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(model.name)}</title>'
    yield f"<style>{_STYLE}</style></head><body>"
    yield f"<h1>{escape(model.name)}</h1>\n<p>{escape(model.description)}</p>"
    made = [f"version {about.version}" if about.version else "", about.author, about.licence]
    yield f"<p>{escape(', '.join(filter(None, made)))}</p>"
    rows = variables(program)
    for causality, title in _CAUSALITIES.items():
        yield from _table(title, [row for row in rows if row.causality == causality])
    if about.page:
        yield f"<h2>Equations</h2>\n<pre>{escape(about.page)}</pre>"
    else:
        yield "<h2>Equations</h2>\n<pre>"
        yield from (escape(f"{name} = {sp.sstr(value)}") for name, value in _equations(model))
        yield "</pre>"
    yield "</body></html>"


def _equations(model: Model) -> list[tuple[str, Expression]]:
    """Return the equations as lines; parts that would fill pages, written out each time, have lines first."""
    rows = [(f"der({row.name})", sp.sympify(row.rate)) for row in model.states]
    rows += [(row.name, sp.sympify(row.expression)) for row in model.outputs]
    terms: dict[Expression, int] = {}
    if sum(_terms(value, terms) for _, value in rows) <= _WRITTEN_OUT:
        return rows
    shared, short = sp.cse([value for _, value in rows], sp.numbered_symbols("part"), order="none")
    lines = [(symbol.name, value) for symbol, value in shared]
    return lines + [(name, value) for (name, _), value in zip(rows, short, strict=True)]


def _terms(expression: Expression, found: dict[Expression, int]) -> int:
    """Return how many terms an expression has when it is written out."""
    if expression not in found:
        found[expression] = 1 + sum(_terms(part, found) for part in expression.args)
    return found[expression]


def _table(title: str, rows: Sequence[Variable]) -> Iterator[str]:
    yield f"<h2>{title}</h2>\n<table>"
    yield "<tr><th>name<th>unit<th>kind<th>start<th>least<th>most<th>what it is</tr>"
    for row in rows:
        numbers = ("" if value is None else f"{value:g}" for value in (row.start, row.least, row.most))
        cells = (row.name, row.unit, row.variability, *numbers, row.description)
        yield "<tr><td>" + "<td>".join(map(escape, cells)) + "</tr>"
    yield "</table>"
