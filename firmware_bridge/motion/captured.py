"""A robot's pose on its plane by two sources: cameras that see it, and odometry that carries it on.

A captured pose is accepted where odometry expects the robot, and odometry's motion since that instant is
added to it; so the delay of the cameras is no error, and a robot that is hidden goes on by odometry alone.
The possible error of that grows with the distance rolled; beyond a bound the robot is lost, and must stop. A
pose elsewhere than expected is refused: markers that were taken for others. The first of all has no
expectation, and is accepted when those after it agree; a pose that is wrong all the time is accepted wrongly.
It knows no camera and no wheel.
"""

import math
from collections import deque
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds
from firmware_bridge.value import valueclass

REMEMBERED: Final[Nanoseconds] = SECOND
"""A captured pose older than this is put upon nothing any more, and refused."""

AGREE: Final = 3
"""Number of agreeing poses for a first one: a single one may be of markers taken for others."""


class Source(StrEnum):
    """Source of the pose."""

    UNSEEN = "the cameras have not seen the robot yet"
    CAPTURED = "captured"
    ODOMETRY = "odometry"
    """The cameras do not see it, or not where it can be."""
    LOST = "lost"
    """Odometry alone may be wrong by more than the bound."""


SLIPS_OVER: Final[Nanoseconds] = SECOND // 2
"""Time over which slip is averaged: a motor that lags behind its set-point does not slip."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of their difference, and of the time for which one may stand for both."""

    jump_m: float
    """Largest distance of an accepted pose from the expected one, beside odometry's possible error."""
    jump_rad: float
    """The same of its heading; what odometry may be wrong by adds no more than as much again."""
    slips: float
    """The share of the way, and of the turn, by which odometry may be wrong."""
    lost_m: float
    """Odometry alone may be wrong by so much before the robot is lost."""
    silent: Nanoseconds
    """A captured pose that is older does not show that the robot is seen."""


@valueclass(frozen=True, slots=True)
class Sight:
    """A captured pose, and the instant that it shows."""

    pose: Pose
    at: Nanoseconds


@valueclass(frozen=True, slots=True)
class Located:
    """The robot's pose, and its uncertainty."""

    pose: Pose
    """In the cameras' axes, and as old as the odometry; its heading is not wrapped. Zero while unseen."""
    source: Source
    uncertain_m: float
    """Possible error of odometry since the last accepted captured pose."""
    off_m: float
    """Distance of the newest captured pose from odometry's expectation: slip, or a jump."""
    off_rad: float
    refused: int
    """Captured poses in a row that were refused; 0 where the newest was accepted."""
    slip_mps: float = 0.0
    """Speed relative to odometry: the mean over accepted poses."""

    @property
    def reason(self) -> str | None:
        """The reason why the robot must not go on, as text; None where it may."""
        if self.source is Source.UNSEEN:
            return self.source.value
        if self.source is not Source.LOST:
            return None
        seen = (
            f"they show it {self.off_m:.2f} m and {math.degrees(abs(self.off_rad)):.0f} degrees off"
            if self.refused
            else "they do not see it"
        )
        return f"the place is off by {self.uncertain_m:.3f} m at most without the cameras: {seen}"


