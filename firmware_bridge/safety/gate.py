"""The gate: one snapshot in, one ruling out. It keeps which interlocks hold and since when, nothing else.

Nothing holds until a snapshot trips it, so there is nothing to unlock at boot; latches belong to whoever
clears them and come in with the snapshot. A hold ends when its interlock has been clear at every look for
its clear time; the first clear look starts that time, and a trip in between starts it anew.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from firmware_bridge.intent import NEVER_HEARD, Intent
from firmware_bridge.motion import davis
from firmware_bridge.motion.ramp import Ramp
from firmware_bridge.robot import Axis, Robot
from firmware_bridge.safety import interlocks, limits
from firmware_bridge.safety.interlocks import DRIVE_STOPS, LIFT_REFUSED, STOPS, View
from firmware_bridge.safety.limits import LIMITS
from firmware_bridge.safety.snapshot import DriveSnapshot, Hold, Snapshot
from firmware_bridge.units import NEVER, Nanoseconds

LIFT_TOLERANCE_M: Final = 0.001
"""A lift this near to the height asked for has arrived: it holds its target, it does not move."""
SPEED_TOLERANCE_MPS: Final = 1e-4
"""A step that the ramp shortens by less is not reported; the drives' speed comes in whole rpm, 0.2 mm/s."""


@dataclass(frozen=True, slots=True)
class Ruling:
    """What may be done now, and why not more."""

    holds: tuple[Hold, ...]
    stopped: bool
    """A stop holds: the base ramps to 0 and the steering stays where it is (halt)."""
    speed_mps: float
    """Base speed to go to, at the pace of `firmware_bridge.motion.ramp`; 0 while stopped."""
    steer_rad: float
    """Inner wheel angle to go to; while stopped the last one that was allowed."""
    lifting: bool
    """False: the lift stays where it is (halt)."""
    lift_m: float | None
    """Height to go to; None leaves it to the rate."""
    lift_rate_mps: float


class _Memory:
    """The hold of each interlock, and since when it has been clear."""

    __slots__ = ("_clear_since", "_holds")

    def __init__(self) -> None:
        self._holds: dict[str, Hold] = {}
        self._clear_since: dict[str, Nanoseconds] = {}

    def holds(self, name: str) -> bool:
        return name in self._holds

    def look(
        self, name: str, reason: str | None, remedy: str, clear_after: Nanoseconds, now: Nanoseconds
    ) -> Hold | None:
        """Take one look's outcome; return the hold where there is one."""
        if reason is not None:
            self._clear_since.pop(name, None)
            return self._holds.setdefault(name, Hold(name, reason, remedy, now))
        hold = self._holds.get(name)
        if hold is not None and now - self._clear_since.setdefault(name, now) >= clear_after:
            del self._holds[name], self._clear_since[name]
            return None
        return hold


