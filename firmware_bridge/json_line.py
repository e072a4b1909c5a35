"""Reading of JSON from outside: whatever comes is an object of plain values, or one error."""

import json
import math
from typing import Any, NoReturn


class JsonLineError(ValueError):
    """A text that is no JSON object: why."""


def read_object(line: bytes) -> dict[str, Any]:
    """Return the object in a text; JsonLineError, also for numbers that JSON has not, as 1e999 and NaN."""
    try:
        found = json.loads(line, parse_float=_finite, parse_constant=_refused)
    # Beside what is no JSON: numbers of too many digits, and lists in lists without end.
    except (ValueError, RecursionError) as error:
        raise JsonLineError(f"not a line of JSON: {error}") from error
    if not isinstance(found, dict):
        raise JsonLineError("not an object in braces")
    return found


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text:.20} is too large a number")
    return number


def _refused(text: str) -> NoReturn:
    raise ValueError(f"give a number, not {text.lower()}")
