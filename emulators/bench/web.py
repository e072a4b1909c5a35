"""Pages of HTML that need no other file: one look, tables, and pictures within."""

import base64
from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

LOOK: Final = """
body { font: 15px/1.5 sans-serif; color: #222; max-width: 64em; margin: 2em auto; padding: 0 1em }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px }
th, td { border-bottom: 1px solid #ddd; padding: .25em .7em; text-align: left; vertical-align: top }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }
pre, code { background: #f6f6f6; font-size: 13px } pre { padding: .7em; overflow-x: auto }
div.wide { overflow-x: auto } img { max-width: 100% } figure { margin: 1.5em 0 }
figcaption, .pale { color: #666; font-size: 13px } .wrong { color: #a00; font-weight: bold }
"""


def document(title: str, body: str, look: str = "") -> str:
    """Return a whole page; `look` are rules of its own, in CSS."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{escape(title)}</title><style>{LOOK}{look}</style></head><body>{body}</body></html>\n"
    )


def picture(drawn: bytes, kind: str, states: str) -> str:
    """Return a picture within the page; `kind` as in its media type: png, svg+xml."""
    text = base64.b64encode(drawn).decode("ascii")
    return f'<img alt="{escape(states)}" src="data:image/{kind};base64,{text}">'


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], numbers: Iterable[int] = ()) -> str:
    """Return a table of texts; `numbers` are the places of columns that stand to the right."""
    right = frozenset(numbers)
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(
        f"<tr>{''.join(_cell(text, at in right) for at, text in enumerate(row))}</tr>" for row in rows
    )
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _cell(text: str, number: bool) -> str:  # noqa: FBT001 - a cell of a table, used here alone
    return f'<td class="number">{escape(text)}</td>' if number else f"<td>{escape(text)}</td>"
