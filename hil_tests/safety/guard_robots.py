"""Robots that a test writes down in a line: axes with links and limits, and the guard's rules over them."""

import math
from dataclasses import dataclass
from typing import Any, Final

from firmware_bridge.robot import AnyRobot, Table
from firmware_bridge.robot.file import robot_of
from firmware_bridge.robot_types import find

RARS: Final[AnyRobot] = find("rars")


class Nothing(Table):
    """The geometry of a robot that has none."""


@dataclass(frozen=True)
class AnAxis:
    """Differences from RARS's left wheel: ratio 26, 500 lines."""

    name: str
    node: int
    link: str = "base"
    top_speed: float = 16.0
    ratio: float = 26.0
    direction: int = 1
    travel: tuple[float, float] | None = None
    """With one it is commanded by position."""
    encoder_lines: int = 500


def robot_with(
    axes: tuple[AnAxis, ...],
    *,
    sums: dict[str, tuple[dict[str, float], float]] | None = None,
    exclusive: tuple[tuple[str, ...], tuple[str, ...]] | None = None,
    every: dict[str, int] | None = None,
    outputs: tuple[tuple[str, int], ...] = (),
) -> AnyRobot:
    """Make a robot; `sums` by name: factors and bound; `every` by link; `outputs`: axis and pin."""
    table = RARS.model_dump()
    link, settings = table["links"]["drives"], table["axes"][0]["settings"]
    links = {axis.link: link | {"every": (every or {}).get(axis.link, 1)} for axis in axes}
    rules: dict[str, Any] = {
        "sums": [{"name": name, "of": of, "bound": bound} for name, (of, bound) in (sums or {}).items()],
        "exclusive": [] if exclusive is None else [_sides(*exclusive)],
    }
    made = table | {
        "links": links,
        "geometry": {},
        "battery": None,
        "sensors": [],
        "guard": rules,
        "axes": [_axis(axis, settings) for axis in axes],
        "outputs": [
            {
                "name": f"output_{number}",
                "title": f"output {number}",
                "link": next(one.link for one in axes if one.name == axis),
                "settings": {"axis": axis, "output": number},
            }
            for axis, number in outputs
        ],
    }
    return robot_of(made, "a test", Nothing, {"all": frozenset(axis.name for axis in axes)})


def _sides(one: tuple[str, ...], other: tuple[str, ...]) -> dict[str, Any]:
    return {"name": "one", "one": list(one), "other": list(other)}


def _axis(axis: AnAxis, settings: dict[str, Any]) -> dict[str, Any]:
    profile = settings["profile"]
    if axis.travel is not None:
        # A file in which it runs faster than the axis may is refused.
        top_rpm = math.floor(axis.top_speed * axis.ratio * 60.0 / math.tau)
        profile = profile | {"velocity_rpm": min(top_rpm, profile["velocity_rpm"])}
    return {
        "name": axis.name,
        "title": axis.name,
        "link": axis.link,
        "command": "speed" if axis.travel is None else "position",
        "travel": axis.travel,
        "top_speed": axis.top_speed,
        "ratio": axis.ratio,
        "direction": axis.direction,
        "settings": settings | {"node": axis.node, "encoder_lines": axis.encoder_lines, "profile": profile},
    }
