"""ROME's rows on MAVLink: the base by stick and by velocity, the tool up and down while button 3 is held."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2 import station as arms
from firmware_bridge.robots.ar2.motion import Ar2Motion as ArmMotion
from firmware_bridge.robots.rome import station as bases
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE, Half, Seen
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import (
    USUAL_AXES,
    Fixed,
    Gauge,
    Margin,
    StationRows,
    Stick,
    StickAxis,
    Twist,
    Value,
    Velocity,
)
from firmware_bridge.units import SECOND


def of_stick(stick: Stick, command: RomeArmMotion, robot: Robot[RomeArmGeometry]) -> RomeArmMotion:
    """Return the command for a stick: it drives the base, and the tool up and down."""
    base = bases.of_stick(stick, command.base, BASE.robot(robot))
    # The stick's other axes are the base's: one axis must not move both halves.
    upwards = Stick(forward=None, left=None, turn=None, up=stick.up)
    arm = arms.of_stick(upwards, command.arm, ARM.robot(robot))
    return RomeArmMotion(base, arm)


def of_target(velocity: Velocity, command: RomeArmMotion, robot: Robot[RomeArmGeometry]) -> RomeArmMotion:
    """Return the command for a velocity and a turn rate of the base; the tool stays."""
    return RomeArmMotion(bases.of_target(velocity, command.base, BASE.robot(robot)), ArmMotion())


def _largest(robot: Robot[RomeArmGeometry]) -> Twist:
    return bases.STATION.largest(BASE.robot(robot))


def _values(half: Half, rows: Iterable[Value[Any, Any]]) -> Iterator[Value[RomeArmMotion, RomeArmState]]:
    def of(read: Callable[[Snapshot[Any, Any]], float | None]) -> Callable[[Seen], float | None]:
        return lambda seen: read(half.seen(seen))

    for row in rows:
        yield replace(row, read=of(row.read))


def _parameters(half: Half, rows: Iterable[Fixed[Any]], before: str = "") -> Iterator[Fixed[RomeArmGeometry]]:
    def of(value: Callable[[Robot[Any]], float]) -> Callable[[Robot[RomeArmGeometry]], float]:
        return lambda robot: value(half.robot(robot))

    for row in rows:
        yield replace(row, name=before + row.name, value=of(row.value))


def _gauge(row: Gauge[Any]) -> Gauge[RomeArmGeometry]:
    return replace(
        row,
        reading=lambda position, robot: row.reading(position, ARM.robot(robot)),
        position=lambda value, robot: row.position(value, ARM.robot(robot)),
    )


def _margin_mm(robot: Robot[RomeArmGeometry], seen: Snapshot[RomeArmMotion, RomeArmState]) -> float | None:
    if any(axis.reference_lost for axis in seen.facts.axes.values()):
        return None
    return 1000.0 * balance(robot.geometry, seen.body.arm.angles).room_m


def _least_mm(robot: Robot[RomeArmGeometry]) -> float:
    return 1000.0 * robot.geometry.balance.margin_m


_TOOL: Final = tuple(row for row in arms.STATION.values if row.name.startswith("TOOL"))
"""The tool's rows without the arm's clock, which is the base's: it is sent once."""

STATION: Final[StationRows[RomeArmGeometry, RomeArmMotion, RomeArmState]] = StationRows(
    stick=of_stick,
    target=of_target,
    twist=lambda state: bases.STATION.twist(state.base),
    forgotten=lambda command: command,
    largest=_largest,
    meters_rolled=lambda robot: robot.geometry.base.base.wheel_radius_m,
    stop_button=2,
    up_button=3,
    axes=(*USUAL_AXES, StickAxis.UP),
    values=(
        *_values(BASE, bases.STATION.values),
        *_values(ARM, _TOOL),
        Value(
            "PATH_RATE",
            SECOND,
            lambda seen: seen.command.path_rate,
            "of the path that is followed, 1 as it is planned",
        ),
    ),
    margin=Margin(_margin_mm, _least_mm, "mm", "center of gravity inside the wheels"),
    parameters=(
        *_parameters(BASE, bases.STATION.parameters),
        *_parameters(ARM, arms.STATION.parameters, "TOOL_"),
        Fixed("ROOM_MIN", lambda robot: robot.geometry.balance.margin_m, "m"),
    ),
    gauges=tuple(_gauge(row) for row in arms.STATION.gauges),
)
