"""`inject`: faults, inputs and restarts of emulated devices that run now, over their control port."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from emulators.control.keys import WordError, keys_of, value_of
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, WRONG_INPUT, one_message, refusal

if TYPE_CHECKING:
    from firmware_bridge.testing.control import Control

EXAMPLES: Final = """Examples:

`firmware-bridge inject shaft_blocked node=one --for 2s`

`firmware-bridge inject state` lists devices, faults that are on, and what can be set.

`firmware-bridge inject clear` ends all faults, `inject clear 3` the one with this number.

`firmware-bridge inject set left.input4=1 left.supply_v=18 lift_payload=20`

`firmware-bridge inject restart left` takes a drive's supply away for 0.2 s; a board is reset by its link.

`firmware-bridge inject shutdown --at rars-4711` ends that program in good order."""
UNITS: Final = {"ms": 0.001, "s": 1.0, "min": 60.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class InjectOptions:
    """Inject a fault into emulated devices that run now; or clear, state, set, restart, shutdown.

    Faults and their keys are those of a mission: `firmware-bridge faults` lists them. A fault begins with the
    next bus cycle and lasts for --for, until `clear`, or until the program ends.
    """

    words: Annotated[
        list[str],
        typer.Argument(
            metavar="FAULT|clear|state|set|restart|shutdown [KEY=VALUE ...]",
            help="A fault with its keys, or a request with its words.",
        ),
    ]
    for_: Annotated[
        str | None,
        typer.Option("--for", metavar="TIME", help="Time until the fault ends, as 2s or 300ms."),
    ] = None
    at: Annotated[
        str,
        typer.Option(
            metavar="NAME|HOST:PORT",
            help="Program, by the begin of its name, or by the address that --control tcp has printed.",
            show_default="the only one that runs",
        ),
    ] = ""
    token: Annotated[
        str, typer.Option(envvar="FIRMWARE_BRIDGE_TOKEN", help="Token that --control tcp has printed.")
    ] = ""
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")] = False


def run(given: InjectOptions) -> None:
    """Run the command `inject`."""
    from firmware_bridge.testing.control import ControlError, control

    word, *rest = given.words
    work = REQUESTS.get(word)
    if given.for_ is not None and work is not None:
        raise refusal(f"--for {given.for_}: only a fault has an end")
    seconds = None if given.for_ is None else _seconds(given.for_)
    with one_message(ControlError, status=FAILED), control(given.at, given.token) as port:
        if work is None:
            keys = _keys(rest)
            keys |= {} if seconds is None else {"for_s": seconds}
            answer = port.request("inject", fault=word, keys=keys)
        else:
            answer = work(port, rest)
    text = json.dumps(answer) if given.as_json else _text(word, answer)
    typer.echo(text)


def _clear(port: "Control", words: Sequence[str]) -> dict[str, Any]:
    if not words:
        return port.request("clear")
    if len(words) > 1 or not words[0].isdecimal():
        raise refusal(f"clear {' '.join(words)}: give one number of `inject state`, or none for all")
    return port.request("clear", number=int(words[0]))


def _state(port: "Control", words: Sequence[str]) -> dict[str, Any]:
    _no_more("state", words)
    return port.request("state")


def _set(port: "Control", words: Sequence[str]) -> dict[str, Any]:
    values = _keys(words)
    wrong = [name for name, value in values.items() if isinstance(value, bool | str | list)]
    if wrong or not values:
        raise refusal(f"set {' '.join(words)}: give NAME=NUMBER, as left.input4=1; `inject state` has names")
    return port.request("set", values=values)


def _restart(port: "Control", words: Sequence[str]) -> dict[str, Any]:
    if len(words) != 1:
        raise refusal("restart: give one drive, by name or number, or a board's link")
    return port.request("restart", node=value_of(words[0]))


def _shutdown(port: "Control", words: Sequence[str]) -> dict[str, Any]:
    _no_more("shutdown", words)
    return port.request("shutdown")


REQUESTS: Final = {
    "clear": _clear,
    "state": _state,
    "set": _set,
    "restart": _restart,
    "shutdown": _shutdown,
}


def _no_more(word: str, words: Sequence[str]) -> None:
    if words:
        raise refusal(f"{word} takes no further words, but got '{' '.join(words)}'")


def _keys(words: Sequence[str]) -> dict[str, Any]:
    """Return keys and values; a word that is none ends the program with a message."""
    with one_message(WordError, status=WRONG_INPUT):
        return keys_of(words)


def _seconds(text: str) -> float:
    number = text.rstrip("abcdefghijklmnopqrstuvwxyz")
    unit = text[len(number) :] or "s"
    try:
        seconds = float(number) * UNITS[unit]
    except (ValueError, KeyError):
        raise refusal(f"--for {text}: give a time, as 2s or 300ms") from None
    if not 0.0 < seconds < float("inf"):
        raise refusal(f"--for {text}: give a time above 0")
    return seconds


def _text(word: str, answer: Mapping[str, Any]) -> str:
    """Return an answer in lines."""
    if word == "state":
        return "\n".join(_state_lines(answer))
    parts = [f"{word}: at {answer['at_s']:.6f} s"]
    if "number" in answer:
        parts.append(f"number {answer['number']}")
    if "cleared" in answer:
        parts.append(f"cleared: {', '.join(map(str, answer['cleared'])) or 'none was on'}")
    return "; ".join(parts)


def _state_lines(answer: Mapping[str, Any]) -> Iterator[str]:
    yield f"{answer['emulates']} at {answer['at_s']:.3f} s: {', '.join(answer['devices'])}"
    if off := [name for name, here in answer["devices"].items() if not here]:
        yield f"without supply: {', '.join(off)}"
    for one in answer["faults"]:
        where = ", ".join(one["nodes"]) or "all"
        yield f"fault {one['number']}: {one['fault']} on {where} since {one['began_s']:g} s"
    if not answer["faults"]:
        yield "no fault is on"
    yield f"can be set: {', '.join(answer['settable']) or 'nothing'}"


inject: Final = command(EXAMPLES, work=run)(InjectOptions)
