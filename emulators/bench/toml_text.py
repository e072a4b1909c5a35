"""Tables as TOML text, which `tomllib` reads back as they were: missions and robots that a program makes."""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

_BARE: Final = re.compile(r"[A-Za-z0-9_-]+")


def as_toml(table: Mapping[str, Any]) -> str:
    """Return the text of a table; TypeError for what TOML has no word for."""
    return "\n".join(_lines(table, "")) + "\n"


def _lines(table: Mapping[str, Any], name: str) -> Iterator[str]:
    rows = {key: value for key, value in table.items() if _is_rows(value)}
    within = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    yield from (f"{_key(key)} = {_value(value)}" for key, value in table.items() if key not in rows | within)
    for key, value in within.items():
        path = f"{name}{_key(key)}"
        yield from ("", f"[{path}]", *_lines(value, f"{path}."))
    for key, value in rows.items():
        for row in value:
            # Tables of a row stand in its line: headings would have to follow the row's own order.
            yield from ("", f"[[{name}{_key(key)}]]")
            yield from (f"{_key(own)} = {_value(it)}" for own, it in row.items())


def _is_rows(value: object) -> bool:
    return (
        isinstance(value, Sequence)
        and not isinstance(value, str)
        and bool(value)
        and all(isinstance(row, Mapping) for row in value)
    )


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_value(it)}" for key, it in value.items()) + "}"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(_value, value)) + "]"
    return _number(value)


def _number(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else f"{value}"
    raise TypeError(f"TOML has no word for {value!r}")


def _text(text: str) -> str:
    # JSON's escapes are TOML's; JSON leaves DEL as it is, which TOML refuses.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")
