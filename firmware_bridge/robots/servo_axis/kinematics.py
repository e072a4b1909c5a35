"""The axis's kinematic model: a speed on its ramp, or a target that travels at the speed, near the axis."""

from collections.abc import Iterator, Mapping
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Position, Reading, SetPoint, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import CommandForm, Robot
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.units import Nanoseconds, to_seconds

AXIS: Final = "axis"
"""Its role, and the group of its own."""
GROUPS: Final = {AXIS: frozenset({AXIS})}
NOTHING: Final[frozenset[str]] = frozenset()
MOVES: Final = 0.02
"""Share of its limit from which it counts as moving."""
ARRIVED: Final = 2e-3
"""Seconds at the limit: an axis this near to its target has arrived; it holds it, and does not move."""
LEASH_S: Final = 0.25
"""Largest lead of the target, in seconds at the limit: one far ahead would be gone to after a stop."""
NEAR_TOP: Final = 0.999
"""Share of the axis's top speed that is used: set-points are whole numbers of the drive's."""


class ServoAxisKinematics:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    __slots__ = ("_by_position", "_limits", "_name", "_top", "_travel", "rolling")

    def __init__(self, robot: Robot[AxisGeometry]) -> None:
        axis = robot.axis(AXIS)
        self._name: Final = axis.name
        self._by_position: Final = axis.command is CommandForm.POSITION
        self._limits: Final = robot.geometry.limits
        self._top: Final = min(robot.geometry.limits.speed, NEAR_TOP * axis.top_speed)
        self._travel: Final = axis.travel
        self.rolling: tuple[str, ...] = (axis.name,)
        """It rests when it does not move; its pose stays, as its foot does."""

    def sensed(self, axes: Mapping[str, Feedback], _sensors: Mapping[str, Reading]) -> AxisState:
        """Return where the axis is, and how fast."""
        seen = axes[self._name]
        # Before the first report the position is 0 by default, which is not a measured one.
        return AxisState(None if seen.received_at == NEVER_RECEIVED else seen.position, seen.velocity)

    def requested(self, motion: AxisMotion, state: AxisState) -> frozenset[str]:
        """Return the axis where the motion commands it to move."""
        if motion.target is None:
            return NOTHING if motion.speed == 0.0 else frozenset({AXIS})
        near = ARRIVED * self._limits.speed
        # Written so that NaN counts as a motion.
        there = state.position is not None and abs(motion.target - state.position) <= near
        return NOTHING if there else frozenset({AXIS})

    def moving(self, state: AxisState) -> frozenset[str]:
        """Return the axis where it is seen to move."""
        return NOTHING if abs(state.speed) <= MOVES * self._limits.speed else frozenset({AXIS})

    def at_standstill(self, motion: AxisMotion, groups: frozenset[str]) -> AxisMotion:
        """Return the motion at standstill."""
        return AxisMotion() if AXIS in groups else motion

    def ramped(
        self, commanded: AxisMotion, allowed: AxisMotion, state: AxisState, elapsed: Nanoseconds
    ) -> AxisMotion:
        """Return the next set-point: the speed on its ramp, and a target near the axis that goes with it."""
        seconds, position = to_seconds(elapsed), state.position
        wanted = min(max(allowed.speed, -self._top), self._top)
        step = self._limits.acceleration * seconds
        speed = min(max(wanted, commanded.speed - step), commanded.speed + step)
        if not self._by_position:
            return AxisMotion(speed)
        # The drive's own halt is a ramp: a target that went on would be gone to after a stop.
        if position is None or (allowed.target is None and allowed.speed == 0.0):
            return AxisMotion()
        start = position if commanded.target is None else commanded.target
        if allowed.target is None:
            target = start + speed * seconds
        else:
            reach = abs(speed) * seconds
            target = min(max(allowed.target, start - reach), start + reach)
        leash = self._limits.speed * LEASH_S
        target = min(max(target, position - leash), position + leash)
        low, high = self._travel or (target, target)
        return AxisMotion(speed, min(max(target, low), high))

    def set_points(self, motion: AxisMotion, _state: AxisState) -> Mapping[str, SetPoint]:
        """Return the axis's set-point; one that shall stay rests."""
        if not self._by_position:
            return {self._name: Speed(motion.speed)}
        return {} if motion.target is None else {self._name: Position(motion.target)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose, in which the foot stays."""
        del before, after, sensors
        return pose


def reach(robot: Robot[AxisGeometry]) -> Iterator[tuple[AxisMotion, AxisState]]:
    """Yield full speed both ways, or both ends of the travel."""
    speed = robot.geometry.limits.speed
    axis = robot.axis(AXIS)
    if axis.command is CommandForm.SPEED:
        for one in (-speed, speed):
            yield AxisMotion(one), AxisState(0.0, one)
        return
    for end in axis.travel or ():
        yield AxisMotion(speed, end), AxisState(end, 0.0)
