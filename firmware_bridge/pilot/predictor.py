"""The robot's pose when the present command reaches it: a Smith predictor over the link.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, 6.1: start from the newest pose that came, its time stamp and
the commands that were sent since, and integrate the model. The dead time is measured: half a round trip up,
and the pose's own age. Where the directions are not equally slow both are off by the same, against each
other, so that the commands still meet the poses which they made.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from firmware_bridge.motion.model import MotionModel, Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds

STEP: Final[Nanoseconds] = 25 * MILLISECOND
KEPT_FOR: Final[Nanoseconds] = 10 * SECOND
"""Longer than any link that is agreed on."""


class SentCommand(NamedTuple):
    """A command, and when it reaches the robot."""

    acts_at: Nanoseconds
    speed_mps: float
    yaw_rate_rad_s: float


class Predictor:
    """One robot's; all instants by the station's own clock."""

    def __init__(self, model: MotionModel) -> None:
        self._model: Final = model
        self._commands: Final[deque[SentCommand]] = deque()
        self._predicted: Final[deque[tuple[Nanoseconds, Pose]]] = deque()
        """Predictions for instants without a received pose yet."""
        self._newest: tuple[Nanoseconds, Moving] | None = None
        self.error_m: float | None = None
        """Distance of the newest pose from the prediction for its instant; None before there is one."""

    def on_command(
        self, sent_at: Nanoseconds, up: Nanoseconds, speed_mps: float, yaw_rate_rad_s: float
    ) -> None:
        """Take note of a command that is sent now and takes so long on its way."""
        self._commands.append(SentCommand(sent_at + up, speed_mps, yaw_rate_rad_s))
        while self._commands[0].acts_at < sent_at - KEPT_FOR:
            self._commands.popleft()

    def seen(self, measured_at: Nanoseconds, moving: Moving) -> None:
        """Take a received pose, and its instant; one that is older than the newest is ignored."""
        # Datagrams may overtake one another.
        if self._newest is not None and measured_at < self._newest[0]:
            return
        self._newest = measured_at, moving
        before = None
        while self._predicted and self._predicted[0][0] <= measured_at:
            before = self._predicted.popleft()
        if before is None:
            return
        if self._predicted or before[0] == measured_at:
            after = self._predicted[0] if self._predicted else before
            reported = _between(before, after, measured_at)
            self.error_m = math.hypot(reported.x_m - moving.pose.x_m, reported.y_m - moving.pose.y_m)
        # Kept, as the next pose may lie between this prediction and the next.
        self._predicted.appendleft(before)

    def at(self, instant: Nanoseconds) -> Moving | None:
        """Return where the robot will be then, and remember it; None before any pose has come."""
        if self._newest is None:
            return None
        now, moving = self._newest
        speed, turn = moving.speed_mps, moving.yaw_rate_rad_s
        coming = deque(self._commands)
        while now < instant:
            while coming and coming[0].acts_at <= now:
                _, speed, turn = coming.popleft()
            # Steps end where a command begins to act, so that none is smeared over a step.
            until = min(now + STEP, instant)
            if coming:
                until = min(until, coming[0].acts_at)
            moving = self._model.step(moving, speed, turn, to_seconds(until - now))
            now = until
        # A prediction for an earlier instant than the last replaces it: the round trip has become shorter.
        while self._predicted and self._predicted[-1][0] >= instant:
            self._predicted.pop()
        self._predicted.append((instant, moving.pose))
        return moving


def _between(before: tuple[Nanoseconds, Pose], after: tuple[Nanoseconds, Pose], at: Nanoseconds) -> Pose:
    share = (at - before[0]) / max(after[0] - before[0], 1)
    old, new = before[1], after[1]
    return Pose(old.x_m + share * (new.x_m - old.x_m), old.y_m + share * (new.y_m - old.y_m))
