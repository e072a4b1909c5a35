"""Invariants under all commands and faults: judged by the plant and the drives, not by the bridge.

Bounds are the robot file's own: the guard's sums and exclusive sides, the axes' travel. A row counts when it
has lasted for its time; rows that a lying device may break for a moment have a second, longer one.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from emulators.bench.columns import Sample, motor_speed
from emulators.epos2.drive import Epos2
from emulators.rig import BRIDGE, SECOND_BRIDGE, Rig
from firmware_bridge.bridge import Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.robot import AnyRobot, Axis, GuardExclusive, GuardSum, Unpowered
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds
from hil_tests.adversary.beyond import LOADER
from hil_tests.adversary.own import OWN, ROUNDED, Own, gives, joint, mean_rate
from hil_tests.adversary.reached import Reached

GOES_M: Final = 0.020
"""Allowed distance of a robot that was let go at rest, before it is held again; docs/safety.md."""
RESTED_MPS: Final = 0.02
OVERSHOOTS_S: Final = 0.1
"""A wheel may be quicker for a moment where its set-point jumps; the base may not."""
STANDS: Final = 1.0 / 40.0
"""An axis moves above this share of its top speed."""
MAY_NOT_S: Final = 2.0
"""Longest time of a stop in all.

A board that was reset may not receive a command for a time of its own, in which its shield goes on: that
comes on top.
"""
FORGETS_S: Final = 0.1
"""Allowance beside a board's auto-stop: its last command is a cycle old, and its loop looks at 30 Hz."""
ENDS_S: Final = 15.0
"""The longest end of a bridge; firmware_bridge/runtime/runner.py waits so long."""


@dataclass(frozen=True, slots=True)
class Look:
    """The truth at one instant."""

    robot: AnyRobot
    row: Sample
    speeds: Mapping[str, float]
    """Speeds of the axes, in their units a second."""
    places: Mapping[str, float]
    """Positions of the axes with travel, from their true 0."""
    powered: frozenset[str]
    unwatched: frozenset[str]
    """The axes with power whose drives watch no one."""
    may_move: bool
    """The bridge is alive and armed, and the last word that it accepted is none to stop."""
    gone: bool
    """The bridge is dead, or has ended, and there is no second one, which may have taken the robot over."""
    ending: bool
    """It has received a request to end, and neither has nor holds the robot on a slope."""
    rolled_m: float
    """Distance of the base since it was let go at rest, without an order or a fault."""
    stopped: bool
    """Its power shall go: by an emergency stop, on the flat, and no fault is in the way."""
    own: Mapping[str, float]
    """Ratios to the bounds of this kind of robot."""
    unreached: frozenset[str] = frozenset()
    """The axes of boards that no word of any bridge can reach."""
    runs_on: frozenset[str] = frozenset()
    """Unreached axes whose board goes on as commanded, until it is reached again: nothing can stop them."""
    left_out: frozenset[str] = frozenset()
    """The axes that its mode does without, by an order, where this bridge alone gives power."""
    let_go: bool = False
    """Nothing but the bridge itself takes the power: neither a fault nor an order."""
    loads: frozenset[str] = frozenset()
    """The axes whose board is in its boot loader."""
    refused: bool = False
    """The guard has refused a word of the bridge's own."""

    def moves(self, name: str, slowest: Mapping[str, float]) -> float:
        """Return the axis's speed as a share of the slowest that counts as motion."""
        return abs(self.speeds[name]) / slowest[name]


Ratio = Callable[[Look], float]
"""Ratio to the bound; above 1 it is violated."""


@dataclass(frozen=True, slots=True)
class Invariant:
    """One thing that may never be."""

    name: str
    ratio: Ratio
    lasts_s: float = 0.0
    """Time for which it must be broken to count."""
    lying_s: float | None = None
    """The same where a device may lie or another master speaks; None: it is not judged there."""


