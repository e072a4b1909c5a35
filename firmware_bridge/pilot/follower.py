"""Drives along a path by pure pursuit, by what the link brings or by what a predictor makes of it."""

import math
from collections import deque
from collections.abc import Callable
from typing import Final

from firmware_bridge.motion.model import Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import NEUTRAL, Sight, Target
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.paths import Path, PathError
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.pilot.pursuit import Pursuit
from firmware_bridge.units import SECOND, Nanoseconds

BLIND_AFTER: Final[Nanoseconds] = 2 * SECOND
"""Time without sight of the robot after which a follower stops."""
STANDSTILL_MPS: Final = 0.01
STANDSTILL_FOR: Final[Nanoseconds] = 3 * SECOND
"""Time of standstill, beside a round trip, after which a commanded robot counts as held back."""
NEUTRAL_FOR: Final[Nanoseconds] = SECOND
"""Time of a neutral stick then, and after arming, beside a round trip: the robot must see it."""
SLOWEST: Final = 0.1
"""Share of the speed with which it comes to the end of an open path; it slows down over one look-ahead."""
GENTLE: Final = 0.25
"""Share of the robot's tightest curvature up to which it keeps its speed; in tighter arcs the yaw rate stays.

In its tightest turn at full speed a wheeled robot slips, by more than it may leave its path; and what steers
gains the time to follow. It is known as regulated pure pursuit.
"""


class PathDriver:
    """A `firmware_bridge.pilot.driver.Driver`."""

    def __init__(
        self,
        place: Callable[[Pose], Path],
        *,
        speed_mps: float,
        look_ahead_m: float,
        tightest_per_m: float,
        predictor: Predictor | None = None,
        reaction: Nanoseconds = 0,
    ) -> None:
        """Drive where `place` puts the path for a robot that stands at a pose, once it is armed.

        `reaction`: so much later the hand does what was worked out; no predictor knows of it.
        """
        self.predictor: Final = predictor
        self._place: Final = place
        self._speed: Final = speed_mps
        self._look_ahead: Final = look_ahead_m
        self._tightest: Final = tightest_per_m
        self._reaction: Final = reaction
        self._pursuit: Pursuit | None = None
        self._sight: Sight | None = None
        self._coming: Final[deque[tuple[Nanoseconds, Target]]] = deque()
        """Targets that are worked out and not yet commanded."""
        self._does = NEUTRAL
        self._moved_at: Nanoseconds = 0
        """Time when the robot was last seen to move, or without a command to drive."""
        self._neutral_until: Nanoseconds = 0
        self._armed = False
        self.refused = ""
        """The reason why no path leads where it shall; it does not drive then."""
        self.held_back = 0
        """Count of standstills despite a command to drive, since its last motion."""

    @property
    def arrived(self) -> bool:
        """True once it has come to the end of an open path."""
        return self._pursuit is not None and self._pursuit.ended

    def sees(self, sight: Sight) -> None:
        """Take a pose that has come."""
        self._sight = sight
        if abs(sight.moving.speed_mps) > STANDSTILL_MPS:
            self._moved_at, self.held_back = sight.received_at, 0
        if self.predictor is not None and sight.measured_at is not None:
            self.predictor.seen(sight.measured_at, sight.moving)

    def command(self, link: PilotLink, now: Nanoseconds, *, armed: bool) -> Target:
        """Return what leads along the path."""
        trip = link.round_trip(now) or 0
        if armed and not self._armed:
            # Who armed it sees it stand, and then drive off.
            self._neutral_until = now + NEUTRAL_FOR + trip
        self._armed = armed
        worked_out = self._worked_out(trip, now) if armed else NEUTRAL
        self._coming.append((now + self._reaction, worked_out))
        while self._coming and self._coming[0][0] <= now:
            self._does = self._coming.popleft()[1]
        command = self._neutral_first(self._does, trip, now)
        if self.predictor is not None:
            # Half a round trip is the way up, as long as both directions are equally slow.
            self.predictor.on_command(now, trip // 2, command.speed_mps, command.yaw_rate_rad_s)
        return command

    def _worked_out(self, trip: Nanoseconds, now: Nanoseconds) -> Target:
        if self._sight is None or now - self._sight.received_at > BLIND_AFTER:
            return NEUTRAL
        seen = self._seen(self._sight, trip, now)
        if seen is None:
            return NEUTRAL
        if self._pursuit is None:
            try:
                path = self._place(self._sight.moving.pose)
            except PathError as error:
                self.refused = str(error)
                return NEUTRAL
            self._pursuit, self.refused = Pursuit(path, self._look_ahead), ""
        bend = self._pursuit.arc(seen.pose).curvature_per_m
        if self._pursuit.ended:
            return NEUTRAL
        # A tighter arc than the robot can drive would only be clipped there, and be predicted wrongly here.
        bend = math.copysign(min(abs(bend), self._tightest), bend)
        speed = self._speed * min(max(self._pursuit.left_m / self._look_ahead, SLOWEST), 1.0)
        if abs(bend) > (gentle := GENTLE * self._tightest):
            speed *= gentle / abs(bend)
        return Target(speed, speed * bend)

    def _seen(self, sight: Sight, trip: Nanoseconds, now: Nanoseconds) -> Moving | None:
        if self.predictor is None:
            return sight.moving
        return self.predictor.at(now + trip // 2)

    def _neutral_first(self, command: Target, trip: Nanoseconds, now: Nanoseconds) -> Target:
        """Put the stick to neutral where the robot is held back, which requires that before it goes on."""
        if command == NEUTRAL or now < self._neutral_until:
            self._moved_at = max(self._moved_at, now)
        elif now - self._moved_at > STANDSTILL_FOR + trip:
            # The bridge requires neutral after an interlock: without this the robot would wait for ever.
            self._neutral_until = now + NEUTRAL_FOR + trip
            self.held_back += 1
        return NEUTRAL if now < self._neutral_until else command
