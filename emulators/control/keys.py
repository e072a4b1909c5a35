"""Keys of a fault in words, as at a command line: KEY=VALUE."""

from collections.abc import Iterable
from typing import Any, Final

_WORDS: Final = {"true": True, "false": False}


class WordError(ValueError):
    """A word that cannot be read, or a fault that is not possible: why, and what can be written."""


def value_of(text: str) -> Any:
    """Return a value of a key: a number, true, false, or the word itself."""
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return _WORDS.get(text, text)


def keys_of(words: Iterable[str]) -> dict[str, Any]:
    """Return the keys of KEY=VALUE, or KEY=VALUE,VALUE for a list; WordError."""
    found: dict[str, Any] = {}
    for word in words:
        key, sign, value = word.partition("=")
        if not sign or not key:
            raise WordError(f"{word}: give KEY=VALUE, as node=left")
        found[key] = [value_of(one) for one in value.split(",")] if "," in value else value_of(value)
    return found