@dataclass(frozen=True, slots=True)
class Violation:
    """An invariant that was broken."""

    name: str
    since: Nanoseconds
    ratio: float


class Truth:
    """Reader of a robot's truth from its rig."""

    def __init__(self, robot: AnyRobot) -> None:
        self.robot: Final = robot
        self._travelling: Final = tuple(axis for axis in robot.axes if axis.travel is not None)
        links = robot.links
        self._watching: Final = {axis.name for axis in robot.axes if isinstance(links[axis.link], Epos2Link)}
        """The axes whose drives have a watch of their own over the bridge."""
        self._free: Final = {axis.name for axis in robot.axes if axis.unpowered is Unpowered.FREE}
        self._reached: Final = Reached(robot)
        self._counted: Final = {axis.name for axis in robot.axes if axis.link in Ar2Link.all_of(robot)}
        """The axes without an encoder: the plant has their joints' angles, and no motor's."""
        self.let_go_at: tuple[float, float] | None = None
        """Pose in which the base rested when it last had power; None where it did not rest."""

    def look(self, rig: Rig, *, reported_to_stop: bool, stopped: bool, let_go: bool) -> Look:
        """Return the truth of now, which must be an instant of a sample.

        `stopped`: the last word that was accepted is an emergency stop, on the flat. `let_go`: nothing but
        the bridge itself takes the power: neither a fault nor an order.
        """
        row, plant = rig.samples[-1], rig.devices.plant
        axes = {axis.name: axis for axis in rig.devices.axes}
        turned = dict(zip(plant.output_names, plant.outputs, strict=True))
        powered = frozenset(name for name, axis in axes.items() if axis.powered)
        drives = rig.devices.nodes(Epos2)
        unwatched = {name for name in powered if name in self._watching and not _watch(drives[name])}
        bridge, alive = rig.bridge, rig.world.here(BRIDGE)
        ending = alive and bridge.phase in (Life.STOPPING, Life.LEAVING) and not bridge.holding
        gone = not alive or bridge.finished
        alone = gone and not rig.world.here(SECOND_BRIDGE)
        rolled = self._rolled(row, powered)
        unreached, runs_on = self._reached.look(rig)
        return Look(
            self.robot,
            row,
            {axis.name: self._speed(axis, rig) for axis in self.robot.axes},
            {axis.name: self._place(axis, turned[f"angle_{axis.name}"]) for axis in self._travelling},
            powered,
            frozenset(unwatched),
            bool(row["armed"]) and not reported_to_stop and not gone,
            alone,
            ending,
            rolled if let_go else 0.0,
            stopped and let_go,
            {own.name: own.ratio(self.robot, rig) for own in OWN.get(self.robot.kind, ())},
            unreached,
            runs_on,
            frozenset() if gone or rig.world.here(SECOND_BRIDGE) else bridge.seen.facts.without,
            let_go,
            loads=self._reached.loads(rig),
            refused=any(refusal.packet is not None for refusal in rig.guard.refusals),
        )

    def _speed(self, axis: Axis, rig: Rig) -> float:
        """Return an axis's speed; a stepper's, which swings with each step, as the mean of some moves."""
        if axis.name in self._counted:
            return mean_rate(rig, joint(axis.name))
        return _of(axis, rig.samples[-1][motor_speed(axis.name)])

    def _place(self, axis: Axis, angle: float) -> float:
        return angle if axis.name in self._counted else _of(axis, angle)

    def _rolled(self, row: Sample, powered: frozenset[str]) -> float:
        place = row["x_m"], row["y_m"]
        if powered & self._free:
            self.let_go_at = place if abs(row["speed_mps"]) < RESTED_MPS else None
        return 0.0 if self.let_go_at is None else math.dist(place, self.let_go_at)


def _watch(drive: Epos2) -> int:
    """Return after how many ms of the bridge's silence a drive stops by itself; 0 for never."""
    return int(drive.store.get(od.CONSUMER_HEARTBEAT_1)) & 0xFFFF


