"""From wheels to what the robot does, and from a motion to what the wheels shall do; left is positive."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, ClassVar, Final, Generic, Protocol, TypeAlias, TypeVar

from firmware_bridge.differential.geometry import Geometry
from firmware_bridge.drivers.driver import Feedback, Reading, SetPoint, Speed
from firmware_bridge.motion.differential import DifferentialRamp, twist, wheel_speeds
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Group
from firmware_bridge.units import Nanoseconds

LEFT: Final = "left_wheel"
RIGHT: Final = "right_wheel"
"""The axes, by their roles in the robot file."""
NOTHING: Final[frozenset[Group]] = frozenset()


class Moves(Protocol):
    """A dataclass with speed and turn rate, and what else a package has in it: its motion, or its state."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def speed_mps(self) -> float:
        """Return the speed of the axle's middle, forward positive."""

    @property
    def turn_rad_s(self) -> float:
        """Return the turn rate, to the left positive."""


G = TypeVar("G", bound=Geometry)
M = TypeVar("M", bound=Moves)
S = TypeVar("S", bound=Moves)
Sensors: TypeAlias = Mapping[str, Reading]
Track: TypeAlias = Callable[[Robot[G], Pose, Sensors], float]
"""The track in m by which odometry turns, at a pose."""


def ramp_of(robot: Robot[G]) -> DifferentialRamp:
    """Return the bounds of speed and turn rate."""
    limits = robot.geometry.limits
    return DifferentialRamp(
        MARGIN * limits.acceleration_mps2,
        MARGIN * limits.turn_acceleration_rad_s2,
        limits.sideways_mps2,
        robot.geometry.base.track_m / 2.0,
        robot.cycle,
    )


class DifferentialKinematics(Generic[G, M, S]):
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    __slots__ = ("_group", "_left", "_moves", "_ramp", "_right", "_robot", "_state", "_track", "rolling")

    def __init__(
        self,
        robot: Robot[G],
        group: Group,
        state: Callable[[Robot[G], float, float, Sensors], S],
        moves: tuple[float, float],
        track: "Track[G] | None",
    ) -> None:
        self._robot = robot
        self._group = group
        self._state = state
        self._moves = moves
        self._track = track
        self._ramp = ramp_of(robot)
        self._left = robot.axis(LEFT).name
        self._right = robot.axis(RIGHT).name
        self.rolling: tuple[str, ...] = (self._left, self._right)
        """The axes from whose positions the pose is carried on."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Sensors) -> S:
        """Return the state: speed, turn rate, and the sensors' values."""
        base = self._robot.geometry.base
        speed, turn = twist(base, axes[self._left].velocity, axes[self._right].velocity)
        return self._state(self._robot, speed, turn, sensors)

    def requested(self, motion: M, _state: S) -> frozenset[Group]:
        """Return the wheels where the motion commands the robot to drive or to turn."""
        return frozenset({self._group}) if motion.speed_mps or motion.turn_rad_s else NOTHING

    def moving(self, state: S) -> frozenset[Group]:
        """Return the wheels where the robot is seen to drive or to turn."""
        speed, turn = self._moves
        stands = abs(state.speed_mps) < speed and abs(state.turn_rad_s) < turn
        return NOTHING if stands else frozenset({self._group})

    def at_standstill(self, motion: M, groups: frozenset[Group]) -> M:
        """Return the motion at standstill; what else is in it stays as it is."""
        return replace(motion, speed_mps=0.0, turn_rad_s=0.0) if self._group in groups else motion

    def ramped(self, commanded: M, allowed: M, _state: S, elapsed: Nanoseconds) -> M:
        """Return the next set-point on the way to what is allowed."""
        speed, turn = self._ramp.step(
            (commanded.speed_mps, commanded.turn_rad_s), (allowed.speed_mps, allowed.turn_rad_s), elapsed
        )
        return replace(allowed, speed_mps=speed, turn_rad_s=turn)

    def set_points(self, motion: M, _state: S) -> Mapping[str, SetPoint]:
        """Return both wheels' speeds."""
        left, right = wheel_speeds(self._robot.geometry.base, motion.speed_mps, motion.turn_rad_s)
        return {self._left: Speed(left), self._right: Speed(right)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Sensors,
    ) -> Pose:
        """Return the pose after both wheels rolled on."""
        left, right = (after[name].position - before[name].position for name in self.rolling)
        base = self._robot.geometry.base
        # Slip makes the effective track another one than the built one, so a package may give it.
        track = base.track_m if self._track is None else self._track(self._robot, pose, sensors)
        return moved(pose, left * base.wheel_radius_m, right * base.wheel_radius_m, track)
