"""A trolley on a rail, pulled by a toy drive: a robot type of one axis, which moves along its x."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint, Speed
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot import Robot
from firmware_bridge.robot.table import Positive, Table
from firmware_bridge.robot_type import RobotType
from firmware_bridge.safety.interlock import Limit, View
from firmware_bridge.safety.limits import bounded
from firmware_bridge.teleop.station import StationRows, Stick, Twist, Unusable, Velocity
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

TROLLEY: Final = frozenset({"trolley"})
"""The group of the one axis, and the axis's role."""


class TrolleyLimits(Table):
    """The limits, whatever the operator commands."""

    speed_mps: Positive
    acceleration_mps2: Positive


class Rail(Table):
    """The table `[geometry]` of the robot file."""

    limits: TrolleyLimits


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion, and the state: the speed, forward positive."""

    speed_mps: float = 0.0


class TrolleyKinematics:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    def __init__(self, robot: Robot[Rail]) -> None:
        axis = robot.axis("trolley")
        self.rolling: tuple[str, ...] = (axis.name,)
        self._name = axis.name
        self._moves = axis.standstill_below
        self._acceleration = MARGIN * robot.geometry.limits.acceleration_mps2

    def sensed(self, axes: Mapping[str, Feedback], _sensors: Mapping[str, Reading]) -> Motion:
        """Return the speed."""
        return Motion(axes[self._name].velocity)

    def requested(self, motion: Motion, _state: Motion) -> frozenset[str]:
        """Return the trolley where the motion moves it."""
        return TROLLEY if motion.speed_mps else frozenset()

    def moving(self, state: Motion) -> frozenset[str]:
        """Return the trolley where it is seen to move."""
        return frozenset() if abs(state.speed_mps) < self._moves else TROLLEY

    def at_standstill(self, motion: Motion, groups: frozenset[str]) -> Motion:
        """Return the motion at standstill."""
        return Motion() if groups & TROLLEY else motion

    def ramped(self, commanded: Motion, allowed: Motion, _state: Motion, elapsed: Nanoseconds) -> Motion:
        """Return the next set-point."""
        change = self._acceleration * to_seconds(elapsed)
        step = min(max(allowed.speed_mps - commanded.speed_mps, -change), change)
        return Motion(commanded.speed_mps + step)

    def set_points(self, motion: Motion, _state: Motion) -> Mapping[str, SetPoint]:
        """Return the axis's speed."""
        return {self._name: Speed(motion.speed_mps)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after the trolley has moved."""
        moved = after[self._name].position - before[self._name].position
        return Pose(pose.x_m + moved, pose.y_m, pose.heading_rad)


def _limited(view: View[Rail, Motion, Motion]) -> tuple[Motion, str | None]:
    allowed, reason = bounded(view.allowed.speed_mps, view.geometry.limits.speed_mps, "m/s")
    return Motion(allowed), reason


def _stick(stick: Stick, command: Motion, robot: Robot[Rail]) -> Motion:
    return replace(command, speed_mps=(stick.forward or 0.0) * robot.geometry.limits.speed_mps)


def _target(velocity: Velocity, command: Motion, _robot: Robot[Rail]) -> Motion | Unusable:
    if velocity.left_mps or velocity.yaw_rate_rad_s:
        return Unusable("turns", "this robot moves along its rail only")
    return replace(command, speed_mps=velocity.forward_mps)


def _reach(robot: Robot[Rail]) -> Iterator[tuple[Motion, Motion]]:
    for sign in (-1.0, 1.0):
        yield Motion(sign * robot.geometry.limits.speed_mps), Motion(sign * robot.geometry.limits.speed_mps)


ROBOT_TYPE: Final[RobotType[Rail, Motion, Motion]] = RobotType(
    name="toy_trolley",
    file=Path(__file__).with_name("toy_trolley.toml"),
    geometry=Rail,
    standstill=Motion(),
    numbers={"speed": lambda motion: motion.speed_mps},
    kinematics=TrolleyKinematics,
    groups={"trolley": TROLLEY},
    travelling=TROLLEY,
    interlocks=(),
    limits=(Limit("speed limit", _limited, "reduce the speed", clear_after=300 * MILLISECOND),),
    reach=_reach,
    station=StationRows(
        stick=_stick,
        target=_target,
        twist=lambda state: Twist(state.speed_mps, 0.0, 0.0),
        forgotten=lambda command: command,
        largest=lambda robot: Twist(robot.geometry.limits.speed_mps, 0.0, 0.0),
        stop_button=2,
    ),
)