class Captured:
    """The two witnesses put together; `located` is the newest answer."""

    def __init__(self, bounds: Bounds) -> None:
        self._bounds: Final = bounds
        self._rolled: deque[tuple[Nanoseconds, Pose]] = deque()
        """Odometry's poses, oldest first."""
        self._anchor: tuple[Pose, Pose] | None = None
        """The pose that was accepted last, with odometry's pose at that instant."""
        self._first: tuple[Pose, Pose] | None = None
        """The same of a pose that is not accepted yet: as long as there is no other."""
        self._agreed = 0
        """Captured poses in a row that show the robot where that one, carried on, has it."""
        self._believed_at: Nanoseconds = 0
        self._newest_at: Nanoseconds = -1
        """Instant of the newest captured pose."""
        self._slip: tuple[float, ...] = (0.0, 0.0)
        """m/s in the cameras' axes."""
        self._way_m = 0.0
        """Rolled since the anchor."""
        self._turn_rad = 0.0
        self.located = Located(Pose(), Source.UNSEEN, 0.0, 0.0, 0.0, 0)

    def begin_again(self) -> None:
        """Forget the pose: captured poses are accepted, wherever they are, once some agree.

        For an operator who has looked: a robot that was carried elsewhere is refused for ever without it.
        """
        self._anchor = self._first = None
        self._slip = (0.0, 0.0)
        self.located = replace(self.located, source=Source.UNSEEN, uncertain_m=0.0, slip_mps=0.0)

    def step(self, odometry: Pose, at: Nanoseconds, sight: Sight | None) -> Located:
        """Return the robot's pose at `at`, the instant of this odometry; a second call returns the same.

        `sight` is the newest captured pose, also one that was given before; None where none is known.
        """
        self._carry_on(odometry, at)
        if sight is not None and sight.at > self._newest_at:
            self._newest_at = sight.at
            self._judge(sight, at)
        self.located = self._located(odometry, at)
        return self.located

    def _carry_on(self, odometry: Pose, at: Nanoseconds) -> None:
        rolled = self._rolled
        # The same samples again.
        if rolled and rolled[-1][0] >= at:
            return
        if rolled:
            before = rolled[-1][1]
            self._way_m += math.hypot(odometry.x_m - before.x_m, odometry.y_m - before.y_m)
            self._turn_rad += abs(odometry.heading_rad - before.heading_rad)
        rolled.append((at, odometry))
        while rolled[0][0] < at - REMEMBERED:
            rolled.popleft()

    def _judge(self, sight: Sight, now: Nanoseconds) -> None:
        """Believe a captured pose, or refuse it."""
        located = self.located
        numbers = all(map(math.isfinite, (sight.pose.x_m, sight.pose.y_m, sight.pose.heading_rad)))
        # Odometry's pose of that instant is not remembered any more.
        if sight.at < now - REMEMBERED or not numbers:
            self._refuse(located.off_m, located.off_rad)
            return
        then = self._odometry_at(sight.at)
        off_m = off_rad = 0.0
        heading = sight.pose.heading_rad
        if self._anchor is not None:
            expected = _carried(*self._anchor, then)
            off = sight.pose.x_m - expected.x_m, sight.pose.y_m - expected.y_m
            off_m = math.hypot(*off)
            # The cameras' heading is known up to whole turns; the difference is that of the nearest one.
            off_rad = math.remainder(heading - expected.heading_rad, math.tau)
            heading = expected.heading_rad + off_rad
            bounds = self._bounds
            # No further than a robot that is not lost can be: else any jump would be accepted in the end.
            far_m = bounds.jump_m + min(self._uncertain_m(), bounds.lost_m)
            far_rad = bounds.jump_rad + min(bounds.slips * self._turn_rad, bounds.jump_rad)
            if off_m > far_m or abs(off_rad) > far_rad:
                self._refuse(off_m, off_rad)
                return
            self._slip = self._slipped(off, sight.at - self._believed_at)
        seen = Pose(sight.pose.x_m, sight.pose.y_m, heading), then
        if self._anchor is None and not self._agrees(*seen):
            return
        self._anchor = seen
        self._believed_at = sight.at
        # What was rolled so far is part of this pose, so the possible error begins again at 0.
        self._way_m = self._turn_rad = 0.0
        self.located = replace(
            located, off_m=off_m, off_rad=off_rad, refused=0, slip_mps=math.hypot(*self._slip)
        )

    def _agrees(self, pose: Pose, then: Pose) -> bool:
        """Return whether enough poses in a row, odometry put upon them, have shown the robot here."""
        bounds, first = self._bounds, self._first
        self._first = pose, then
        if first is None:
            self._agreed = 1
            return False
        expected = _carried(*first, then)
        off_m = math.hypot(pose.x_m - expected.x_m, pose.y_m - expected.y_m)
        off_rad = math.remainder(pose.heading_rad - expected.heading_rad, math.tau)
        near = off_m <= bounds.jump_m and abs(off_rad) <= bounds.jump_rad
        self._agreed = self._agreed + 1 if near else 1
        return self._agreed >= AGREE

    def _refuse(self, off_m: float, off_rad: float) -> None:
        refused = self.located.refused + 1
        self.located = replace(self.located, off_m=off_m, off_rad=off_rad, refused=refused)

    def _slipped(self, off: tuple[float, float], elapsed: Nanoseconds) -> tuple[float, ...]:
        """Return the mean slip after so much of it in a time."""
        seconds = to_seconds(elapsed)
        # A mean with a time constant, however far apart two poses are.
        share = -math.expm1(-elapsed / SLIPS_OVER)
        x, y = self._slip
        return x + share * (off[0] / seconds - x), y + share * (off[1] / seconds - y)

    def _located(self, odometry: Pose, now: Nanoseconds) -> Located:
        was = self.located
        if self._anchor is None:
            return was
        uncertain = self._uncertain_m()
        source = Source.CAPTURED
        if now - self._believed_at > self._bounds.silent:
            # What is lost stays lost until it is seen: standing still makes nothing more certain.
            source = Source.LOST if uncertain > self._bounds.lost_m else Source.ODOMETRY
        pose = _carried(*self._anchor, odometry)
        return replace(was, pose=pose, source=source, uncertain_m=uncertain)

    def _uncertain_m(self) -> float:
        """Return what odometry may be wrong by: its share of the way, and the way in a wrong direction."""
        return self._bounds.slips * self._way_m * (1.0 + self._turn_rad)

    def _odometry_at(self, at: Nanoseconds) -> Pose:
        """Return odometry's pose at an instant: between two samples, or on from the last two."""
        rolled = self._rolled
        later = len(rolled) - 1
        # Backwards, as a captured pose is mostly a few samples old.
        while later > 1 and rolled[later - 1][0] >= at:
            later -= 1
        if later < 1:
            return rolled[later][1]
        (since, before), (until, after) = rolled[later - 1], rolled[later]
        # Above 1 the motion of the last two samples goes on; before the oldest sample nothing is known.
        share = max((at - since) / (until - since), 0.0)
        return Pose(
            before.x_m + share * (after.x_m - before.x_m),
            before.y_m + share * (after.y_m - before.y_m),
            before.heading_rad + share * (after.heading_rad - before.heading_rad),
        )


def _carried(seen: Pose, then: Pose, now: Pose) -> Pose:
    """Return a seen pose carried on by what odometry went from `then` until `now`."""
    # The turn between odometry's axes and the cameras', which odometry's heading knows nothing of.
    turn = seen.heading_rad - then.heading_rad
    ahead, left = now.x_m - then.x_m, now.y_m - then.y_m
    cosine, sine = math.cos(turn), math.sin(turn)
    return Pose(
        seen.x_m + cosine * ahead - sine * left,
        seen.y_m + sine * ahead + cosine * left,
        now.heading_rad + turn,
    )
