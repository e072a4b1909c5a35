"""Localization: by odometry alone, or by the sensor that sees the robot, carried on by odometry."""

from collections.abc import Callable, Mapping
from typing import Final, TypeAlias

from firmware_bridge.drivers.driver import Reading, SeenPose
from firmware_bridge.motion.captured import Bounds, Captured, Located, Sight
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds

Unrolled: TypeAlias = Callable[[SeenPose, Pose], Pose]
"""Map from a robot's pose seen in the room, near its assumed one, to the pose on its ground."""


def on_floor(seen: SeenPose, _near: Pose) -> Pose:
    """Return where on the room's floor a robot is."""
    x, y, _ = seen.position
    return Pose(x, y, seen.heading_rad)


class Locating:
    """The robot's pose, of the instant of the newest samples of its axes."""

    def __init__(self, robot: AnyRobot, unrolled: Unrolled = on_floor) -> None:
        self._unrolled: Final = unrolled
        self.odometry = Pose()
        """Pose rolled since the bridge began, or since the origin was set again."""
        self._sensor = ""
        self._captured: Captured | None = None
        if robot.located_by is not None:
            self._sensor, table = robot.located_by
            self._captured = Captured(
                Bounds(table.jump_m, table.jump_rad, table.slips, table.lost_m, table.silent)
            )

    @property
    def pose(self) -> Pose:
        """The pose, as far as it is known."""
        return self.odometry if self._captured is None else self._captured.located.pose

    @property
    def located(self) -> Located | None:
        """Uncertainty of the pose; None where only odometry gives it."""
        return None if self._captured is None else self._captured.located

    def begin_again(self) -> str:
        """Forget the pose, on an operator's command; return the effect as text."""
        if self._captured is None:
            self.odometry = Pose()
            return "the present place is the origin"
        self._captured.begin_again()
        return "the robot is where the cameras see it next"

    def interrupted(self) -> None:
        """Note that odometry is lost: only the sensor can find the pose then."""
        if self._captured is not None:
            self._captured.begin_again()

    def rolled(self, odometry: Pose, at: Nanoseconds, readings: Mapping[str, Reading]) -> None:
        """Take odometry's pose at an instant, and the sensor's last one."""
        self.odometry = odometry
        if self._captured is not None:
            sight = self._sight(readings.get(self._sensor), self._captured.located.pose)
            self._captured.step(odometry, at, sight)

    def _sight(self, reading: Reading | None, near: Pose) -> Sight | None:
        if reading is None or reading.pose is None:
            return None
        return Sight(self._unrolled(reading.pose, near), reading.sampled_at)
