"""Rules over several axes: a sum of speeds that stays within its bound, and sides that never move together.

Set-points of one cycle leave one after the other, so between two vectors of speeds that are both within a
bound lie mixtures that are not. A mixture is let through while another axis of the sum may still correct it:
until each of them has been sent a set-point, at the same instant or later, and no longer than a cycle. Over
any length of time the sum's integral exceeds its bound by no more than a fixed amount, which no honest bridge
can reach with mixtures; so no one can go on from one mixture to the next.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping
from typing import Final

from firmware_bridge.robot import AnyRobot, GuardExclusive, GuardSum
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, from_seconds

HALTED_WITHIN: Final[Nanoseconds] = SECOND
"""Time beyond the robot file's within which a homing must end; the bridge halts it before."""


class AxesRule(ABC):
    """A rule over several axes."""

    name: str
    axes: tuple[InForce, ...]
    """To whose set-points it applies."""
    members: frozenset[InForce]
    """The same, without an order."""
    due: Nanoseconds
    """Deadline by which all its axes must be stopped; NEVER while the rule is kept."""

    @abstractmethod
    def refuses(self, requested: Mapping[InForce, RequestedMotion], now: Nanoseconds) -> str | None:
        """Return why set-points that come into force together may not, or None."""

    @abstractmethod
    def stops_with(self, axes: Collection[InForce]) -> tuple[InForce, ...]:
        """Return which axes come to standstill together with those whose set-point was refused."""

    @abstractmethod
    def sent(self, axis: InForce, now: Nanoseconds) -> None:
        """Note that an axis was sent a set-point."""


class SpeedSum(AxesRule):
    """The axes' speeds, each with its factor, together not beyond a bound to either side."""

    def __init__(self, row: GuardSum, axes: Mapping[str, InForce]) -> None:
        self.name = row.name
        self.axes = tuple(axes[axis] for axis in row.of)
        self.members = frozenset(self.axes)
        self.due = NEVER
        self._terms: Final = tuple((axes[axis], factor) for axis, factor in row.of.items())
        self._bound: Final = row.bound
        # The slowest link of the sum sends the last set-point that can still correct it.
        self._patience: Final = max(axis.cycle for axis in self.axes)
        reach = sum(abs(factor) * axis.axis.top_speed for axis, factor in self._terms)
        self._most_excess: Final = 2.0 * reach * self._patience
        """Most excess of all axes in two cycles at their top speeds; in the sum's unit times ns."""
        self._to_come: tuple[InForce, ...] = ()
        """The axes that had no set-point when the bound was passed, nor since."""
        self._passed_at: Nanoseconds = NEVER
        """Time of the last passing of the bound."""
        self._kept_at: Nanoseconds = -NEVER
        """Since when the sum is within its bound; NEVER while it is not."""
        self._value = 0.0
        """The sum in force."""
        self._above = self._below = 0.0
        """The integral of what the sum is beyond its bound, to each side; within it falls, down to 0."""
        self._summed_at: Nanoseconds = 0

    def refuses(self, requested: Mapping[InForce, RequestedMotion], now: Nanoseconds) -> str | None:
        """Refuse what passes the bound when no one is left to correct it; rest is never refused."""
        if not any(one.speed for one in requested.values()):
            return None
        value = 0.0
        for one, factor in self._terms:
            own = requested.get(one)
            value += factor * (one.speed if own is None else own.speed)
        if abs(value) <= self._bound:
            return None
        if self._others(requested, now) and self._excess(value) < self._most_excess:
            return None
        return f"{self.name} of {value:.4f} is beyond {math.copysign(self._bound, value):.4f}"

    def stops_with(self, axes: Collection[InForce]) -> tuple[InForce, ...]:
        """Stop all: what is left of a sum without one of its axes may be further beyond."""
        return tuple(one for one in self.axes if one not in axes and one.moving)

    def sent(self, axis: InForce, now: Nanoseconds) -> None:
        """Find out until when the new sum may stand."""
        self._sum_up(now)
        value = 0.0
        for one, factor in self._terms:
            value += factor * one.speed
        self._value = value
        beyond = abs(value) - self._bound
        if beyond <= 0.0:
            # The first instant within the bound counts; a later one must not make the time look shorter.
            self._kept_at = min(self._kept_at, now)
            self.due = NEVER
            return
        self._to_come = self._others((axis,), now)
        # Only the first excess starts the time: going on from one mixture to the next must not extend it.
        if self._kept_at not in {NEVER, now}:
            self._passed_at = now
        self._kept_at = NEVER
        # The instant at which the integral reaches its bound if the sum stays as it is.
        exhausted = now + int((self._most_excess - self._excess(value)) / beyond)
        self.due = min(self._passed_at + self._patience, exhausted) if self._to_come else now

    def _others(self, axes: Collection[InForce], now: Nanoseconds) -> tuple[InForce, ...]:
        """Return who may still correct what these axes do: no one that has been sent a set-point since."""
        # To be within at an instant only, before the next command of that instant, corrects nothing.
        to_come = self._to_come if self._kept_at in {NEVER, now} else self.axes
        return tuple(one for one in to_come if one not in axes and one.commanded_at < now)

    def _sum_up(self, now: Nanoseconds) -> None:
        elapsed = now - self._summed_at
        if elapsed:
            # Within the bound the integral falls again, down to 0: a small sum saves nothing up for a large
            # one.
            self._above = max(0.0, self._above + (self._value - self._bound) * elapsed)
            self._below = max(0.0, self._below + (-self._value - self._bound) * elapsed)
            self._summed_at = now

    def _excess(self, value: float) -> float:
        return self._above if value > 0.0 else self._below


