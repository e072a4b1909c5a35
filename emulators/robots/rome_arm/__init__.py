"""ROME whole on the bench: its base's and its arm's bench setups, and where base and tool together shall be.

Signs, scales and paths are written again, not taken from the bridge, so that a mistake there is not repeated:
an orbit goes by Kepler's equation here, and by F and G there.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Final, TypeAlias

import numpy as np

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes
from emulators.bench.columns import Column, Curve, Floats, Panel, Samples
from emulators.bench.kepler import flight
from emulators.bench.path_error import HEIGHT
from emulators.bench.path_error import Path as FollowedPath
from emulators.bench.step import Finite, Holds
from emulators.robots import ar2, rome
from emulators.robots.ar2 import LIFTS
from emulators.robots.rome import RomeStep
from emulators.robots.rome_arm.cases import cases
from firmware_bridge.robot import AnyRobot, Robot
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE, Half

RomeArm: TypeAlias = Robot[RomeArmGeometry]
WHEELS: Final = ("one", "two", "three")
OF_THE_ARM: Final = ("angle_", "lag_")
"""Prefixes of the arm's columns: of its tool the plant has the place in the room."""
USED: Final = 0.9
"""Share of the base's speed and acceleration that a path may ask for."""
INSTANTS: Final = 4000
SHAKEN: Final = 10
"""Samples over which what a wheel carries is the mean: 100 ms."""


class RomeArmStep(RomeStep):
    """The ROME operator's input at one instant."""

    up_mps: Annotated[Finite | None, Holds("up")] = None
    """Upward speed of the tool; by stick only."""


def _stick(values: Mapping[str, float], robot: RomeArm) -> StickAxes:
    base = rome.BENCH_SETUP.stick(values, BASE.robot(robot))
    up = values["up"] / robot.geometry.arm.limits.speed_mps
    return replace(base, z=up, buttons=LIFTS if up else 0)


def _columns(half: Half, rows: tuple[Column, ...]) -> Iterator[Column]:
    """Yield a half's columns; what it reads of the bridge it reads of its half."""

    def of(read: Callable[..., float]) -> Callable[..., float]:
        return lambda seen: read(half.seen(seen))

    for row in rows:
        yield row if row.seen is None else replace(row, seen=of(row.seen))


def _panels(half: Half, rows: tuple[Panel, ...]) -> Iterator[Panel]:
    def of(limit: Callable[..., tuple[float, str]]) -> Callable[[AnyRobot], tuple[float, str]]:
        return lambda robot: limit(half.robot(robot))

    for row in rows:
        yield row if row.limit is None else replace(row, limit=of(row.limit))


def _full(half: Half, name: str) -> Channel:
    """Return a channel of one half."""
    rows: tuple[Channel, ...] = (ar2 if half is ARM else rome).BENCH_SETUP.channels
    row = next(row for row in rows if row.name == name)
    return replace(row, full=lambda robot: row.full(half.robot(robot)))


def _orbit(robot: RomeArm) -> FollowedPath:
    """Return the orbit on the floor, by its shape and Kepler's equation; mu is 1."""
    table = robot.geometry.orbit
    flown, period = flight(table.begin.place, table.begin.speed)
    sizes = np.array((table.m_per_du, table.m_per_du, table.height_per_du))[:, None]
    times = np.linspace(0.0, period, INSTANTS)
    # A robot that is too slow for the orbit's own time flies it more slowly, and in the same shape.
    seconds_per_tu = max(table.s_per_tu, _stretch(robot, sizes * flown(times), times[1]))

    def path(seconds: Floats) -> tuple[Floats, Floats, Floats]:
        x, y, z = sizes * flown(np.maximum(seconds, 0.0) / seconds_per_tu)
        off = np.where(seconds > 0.0, 0.0, 1.0)
        return x + off * table.sideways_m[0], y + off * table.sideways_m[1], z

    return path