class Gate:
    """The interlocks of one robot."""

    __slots__ = ("_drive_rows", "_lift_let_go", "_memory", "_ramp", "_robot", "_steer_rad")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._ramp = Ramp.of(robot)
        self._memory = _Memory()
        self._drive_rows = {
            axis.name: tuple((f"{row.name}: {axis.name}", row) for row in DRIVE_STOPS) for axis in robot.axes
        }
        """Each axis's interlocks with the names of their holds."""
        self._lift_let_go = False
        self._steer_rad: float | None = None

    def rule(self, seen: Snapshot) -> Ruling:
        """Judge the wish in this snapshot; `seen.now` never runs backwards."""
        view = View(self._robot, seen, lift_let_go=self._lift_let_go)
        base, lift = self._stops(view)
        stopped = bool(base)
        wish, clips = self._clipped(seen, stopped=stopped)
        if stopped:
            wish = replace(wish, speed_mps=0.0, steer_rad=self._held_steer(seen))
        else:
            self._steer_rad = wish.steer_rad
        clips += self._acceleration(seen, wish.speed_mps, stopped=stopped)
        wanted = _lift_wanted(wish, seen.lift_m)
        let_go = View(self._robot, seen, lift_let_go=self._lift_let_go, speed_let_go_mps=wish.speed_mps)
        refused = self._lift_refusal(let_go, wanted=wanted)
        lifting = not lift and not refused
        self._lift_let_go = lifting and wanted
        return Ruling(
            holds=(*base, *clips, *refused),
            stopped=stopped,
            speed_mps=wish.speed_mps,
            steer_rad=wish.steer_rad,
            lifting=lifting,
            lift_m=wish.lift_m if lifting else None,
            lift_rate_mps=wish.lift_rate_mps if lifting else 0.0,
        )

    def next_deadline(self, seen: Snapshot) -> Nanoseconds:
        """Return the instant at which a silence will trip if nothing more is heard; NEVER where none will.

        It lies after `seen.now`: a silence that has tripped already asks for nothing.
        """
        limit = interlocks.drive_silent_after(self._robot)
        trips = [drive.heard_at + limit for drive in seen.drives]
        trips.append(seen.intent.heard_at + interlocks.operator_silent_after(self._robot))
        first = NEVER
        for trip in trips:
            if trip > seen.now:
                first = min(first, trip)
        return first

    def _stops(self, view: View) -> tuple[tuple[Hold, ...], tuple[Hold, ...]]:
        """Return the holds that stop the base, and those of them that stop the lift as well."""
        base: list[Hold] = []
        lift: list[Hold] = []
        memory, now = self._memory, view.seen.now
        for row in STOPS:
            reason = row.judge(view.held() if memory.holds(row.name) else view)
            hold = memory.look(row.name, reason, row.remedy, row.clear_after, now)
            if hold is not None:
                base.append(hold)
                if not row.lift_is_free:
                    lift.append(hold)
        drives = {drive.axis: drive for drive in view.seen.drives}
        for axis in self._robot.axes:
            holds = self._drive_stops(axis, drives.get(axis.name) or _absent(axis), now)
            base += holds
            lift += holds
        return tuple(base), tuple(lift)

    def _drive_stops(self, axis: Axis, drive: DriveSnapshot, now: Nanoseconds) -> list[Hold]:
        holds = []
        for name, row in self._drive_rows[axis.name]:
            reason = row.judge(self._robot, axis, drive, now)
            hold = self._memory.look(name, reason, row.remedy, row.clear_after, now)
            if hold is not None:
                holds.append(hold)
        return holds

    def _clipped(self, seen: Snapshot, *, stopped: bool) -> tuple[Intent, tuple[Hold, ...]]:
        """Return the wish within all limits; while stopped it is not the limits that hold it back."""
        wish = seen.intent
        holds: list[Hold] = []
        for row in LIMITS:
            value = getattr(wish, row.field)
            reason = None
            if value is not None:
                allowed, reason = row.clip(value, self._robot, seen)
                if allowed != value:
                    change: dict[str, Any] = {row.field: allowed}
                    wish = replace(wish, **change)
            holds += self._limit_hold(row.name, None if stopped else reason, row.remedy, seen.now)
        return wish, tuple(holds)

    def _acceleration(self, seen: Snapshot, speed_mps: float, *, stopped: bool) -> tuple[Hold, ...]:
        reason = None if stopped else self._haste(seen, speed_mps)
        return self._limit_hold(limits.ACCELERATION_LIMIT, reason, limits.ACCELERATION_REMEDY, seen.now)

    def _haste(self, seen: Snapshot, speed_mps: float) -> str | None:
        demanded = seen.demanded_speed_mps
        bend = davis.curvature(self._robot.base, seen.steer_rad or 0.0)
        step = self._ramp.step(demanded, speed_mps, bend, self._ramp.longest_step)
        if abs(speed_mps - step) <= SPEED_TOLERANCE_MPS:
            return None
        return (
            f"asked to go from {demanded:.2f} to {speed_mps:.2f} m/s at once, "
            f"limit {self._robot.limits.acceleration_mps2:.2f} m/s2"
        )

    def _limit_hold(self, name: str, reason: str | None, remedy: str, now: Nanoseconds) -> tuple[Hold, ...]:
        hold = self._memory.look(name, reason, remedy, limits.CLEARS_AFTER, now)
        return () if hold is None else (hold,)

    def _lift_refusal(self, view: View, *, wanted: bool) -> tuple[Hold, ...]:
        row = LIFT_REFUSED
        looked = view.held() if self._memory.holds(row.name) else view
        reason = row.judge(looked) if wanted else None
        hold = self._memory.look(row.name, reason, row.remedy, row.clear_after, view.seen.now)
        return () if hold is None else (hold,)

    def _held_steer(self, seen: Snapshot) -> float:
        if self._steer_rad is not None:
            return self._steer_rad
        actual = seen.steer_rad
        return actual if actual is not None and math.isfinite(actual) else 0.0


def _lift_wanted(wish: Intent, height_m: float | None) -> bool:
    if wish.lift_m is None:
        return wish.lift_rate_mps != 0.0
    return height_m is None or not abs(wish.lift_m - height_m) <= LIFT_TOLERANCE_M


def _absent(axis: Axis) -> DriveSnapshot:
    return DriveSnapshot(axis.name, axis.node, None, NEVER_HEARD, 0, 0.0, 0, 0)