class Exclusion(AxesRule):
    """Two sides of which one may be commanded to move; the other one must be at standstill before."""

    def __init__(self, row: GuardExclusive, axes: Mapping[str, InForce]) -> None:
        self.name = row.name
        self.due = NEVER
        one, other = (tuple(axes[axis] for axis in side) for side in (row.one, row.other))
        self.axes = (*one, *other)
        self.members = frozenset(self.axes)
        self._against: Final = {**dict.fromkeys(row.one, other), **dict.fromkeys(row.other, one)}

    def refuses(self, requested: Mapping[InForce, RequestedMotion], now: Nanoseconds) -> str | None:
        """Refuse motion while the other side is commanded to move; rest is never refused."""
        del now
        for axis in _movers(requested, self.members):
            moving = [
                other.axis.title
                for other in self._against[axis.axis.name]
                # Axes of the same packet are judged by what it requests of them, all others by what is in
                # force.
                if (requested[other].moves if other in requested else other.moving)
            ]
            if moving:
                return f"{self.name}: {axis.axis.title} may not move while {', '.join(moving)} may"
        return None

    def stops_with(self, axes: Collection[InForce]) -> tuple[InForce, ...]:
        """Stop no other axis: one that already moves may go on."""
        del axes
        return ()

    def sent(self, axis: InForce, now: Nanoseconds) -> None:
        """Do nothing: each axis knows what is in force."""


class OneHomes(AxesRule):
    """Exclusive motion of an axis that homes; its homing may last for its time only."""

    name = "homing"

    def __init__(self, axes: Iterable[InForce]) -> None:
        self.axes = tuple(axes)
        self.members = frozenset(self.axes)
        self.due = NEVER

    def refuses(self, requested: Mapping[InForce, RequestedMotion], now: Nanoseconds) -> str | None:
        """Refuse motion while another axis homes."""
        del now
        for axis in _movers(requested, self.members):
            homing = next((it.axis.title for it in self.axes if it is not axis and it.homes), None)
            if homing is not None:
                return f"{self.name}: {axis.axis.title} may not move while {homing} is homing"
        return None

    def stops_with(self, axes: Collection[InForce]) -> tuple[InForce, ...]:
        """Stop no one else: it finds its zero alone, and may go on."""
        del axes
        return ()

    def sent(self, axis: InForce, now: Nanoseconds) -> None:
        """Find out until when a homing may last that was started, or whether it has ended."""
        if axis.homes:
            self.due = now + from_seconds(axis.homes_within_s) + HALTED_WITHIN
        elif not any(other.homes for other in self.axes):
            self.due = NEVER


def _movers(requested: Mapping[InForce, RequestedMotion], axes: Collection[InForce]) -> list[InForce]:
    """Return who of these would move."""
    return [axis for axis, one in requested.items() if one.moves and axis in axes]


def rules_across(robot: AnyRobot, axes: Mapping[str, InForce]) -> tuple[AxesRule, ...]:
    """Return the rules of a robot file over several axes; `axes` by their names."""
    homed = any(axis.axis.zero.homing is not None for axis in axes.values())
    return (
        *((OneHomes(axes.values()),) if homed else ()),
        *(SpeedSum(row, axes) for row in robot.guard.sums),
        *(Exclusion(row, axes) for row in robot.guard.exclusive),
    )
