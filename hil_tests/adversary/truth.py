"""What may never be, whatever is said and fails: judged by the plant and the drives, not by the bridge.

Bounds are the robot file's own: the guard's sums and exclusive sides, the axes' travel. A row counts when it
has lasted for its time; rows that a lying device may break for a moment have a second, longer one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from emulators.bench.columns import Sample, motor_speed
from emulators.epos2.drive import Epos2
from emulators.rig import Rig
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.robot.model import GuardExclusive, GuardSum
from firmware_bridge.robot.settings.epos2 import Epos2Driver
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.epos2 import address as at

ROUNDED: Final = 1.02
"""Beside a bound of the robot file: what regulators and slip make of a hand that trembles at full stick."""
OVERSHOOTS_S: Final = 0.1
"""A wheel may be quicker for a moment where its set-point jumps; the base may not."""
STANDS: Final = 1.0 / 40.0
"""An axis moves above this share of its top speed."""
OWN: Final[Mapping[str, Mapping[str, float]]] = {"rars": {"speed_mps": 0.505}}
"""Bounds of a robot's columns beside those of its file."""


@dataclass(frozen=True, slots=True)
class Look:
    """The truth at one instant."""

    robot: AnyRobot
    row: Sample
    speeds: Mapping[str, float]
    """Of the axes, in their units a second."""
    places: Mapping[str, float]
    """Of the axes with travel, from where they truly are 0."""
    powered: frozenset[str]
    unwatched: frozenset[str]
    """The axes with power whose drives watch nobody."""
    may_move: bool
    """The bridge is armed, and the operator's last word that it accepted is none to stop."""

    def moves(self, name: str, slowest: Mapping[str, float]) -> float:
        """Return the axis's speed as a share of the slowest that counts as motion."""
        return abs(self.speeds[name]) / slowest[name]


Ratio = Callable[[Look], float]
"""How near the bound; above 1 it is broken."""


@dataclass(frozen=True, slots=True)
class Invariant:
    """One thing that may never be."""

    name: str
    ratio: Ratio
    lasts_s: float = 0.0
    """It counts when it is broken for so long."""
    lying_s: float | None = None
    """The same where a device may lie or another master speaks; None: it is not judged there."""


@dataclass(frozen=True, slots=True)
class Violation:
    """An invariant that was broken."""

    name: str
    since: Nanoseconds
    ratio: float


class Truth:
    """How the truth of a robot is read from its rig."""

    def __init__(self, robot: AnyRobot) -> None:
        self.robot: Final = robot
        self._travelling: Final = tuple(axis for axis in robot.axes if axis.travel is not None)

    def look(self, rig: Rig, *, told_to_stop: bool) -> Look:
        """Return the truth of now, which must be an instant of a sample."""
        row, plant = rig.samples[-1], rig.devices.plant
        axes = {axis.name: axis for axis in rig.devices.bank.axes}
        turned = dict(zip(plant.output_names, plant.outputs, strict=True))
        powered = frozenset(name for name, axis in axes.items() if axis.powered)
        drives = rig.devices.drives
        unwatched = {name for name in powered if self._watches(name) and not _watch(drives[name])}
        return Look(
            self.robot,
            row,
            {axis.name: _of(axis, row[motor_speed(axis.name)]) for axis in self.robot.axes},
            {axis.name: _of(axis, turned[f"angle_{axis.name}"]) for axis in self._travelling},
            powered,
            frozenset(unwatched),
            bool(row["armed"]) and not told_to_stop,
        )

    def _watches(self, name: str) -> bool:
        """Return whether an axis's drive has a watch of its own over the bridge: a gateway's is its line."""
        axis = next(axis for axis in self.robot.axes if axis.name == name)
        return self.robot.links[axis.link].driver is Epos2Driver.CAN


def _watch(drive: Epos2) -> int:
    """Return after how many ms of the bridge's silence a drive stops by itself; 0 for never."""
    return int(drive.store.get(at.CONSUMER_HEARTBEAT_1)) & 0xFFFF


def _of(axis: Axis, motor: float) -> float:
    return axis.direction * motor / axis.ratio


def invariants(robot: AnyRobot) -> tuple[Invariant, ...]:
    """Return the rows of a robot."""
    slowest = {axis.name: STANDS * axis.top_speed for axis in robot.axes}

    def may_not_move(look: Look) -> float:
        moves = (look.moves(name, slowest) for name in look.powered)
        return 0.0 if look.may_move else max(moves, default=0.0)

    return (
        *(_sum(total) for total in robot.guard.sums),
        *(_exclusive(pair, slowest) for pair in robot.guard.exclusive),
        *(_travel(axis.name, axis.travel) for axis in robot.axes if axis.travel is not None),
        *(_figure(name, bound) for name, bound in OWN.get(robot.kind, {}).items()),
        Invariant("motion with power that may not be", may_not_move, 2.0, 6.0),
        Invariant("power that nobody watches", lambda look: 2.0 * bool(look.unwatched), 1.0, 6.0),
    )


def _sum(total: GuardSum) -> Invariant:
    def ratio(look: Look) -> float:
        if not look.powered >= total.of.keys():
            return 0.0  # what rolls out is held by nobody
        summed = sum(look.speeds[name] * factor for name, factor in total.of.items())
        return abs(summed) / (ROUNDED * total.bound)

    return Invariant(f"{total.name} beyond its bound", ratio, OVERSHOOTS_S)


def _exclusive(pair: GuardExclusive, slowest: Mapping[str, float]) -> Invariant:
    def ratio(look: Look) -> float:
        return min(max(look.moves(name, slowest) for name in side) for side in (pair.one, pair.other))

    return Invariant(f"{pair.name}: both", ratio, 0.15)


def _travel(name: str, travel: tuple[float, float]) -> Invariant:
    middle, half = sum(travel) / 2.0, (travel[1] - travel[0]) / 2.0
    return Invariant(
        f"{name} beyond its travel", lambda look: abs(look.places[name] - middle) / (ROUNDED * half)
    )


def _figure(name: str, bound: float) -> Invariant:
    return Invariant(f"{name} beyond {bound:g}", lambda look: abs(look.row[name]) / bound)


@dataclass(slots=True)
class Judge:
    """Looks at a run, instant by instant; what it remembers goes with a moment that is kept."""

    rows: tuple[Invariant, ...]
    lying: bool = False
    since: dict[str, Nanoseconds] = field(default_factory=dict)
    nearest: float = 0.0
    """The largest ratio since it was set to 0."""

    def look(self, now: Nanoseconds, look: Look) -> Violation | None:
        """Return what has been broken for its time."""
        for row in self.rows:
            lasts = row.lying_s if self.lying else row.lasts_s
            if lasts is None:
                continue
            ratio = row.ratio(look)
            if ratio <= 1.0:
                self.since.pop(row.name, None)
                self.nearest = max(self.nearest, 0.5 * ratio)
                continue
            since = self.since.setdefault(row.name, now)
            share = 1.0 if not lasts else (now - since) / (lasts * SECOND)
            self.nearest = max(self.nearest, 0.5 + 0.5 * share)
            if now - since >= from_seconds(lasts):
                return Violation(row.name, since, ratio)
        return None