def _stretch(robot: RomeArm, places: Floats, apart: float) -> float:
    """Return how many times its time a way takes at least, from places on the floor and above it."""
    limits, tool = robot.geometry.base.limits, robot.geometry.arm.limits
    speeds = np.gradient(places, apart, axis=1)
    # Without the ends: there `gradient` has one-sided differences, which are less exact.
    bends = np.gradient(speeds[:2], apart, axis=1)[:, 2:-2]
    fastest, hardest = (float(np.linalg.norm(it, axis=0).max()) for it in (speeds[:2, 1:-1], bends))
    rises = float(np.abs(speeds[2, 1:-1]).max())
    return max(
        *(fastest / (USED * limits.speed_mps), math.sqrt(hardest / (USED * limits.acceleration_mps2))),
        rises / (USED * tool.speed_mps),
    )


def _formation(robot: RomeArm) -> FollowedPath:
    """Return the ellipse (a cos nt, -2 a sin nt, h sin nt)."""
    table = robot.geometry.formation

    def flown(times: Floats) -> tuple[Floats, Floats, Floats]:
        angle = math.tau * times / table.turn_s
        along = -2.0 * table.half_width_m * np.sin(angle)
        return table.half_width_m * np.cos(angle), along, table.height_m * np.sin(angle)

    times = np.linspace(0.0, table.turn_s, INSTANTS)
    stretch = max(1.0, _stretch(robot, np.array(flown(times)), times[1]))
    return lambda seconds: flown(seconds / stretch)


def _pose(robot: RomeArm) -> FollowedPath:
    x, y = robot.geometry.pose.by_m
    up = robot.geometry.arm.courses.pose.by_m[2]
    there = np.vectorize(lambda seconds: 1.0 if seconds > 0.0 else 0.0)
    return lambda seconds: (x * there(seconds), y * there(seconds), up * there(seconds))


def _least_load(samples: Samples) -> float | None:
    """Return what the wheel that carried least carried, as a share of a third of all, over 100 ms.

    Each step of a joint shakes the rigid plant for an instant; what tips the base lasts longer.
    """
    loads = np.array([samples.column(f"load_{wheel}_n") for wheel in WHEELS])
    if loads.shape[1] < SHAKEN:
        return None
    # Over 100 ms: a joint's step shakes the rigid plant for an instant, and tips nothing.
    means = np.array([np.convolve(row, np.ones(SHAKEN), "valid") for row in loads])
    return float((3.0 * means / means.sum(axis=0)).min())


BENCH_SETUP: Final = BenchSetup(
    step=RomeArmStep,
    missions=Path(__file__).with_name("missions"),
    channels=(
        *(_full(BASE, name) for name in ("speed", "left", "turn")),
        _full(ARM, "up"),
    ),
    stick=_stick,
    twist=rome.BENCH_SETUP.twist,
    columns=(
        *_columns(BASE, rome.BENCH_SETUP.columns),
        *(row for row in ar2.BENCH_SETUP.columns if row.name.startswith(OF_THE_ARM)),
        Column(HEIGHT, "tool, above the floor", "m", plant="tool_z"),
        Column("tool_x_m", "tool, in the frame in which the run began", "m", plant="tool_x"),
        Column("tool_y_m", "tool, left", "m", plant="tool_y"),
        *(Column(f"load_{it}_n", f"what wheel {it} carries", "N", plant=f"load_{it}") for it in WHEELS),
    ),
    panels=(
        *_panels(BASE, rome.BENCH_SETUP.panels),
        Panel("Tool above the floor", "height [mm]", (Curve(HEIGHT, "actual (plant)", scale=1000.0),)),
        *(row for row in ar2.BENCH_SETUP.panels if row.limit is None),
        Panel("Wheel loads", "load [N]", tuple(Curve(f"load_{it}_n", f"wheel {it}") for it in WHEELS)),
    ),
    remarks=lambda robot: rome.BENCH_SETUP.remarks(BASE.robot(robot)),
    cases=cases,
    start_positions=ar2.BENCH_SETUP.start_positions,
    figures={**ar2.BENCH_SETUP.figures, "least_wheel_load_share": _least_load},
    paths={"orbit": _orbit, "formation": _formation, "pose": _pose},
)
