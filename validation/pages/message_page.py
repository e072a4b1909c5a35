"""The page of messages: interlocks, refused orders, errors that end a command."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Final

from validation.pages.messages import ERRORS, answers, errors, interlocks, modules

INTRODUCTION: Final = """\
What is computed stands as `...`. Many messages end with their own remedy, behind a semicolon."""
INTERLOCK_TEXT: Final = """\
An active interlock is reported with its message and its remedy (STATUSTEXT, `events.log`, `summary.json`);
[safety](safety.md) has thresholds and effects. A dash: the cause gives the message."""
ORDER_TEXT: Final = """\
A refused order is answered with COMMAND_ACK and a STATUSTEXT; nothing has changed then. Correct the order, or
do first what the message names. What each request needs: [requests](requests.md)."""
ERROR_TEXT: Final = """\
These end a command with exit status 2, or 1 where the command's help names it. Options and arguments are
checked before, and named with their value. Errors of a robot file or a mission come all at once, each with
file and key."""


def parts(table: Callable[[Sequence[str], Iterable[Sequence[str]]], str]) -> Iterator[str]:
    """Yield the page's parts; `table` writes one."""
    every = list(modules())
    yield INTRODUCTION
    yield "## Interlocks and limits"
    yield INTERLOCK_TEXT
    found = dict.fromkeys(chain.from_iterable(map(interlocks, every)))
    yield table(("interlock", "message", "remedy"), ((_code(it.text), it.cause, it.remedy) for it in found))
    yield "## Refused orders"
    yield ORDER_TEXT
    refused = dict.fromkeys(chain.from_iterable(map(answers, every)))
    yield table(("order", "message"), ((order, _code(text)) for order, text in refused))
    yield "## Errors that end a command"
    yield ERROR_TEXT
    texts: dict[str, dict[str, None]] = {}
    for name, text in chain.from_iterable(map(errors, every)):
        texts.setdefault(name, {})[text] = None
    for name in sorted(texts, key=lambda name: ERRORS[name]):
        cause, remedy = ERRORS[name]
        yield f"### {cause[0].upper()}{cause[1:]}"
        yield f"Remedy: {remedy}.\n\n" + "\n".join(f"* {_code(text)}" for text in texts[name])


def _code(text: str) -> str:
    return f"`{text.replace('`', chr(39))}`"
