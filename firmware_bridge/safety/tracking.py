"""Tracking of each axis: the range that its set-points permit, sample by sample.

The range reaches to a new set-point at once, and leaves an old one no faster than the slowest healthy axis:
with a time constant, and at a rate. A speed, a stop or a homing bounds the speed between two samples; a
position bounds the position. The consequences of a deviation belong to the interlocks in `common`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Homed, Position, Power, SetPoint, Speed, Stop
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.snapshot import Tracking
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

DEVIATION: Final = 1.0 / 40.0
"""Share of its top speed that an axis may deviate; of positions the travel of so many seconds at it."""
GIVES: Final = 1.0 / 50.0
"""Share of a speed by which a regulator may give way, beside that.

A robot that turns on a slope is pulled ahead and held back in turns. An axis commanded to 14.8 rad/s is 0.46
rad/s off on 10 degrees.
"""
LAZY: Final = 0.5
"""Share of its drive's own ramp and cruise that is awaited of an axis."""
TURNS: Final = 1.0 / 2.0
"""Share of the least speed that its set-points let an axis have, from which it turns as commanded."""
IDLE: Final = 2
"""Samples ago that it turned so: where it was cut off between two, the last that moved shows a part."""
REGULATED: Final[Nanoseconds] = 100 * MILLISECOND
"""Allowance for regulators, play and slip; the way there and back takes a cycle of its link each."""
WITHOUT_TORQUE: Final = (Power.OFF, Power.FAULT)


@dataclass(frozen=True, slots=True)
class Bounds:
    """The bounds expected of one axis, in its unit."""

    speed: float
    position: float
    ramp: float
    cruise: float
    creep: float
    """Permitted backlog of travel while its position does not change."""
    lag_s: float
    homing: float = 0.0
    """Top speed while it is homed."""

    def around(self, low: float, high: float) -> float:
        """Return how far from a range of speeds the axis may be."""
        return self.speed + GIVES * max(-low, high)


def within(axis: Axis, silence: Nanoseconds) -> Nanoseconds:
    """Return how long an axis may deviate: by the robot file, else the silence that its link allows."""
    limits = axis.plausibility.within_ms
    return silence if limits is None else limits * MILLISECOND


def bounds_of(robot: AnyRobot, axis: Axis) -> Bounds:
    """Return the bounds by the robot file, else those that follow from axis, drive and link."""
    limits, stray, homing = axis.plausibility, DEVIATION * axis.top_speed, axis.zero.homing
    slowest = axis.settings.slowest_ramp(axis.ratio)
    if homing is not None:
        # Interrupted it is halted with the acceleration of its homing.
        slowest = min(slowest, homing.acceleration)
    link = robot.links[axis.link]
    lag = REGULATED + 2 * link.every * robot.cycle
    return Bounds(
        speed=limits.speed or stray,
        position=limits.position or stray,
        ramp=limits.ramp or LAZY * slowest,
        cruise=limits.cruise or LAZY * axis.settings.cruise(axis.ratio),
        creep=axis.standstill_below * to_seconds(within(axis, link.silent_ms * MILLISECOND)),
        lag_s=to_seconds(lag if limits.lag_ms is None else limits.lag_ms * MILLISECOND),
        homing=0.0 if homing is None else homing.fastest,
    )


