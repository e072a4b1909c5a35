"""Introduction of a bench to the live page: its robot, the faults that it can have, what may be requested."""

import typing
from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from types import NoneType
from typing import Any, Final

from pydantic.fields import FieldInfo

from emulators.bench.faults import Fault, kinds
from emulators.bench.faults.failures import failures_of
from emulators.bench.faults.kind import FaultKind
from firmware_bridge.live.messages import VERSION
from firmware_bridge.live.state import Json, axes_of, outline_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of

LEFT_OUT: Final = frozenset({"at_s", "title", "until_s"})
"""Keys of a fault that the page has no use for: it begins now, and has a duration."""
_NUMBERS: Final = frozenset({int, float})


def hello(title: str, robot: AnyRobot, requests: Sequence[str], missions: Sequence[str]) -> Json:
    """Return the page's first message, with the missions that it can start."""
    rows = robot_type_of(robot).station
    return {
        "kind": "hello",
        "version": VERSION,
        "title": title,
        "mode": "bench",
        "axes": axes_of(robot),
        "outline": outline_of(robot),
        "faults": list(faults(robot)),
        "can": list(requests),
        "missions": list(missions),
        "wheel": rows.helm,
        "up": rows.up_button is not None,
        "buttons": [
            {"title": one.name, "bit": one.button} for one in rows.switches if one.button is not None
        ],
    }


def faults(robot: AnyRobot, out_of_reach: Callable[[Fault], str] = lambda _: "") -> Iterator[Json]:
    """Yield every kind of fault that a robot can have, with its keys, but for what is out of reach."""
    tried: dict[str, dict[str, Any]] = {}
    for failure in failures_of(robot):
        fault = kinds()[failure.kind].fault.model_validate({"at_s": 0.0, **failure.keys})
        if not out_of_reach(fault):
            tried.setdefault(failure.kind, dict(failure.keys))
    for kind in kinds().values():
        if kind.name in tried:
            yield {
                "kind": kind.name,
                "title": kind.happens.partition(". ")[0].rstrip("."),
                "keys": list(_keys(kind, robot, tried[kind.name])),
            }


def _keys(kind: FaultKind, robot: AnyRobot, tried: dict[str, Any]) -> Iterator[Json]:
    for name, field in kind.fault.model_fields.items():
        if name in LEFT_OUT:
            continue
        choices = _choices(name, field, kind, robot)
        yield {
            "name": name,
            "meaning": field.description or "",
            "type": "choice" if choices else "number" if _is_number(field.annotation) else "text",
            "choices": choices,
            "default": tried.get(name, None if field.is_required() else _plain(field.default)),
            "required": field.is_required(),
        }


def _choices(name: str, field: FieldInfo, kind: FaultKind, robot: AnyRobot) -> list[str]:
    if name == "node":
        return kind.fault.among.of(robot)
    if name == "link":
        return list(robot.links)
    every = (*typing.get_args(field.annotation), field.annotation)
    found = next((one for one in every if isinstance(one, type) and issubclass(one, Enum)), None)
    return [] if found is None else [str(one.value) for one in found]


def _is_number(annotation: Any) -> bool:
    parts = [part for part in typing.get_args(annotation) or (annotation,) if part is not NoneType]
    plain = [typing.get_args(part)[0] if typing.get_args(part) else part for part in parts]
    return bool(_NUMBERS.intersection(one for one in plain if isinstance(one, type)))


def _plain(value: Any) -> Any:
    return value if isinstance(value, str | int | float | bool) else None
