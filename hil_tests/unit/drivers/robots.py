"""Robots for the drivers' tests: RARS by its file, with changes; no kind is needed."""

import copy
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ConfigDict

import firmware_bridge
from firmware_bridge.robot import AnyRobot, Axis, Table
from firmware_bridge.robot.file import robot_of, table_of

FILE: Final = Path(firmware_bridge.__file__).with_name("robots") / "rars" / "rars.toml"
TABLE: Final = table_of(FILE.read_text(encoding="utf-8"), FILE.name)
LINK: Final = "drives"


class Geometry(Table):
    """Geometry, which the drivers never look at."""

    model_config = ConfigDict(extra="allow")


def changed(change: Callable[[dict[str, Any]], None] = lambda _table: None) -> AnyRobot:
    """RARS with its table changed."""
    table = copy.deepcopy(TABLE)
    change(table)
    groups = {"all": frozenset(str(axis.get("role", axis["name"])) for axis in _axes(table))}
    return robot_of(table, "test.toml", Geometry, groups)


def with_link(robot: AnyRobot, changes: dict[str, object], link: str = LINK) -> AnyRobot:
    """The same robot with other settings of a link, checked."""
    table = robot.links[link]
    return robot.with_links({link: type(table).model_validate(table.model_dump() | changes)})


def with_axis(axis: Axis, **changes: object) -> Axis:
    """The same axis with other settings, checked."""
    return Axis.model_validate(axis.model_dump() | changes)


def _axes(table: Mapping[str, object]) -> list[dict[str, object]]:
    axes = table["axes"]
    assert isinstance(axes, list)
    return axes


RARS: Final = changed()
