"""A run's margin, of a robot whose station has one: a column of its samples, and a panel of its picture."""

import math
from functools import partial
from typing import Any

from emulators.bench.columns import Column, Curve, Panel
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import Margin

AnyMargin = Margin[Any, Any, Any]


def margin_of(robot: AnyRobot) -> AnyMargin | None:
    """Return a robot's row; None where its file has no data for it."""
    return robot_type_of(robot).station.margin_of(robot)


def columns(robot: AnyRobot) -> tuple[Column, ...]:
    """Return the margin's column; none of a robot without."""
    row = margin_of(robot)
    return () if row is None else (Column(_name(row), row.title, row.unit, seen=_Reader(row, robot)),)


def panels(robot: AnyRobot) -> tuple[Panel, ...]:
    """Return the margin's panel, with the least that is kept; none of a robot without."""
    row = margin_of(robot)
    if row is None:
        return ()
    curve = Curve(_name(row), row.title)
    least = partial(_least, row)
    return (Panel("Margin", f"margin [{row.unit}]", (curve,), limit=least, shaded=True, height=2.0),)


def _name(row: AnyMargin) -> str:
    return f"margin_{row.unit}"


class _Reader:
    """The margin of a snapshot: samples come more often than the bridge looks, and none changes."""

    __slots__ = ("_robot", "_row", "_seen", "_value")

    def __init__(self, row: AnyMargin, robot: AnyRobot) -> None:
        self._row, self._robot = row, robot
        self._seen: Snapshot[Any, Any] | None = None
        self._value = math.nan

    def __call__(self, seen: Snapshot[Any, Any]) -> float:
        if seen is not self._seen:
            value = self._row.read(self._robot, seen)
            self._seen, self._value = seen, math.nan if value is None else value
        return self._value


def _least(row: AnyMargin, robot: AnyRobot) -> tuple[float, str]:
    return row.least(robot) or 0.0, row.unit
