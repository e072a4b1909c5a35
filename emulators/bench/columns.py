"""The figures of a run: a column each, read every 10 ms from the plant or from what the bridge knew.

The table of samples, the CSV file, the summary's numbers and the pictures all come from them.
"""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from emulators.family import family_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds

SAMPLE_EVERY: Final[Nanoseconds] = 10 * MILLISECOND
AT: Final = "at"
Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Column:
    """One figure: an output of the plant, or something of the bridge's newest snapshot."""

    name: str
    """Its key in the table, with its unit's word at the end."""
    title: str
    unit: str
    plant: str = ""
    """The plant's output; empty where the bridge knows it."""
    seen: Callable[[Snapshot[Any, Any]], float] | None = None
    most: bool = False
    """True if its largest absolute value is in the summary, as `max_NAME`."""


@dataclass(frozen=True, slots=True)
class Curve:
    """One column in a panel."""

    column: str
    label: str
    scale: float = 1.0
    """Factor from the column's unit to the panel's."""
    step: bool = False
    """Drawn broad and in steps: the set-point, behind the actual value."""
    right: bool = False
    """True if the panel's right axis is its own: a panel's second quantity."""


@dataclass(frozen=True, slots=True)
class Panel:
    """One plot over time in `speeds.png`."""

    title: str
    label: str
    curves: tuple[Curve, ...]
    limit: Callable[[AnyRobot], tuple[float, str]] | None = None
    """A line at this value and its unit, and at its negative where a curve goes there."""
    shaded: bool = False
    """True if the time of interlock events is shaded in it."""
    height: float = 1.4
    least: float = 0.0
    """Least span of the vertical axis, so that noise does not look like a movement."""
    right: str = ""
    """Quantity and unit of the right axis, as `label` is of the left one; empty where no curve needs it."""


POSE: Final = ("x_m", "y_m", "heading_rad")
ODOMETRY: Final = ("odometry_x_m", "odometry_y_m", "odometry_heading_rad")

SIDEWAYS: Final = "speed_left_mps"
"""The column of the speed to the left, of a robot that moves across its own x, too."""

PLANAR: Final = (
    Column("x_m", "reference point, in the frame in which the run began", "m", plant="x"),
    Column("y_m", "left", "m", plant="y"),
    Column("heading_rad", "counter-clockwise from x", "rad", plant="heading"),
    Column("speed_mps", "forward speed of the reference point", "m/s", plant="speed"),
    Column("yaw_rate_rad_s", "counter-clockwise", "rad/s", plant="yaw_rate"),
    Column("odometry_x_m", "where the bridge believes to be", "m", seen=lambda seen: seen.pose.x_m),
    Column("odometry_y_m", "left", "m", seen=lambda seen: seen.pose.y_m),
    Column("odometry_heading_rad", "counter-clockwise", "rad", seen=lambda seen: seen.pose.heading_rad),
)
"""Columns of every robot that drives on a plane."""

ARMED: Final = Column("armed", "1 while the robot may move", "", seen=lambda seen: float(seen.facts.armed))


def current(axis: str) -> str:
    """Return the name of the column of an axis's motor current in A."""
    return f"current_{axis}_a"


def motor_speed(axis: str) -> str:
    """Return the name of the column of an axis's motor speed in rad/s."""
    return f"motor_speed_{axis}_rad_s"


def electric(robot: AnyRobot) -> list[str]:
    """Return the axes whose motor currents the plant has: no stepper's, which its driver keeps."""
    return [axis.name for axis in robot.axes if family_of(robot, axis.link).electric]


def columns_of(axes: Sequence[str], own: tuple[Column, ...]) -> tuple[Column, ...]:
    """Return a robot's columns: its own, and those of axes whose currents the plant has."""
    currents = tuple(Column(current(axis), "motor current", "A", plant=f"current_{axis}") for axis in axes)
    speeds = tuple(Column(motor_speed(axis), "motor shaft", "rad/s", plant=f"speed_{axis}") for axis in axes)
    return (*own, ARMED, *currents, *speeds)


@dataclass(frozen=True, slots=True)
class Sample:
    """One row of the table."""

    at: Nanoseconds
    values: tuple[float, ...]
    _places: dict[str, int] = field(compare=False)

    def __getitem__(self, name: str) -> float:
        return self.values[self._places[name]]


class Samples(Sequence[Sample]):
    """The table of a run: a row every 10 ms."""

    __slots__ = ("_at", "_places", "_rows", "columns", "truth")

    def __init__(self, columns: tuple[Column, ...], *, truth: bool = True) -> None:
        self.columns: Final = columns
        self.truth: Final = truth
        """True if a plant provides them; else they are measured values."""
        self._places: Final = {column.name: place for place, column in enumerate(columns)}
        self._at: list[Nanoseconds] = []
        self._rows: list[tuple[float, ...]] = []

    def __len__(self) -> int:
        return len(self._at)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[at] for at in range(*index.indices(len(self)))]
        return Sample(self._at[index], self._rows[index], self._places)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Samples) and (self._at, self._rows) == (other._at, other._rows)

    __hash__ = None  # type: ignore[assignment] # it grows

    def has(self, name: str) -> bool:
        """Return whether there is a column of this name."""
        return name in self._places

    def without_empty(self, names: Collection[str]) -> "Samples":
        """Return the table without those of these columns that hold no number."""
        kept = [
            place
            for place, column in enumerate(self.columns)
            if column.name not in names or not all(math.isnan(row[place]) for row in self._rows)
        ]
        table = Samples(tuple(self.columns[place] for place in kept), truth=self.truth)
        for at, row in zip(self._at, self._rows, strict=True):
            table.add(at, tuple(row[place] for place in kept))
        return table

    def add(self, at: Nanoseconds, values: tuple[float, ...]) -> None:
        """Add a row, its values in the order of the columns."""
        self._at.append(at)
        self._rows.append(values)

    def clear(self) -> None:
        """Forget all rows."""
        self._at.clear()
        self._rows.clear()

    def save_state(self) -> object:
        """Return the rows so far: numbers, of which a rewind need not look at each one."""
        return self._at[:], self._rows[:]

    def restore_state(self, state: tuple[list[Nanoseconds], list[tuple[float, ...]]]) -> None:
        """Restore these rows."""
        self._at[:], self._rows[:] = state

    def column(self, name: str) -> Floats:
        """Return a column from the first row to the last."""
        place = self._places[name]
        return np.array([row[place] for row in self._rows], dtype=np.float64)

    @property
    def seconds(self) -> Floats:
        """The rows' instants, s."""
        return np.array(self._at, dtype=np.float64) / 1e9

    def csv(self) -> str:
        """Return the table as text: a heading, then a line for each row, numbers with nine digits."""
        heading = ",".join(["at_s", *(column.name for column in self.columns)])
        lines = [
            ",".join([f"{at / 1e9:.2f}", *(f"{value:.9g}" for value in row)])
            for at, row in zip(self._at, self._rows, strict=True)
        ]
        return "\n".join([heading, *lines]) + "\n"