def _of(axis: Axis, motor: float) -> float:
    return axis.direction * motor / axis.ratio


def invariants(robot: AnyRobot) -> tuple[Invariant, ...]:
    """Return the rows of a robot."""
    slowest = {axis.name: STANDS * axis.top_speed for axis in robot.axes}
    free = {axis.name for axis in robot.axes if axis.unpowered is Unpowered.FREE}
    stops_itself = [
        link.auto_stop_ms / 1000.0 for link in ShieldLink.all_of(robot).values() if link.stops_itself
    ]
    forgets_s = max(stops_itself, default=0.0) + FORGETS_S

    def may_not_move(look: Look) -> float:
        # A board that no one reaches stops by itself where it can, in a time of its own: see `forgot`.
        forgetting = look.unreached if stops_itself else frozenset[str]()
        moves = (look.moves(name, slowest) for name in look.powered - look.runs_on - forgetting)
        return 0.0 if look.may_move else max(moves, default=0.0)

    def forgot(look: Look) -> float:
        names = look.powered & look.unreached - look.runs_on - look.loads
        return max((look.moves(name, slowest) for name in names), default=0.0)

    def loads(look: Look) -> float:
        names = look.powered & look.unreached & look.loads - look.runs_on
        return max((look.moves(name, slowest) for name in names), default=0.0)

    may_not_s = MAY_NOT_S + max(
        (link.boots / 1000.0 for link in ShieldLink.all_of(robot).values()), default=0.0
    )

    def unattended(look: Look) -> float:
        return 2.0 * bool(look.gone and look.powered - look.runs_on)

    def left_out(look: Look) -> float:
        return 2.0 * bool(look.powered & look.left_out)

    return (
        *(_sum(total) for total in robot.guard.sums),
        *(_exclusive(pair, slowest) for pair in robot.guard.exclusive),
        *(_travel(axis.name, axis.travel) for axis in robot.axes if axis.travel is not None),
        *(_own(own, frozenset(free or slowest)) for own in OWN.get(robot.kind, ())),
        *(
            (
                Invariant("a board that no one reaches runs on", forgot, forgets_s, 6.0),
                Invariant(LOADER.rule, loads, LOADER.bound, LOADER.bound),
            )
            * bool(stops_itself)
        ),
        Invariant("motion with power that may not be", may_not_move, may_not_s, 6.0 + may_not_s - MAY_NOT_S),
        Invariant("power that no one watches", lambda look: 2.0 * bool(look.unwatched), 1.0, 6.0),
        Invariant("power without a bridge", unattended, may_not_s, 6.0),
        Invariant(
            "an emergency stop with power", lambda look: 2.0 * bool(look.stopped and look.powered), 5.0
        ),
        Invariant("an end without an end", lambda look: 2.0 * look.ending, ENDS_S),
        # A lying device keeps its power: a row of the bridge reports so, and keeps the robot where it is.
        Invariant("power for what is left out", left_out, MAY_NOT_S),
        Invariant("a word that the guard refuses", lambda look: 2.0 * look.refused),
        Invariant("let go, and rolls", lambda look: look.rolled_m / GOES_M),
    )


def _sum(total: GuardSum) -> Invariant:
    def ratio(look: Look) -> float:
        if not look.powered >= total.of.keys():
            return 0.0  # what rolls out is held by no one
        summed = sum(look.speeds[name] * factor for name, factor in total.of.items())
        return abs(summed) / (ROUNDED * gives(look.robot) * total.bound)

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


def _own(own: Own, free: frozenset[str]) -> Invariant:
    needed = free if own.needs is None else own.needs

    def ratio(look: Look) -> float:
        # What rolls out, or down a slope, is held by no one; nor are gears that turn on.
        judged = look.powered >= needed - look.left_out or (own.unpowered and look.let_go)
        return look.own[own.name] if judged else 0.0

    return Invariant(own.name, ratio, own.lasts_s)


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