class TrackingMonitor:
    """One axis: the set-points that were sent to it, its samples, and what they say of each other."""

    __slots__ = (
        "_aim",
        "_bounds",
        "_braking",
        "_changed_at",
        "_coasts_at",
        "_goal",
        "_high",
        "_low",
        "_positions",
        "_set_point",
        "following",
    )  # fmt: skip

    def __init__(self, axis: Axis, bounds: Bounds) -> None:
        self._bounds: Final = bounds
        self._coasts_at: Final = axis.top_speed
        """Speed bound on its way to a position when it is commanded to stop."""
        self._set_point: SetPoint = Stop.STANDSTILL
        self._changed_at: Nanoseconds = NEVER_RECEIVED
        self._aim: SetPoint | None = None
        """The set-point in force, or its device's own stop; None while it has no torque."""
        self._positions = False
        """True where the aim is a position."""
        self._braking = 1.0
        """Share of its quick stop's deceleration that its newest speed has set."""
        self._goal = self._low = self._high = 0.0
        self.following = Tracking()

    def on_set_point(self, set_point: SetPoint, now: Nanoseconds) -> None:
        """Take the set-point of the axis from now on."""
        if set_point is not self._set_point and set_point != self._set_point:
            self._set_point, self._changed_at = set_point, now
            if isinstance(set_point, Speed):
                self._braking = set_point.braking
            if self._aim is not None:
                self._take(set_point)

    def saw(self, feedback: Feedback) -> Tracking:
        """Return what is known up to this feedback's sample; one that was seen already changes nothing."""
        before, at = self.following, feedback.sampled_at
        if at == before.sampled_at:
            return before
        # Without torque an axis may turn freely, and a sample of a new count gives no distance: neither is
        # judged.
        if feedback.power in WITHOUT_TORQUE or before.sampled_at == NEVER_RECEIVED or at < before.sampled_at:
            self._aim = None
            self.following = self._unjudged(feedback)
            return self.following
        # The drive's own quick stop has replaced the set-point: it brakes, whatever was commanded.
        aim = Stop.QUICK_STOP if feedback.power is Power.STOPPED else self._set_point
        if self._aim is None:
            self.following = self._unjudged(feedback)
            self._positions = False
            # Power has just come: the axis may still turn as fast as it was found, on its way to the
            # set-point.
            self._low, self._high = min(feedback.velocity, 0.0), max(feedback.velocity, 0.0)
            self._take(aim)
            return self.following
        if aim != self._aim:
            self._take(aim)
        seconds = to_seconds(at - before.sampled_at)
        self.following = self._judged(feedback, before, seconds)
        self._leave(seconds)
        return self.following

    def _take(self, aim: SetPoint) -> None:
        """Let the range reach to a new aim; one of another kind begins a new range where the axis is."""
        self._aim = aim
        positions = isinstance(aim, Position)
        if positions is not self._positions:
            self._positions = positions
            speed, place = self.following.velocity, self.following.position
            if positions:
                # For as long as its lag it may go on with its present speed.
                further = abs(speed) * self._bounds.lag_s
                self._low, self._high = place - further, place + further
            else:
                self._low, self._high = min(speed, -self._coasts_at), max(speed, self._coasts_at)
        if isinstance(aim, Homed):
            # To either side, and from one to the other whenever its method requires.
            self._goal, self._low, self._high = 0.0, -self._bounds.homing, self._bounds.homing
            return
        self._goal = 0.0 if isinstance(aim, Stop) else aim.value
        self._low, self._high = min(self._low, self._goal), max(self._high, self._goal)

    def _leave(self, seconds: float) -> None:
        """Let the range leave what it has reached to, on the way to its goal."""
        goal, below, above = self._goal, self._goal - self._low, self._high - self._goal
        if (not below and not above) or isinstance(self._aim, Homed):
            return
        # Of a first-order lag the share 1 - exp(-t/T) is gone after t; expm1 keeps the digits of a small t/T.
        share = -math.expm1(-seconds / self._bounds.lag_s)
        ramp = self._bounds.ramp * (self._braking if self._aim is Stop.QUICK_STOP else 1.0)
        reach = (self._bounds.cruise if self._positions else ramp) * seconds
        # The slower of lag and ramp counts: the range must not close faster than a healthy axis follows.
        self._low = goal - below + min(below * share, reach)
        self._high = goal + above - min(above * share, reach)

    def _unjudged(self, feedback: Feedback) -> Tracking:
        at = feedback.sampled_at
        return Tracking(
            set_point=self._set_point,
            changed_at=self._changed_at,
            sampled_at=at,
            obeyed_at=at,
            settled_at=at,
            place_at=at,
            position=feedback.position,
            velocity=feedback.velocity,
        )

    def _judged(self, feedback: Feedback, before: Tracking, seconds: float) -> Tracking:
        low, high, at = self._low, self._high, feedback.sampled_at
        position, velocity = feedback.position, feedback.velocity
        # Equal to the last bit: an encoder that counts shows some noise, one that is off shows none.
        owed, standing = 0.0, position == before.position
        if self._positions:
            does, slack = position, self._bounds.position
            if standing:
                owed = max(low - does, does - high, 0.0)
        else:
            does, slack = velocity, self._bounds.around(low, high)
            if standing and self._aim is not Stop.POWER_OFF:
                # The backlog it has when it is commanded to stop it keeps, until its power is taken: who was
                # well has moved meanwhile.
                owed = before.backlog + max(low, -high, 0.0) * seconds
        obeys = low - slack <= does <= high + slack
        return Tracking(
            self._set_point,
            self._changed_at,
            at,
            at if obeys else before.obeyed_at,
            at if owed <= self._bounds.creep else before.settled_at,
            before.place_at if standing else at,
            position,
            velocity,
            low,
            high,
            not obeys and not self._lags(feedback),
            owed,
            0 if self._turns(velocity) else before.idle + 1,
            standing
            and self._aim is not Stop.POWER_OFF
            and (before.halted or (before.idle < IDLE and owed > self._bounds.creep)),
        )

    def _turns(self, velocity: float) -> bool:
        """Return whether its speed is a good share of the least that its set-points let it have."""
        least = max(self._low, 0.0) or min(self._high, 0.0)
        # The product is positive only where it turns the commanded way; a least speed of 0 proves nothing.
        return not self._positions and velocity * least > 0.0 and abs(velocity) >= TURNS * abs(least)

    def _lags(self, feedback: Feedback) -> bool:
        """Return whether an axis that deviates stays behind: not further, not faster, no other way."""
        speed, slack = feedback.velocity, self._bounds.speed
        if not self._positions:
            slack = self._bounds.around(self._low, self._high)
            # Between standstill and its range it stays behind; beyond it, or backwards, it moves uncommanded.
            return min(self._low, 0.0) - slack <= speed <= max(self._high, 0.0) + slack
        # Beside a range of positions it stays behind as long as it does not move further away from it.
        if feedback.position < self._low:
            return speed >= -slack
        return feedback.position > self._high and speed <= slack


class Followers:
    """All axes of one robot."""

    __slots__ = ("_all",)

    def __init__(self, robot: AnyRobot) -> None:
        self._all: Final = {axis.name: TrackingMonitor(axis, bounds_of(robot, axis)) for axis in robot.axes}

    def on_set_points(self, set_points: Mapping[str, SetPoint], now: Nanoseconds) -> None:
        """Learn what was sent to these axes."""
        for name, set_point in set_points.items():
            self._all[name].on_set_point(set_point, now)

    def saw(self, axes: Mapping[str, Feedback]) -> dict[str, Tracking]:
        """Return each axis's, up to its newest sample."""
        return {name: follower.saw(axes[name]) for name, follower in self._all.items()}
