"""Faults in words, as at a command line: KIND with its keys, and its times."""

from collections.abc import Iterable
from typing import Any

from pydantic import ValidationError

from emulators.bench.faults import Fault, FaultError, kinds, read
from emulators.control.keys import WordError, keys_of
from emulators.control.live import Live
from firmware_bridge.robot.problems import problems_of
from firmware_bridge.units import to_seconds


def planned(text: str) -> dict[str, Any]:
    """Read KIND[,KEY=VALUE ...][@FROM[-TO]], times in s from the begin, as a mission's table; WordError."""
    written, sign, times = text.partition("@")
    kind, *parts = written.split(",")
    words: list[str] = []
    for part in parts:
        # A list's further values have no key of their own.
        if "=" in part or not words:
            words.append(part)
        else:
            words[-1] += f",{part}"
    return {"kind": kind, **keys_of(words), **(_times(kind, times) if sign else {"at_s": 0.0})}


def _times(kind: str, times: str) -> dict[str, float]:
    begin, sign, end = times.partition("-")
    try:
        return {"at_s": float(begin), **({"until_s": float(end)} if sign else {})}
    except ValueError:
        raise WordError(f"'{times}' is no time; write {kind}@5, or {kind}@5-7.5, in s") from None


def fault_of(live: Live, table: dict[str, Any]) -> Fault:
    """Return a fault that these devices can have; WordError."""
    kind, robot = table["kind"], live.robot
    try:
        fault = read(table, robot)
    except ValidationError as error:
        if kind not in kinds():
            raise WordError(str(error.errors()[0]["msg"])) from error
        raise WordError(f"{kind}: {_stated(problems_of(error, kinds()[kind].fault))}") from error
    if problem := live.out_of_reach(fault):
        raise WordError(f"{kind}: not on a real bus or line: {problem}")
    return fault


def _stated(problems: Iterable[tuple[str, str]]) -> str:
    return "; ".join(f"{key}: {what}" if key else what for key, what in problems)


def plan(live: Live, faults: Iterable[Fault]) -> int:
    """Plan faults, and return the number of the first; WordError for what the devices cannot have."""
    given = tuple(faults)
    try:
        return live.faults.plan(given)
    except FaultError as error:
        named = [(key.partition(".")[2], what) for key, what in error.problems]
        raise WordError(f"{given[0].kind}: {_stated(named)}") from error


def beginning(live: Live, fault: Fault) -> str:
    """Return the text of a fault's begin, for people and a recording."""
    where = ", ".join(sorted(fault.targets(live.robot))) or live.robot.name
    return f"fault {fault.kind} begins at {to_seconds(fault.begin):.6f} s: {where}"
