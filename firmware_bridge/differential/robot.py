"""Robot type with two driven wheels on an axle: its kinematic model, its interlocks and its MAVLink rows."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Final, Generic

from firmware_bridge import renamed
from firmware_bridge.differential.kinematics import (
    LEFT,
    RIGHT,
    DifferentialKinematics,
    G,
    M,
    S,
    Sensors,
    Track,
    ramp_of,
)
from firmware_bridge.motion.differential import fastest_in_turn
from firmware_bridge.motion.outline import Polygon, box, wheel
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing
from firmware_bridge.safety.interlock import Interlock, Limit, View
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.limits import bounded
from firmware_bridge.safety.snapshot import Group, Snapshot
from firmware_bridge.teleop.station import Fixed, Stick, Twist, Unusable, Value, Velocity
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
SPEED_TOLERANCE: Final = 1e-4
"""A step that the ramp shortens by less, in m/s or rad/s, is not reported."""


def above(robot: Robot[G]) -> tuple[Polygon, ...]:
    """Return a plate and two wheels; how far the plate goes behind them is assumed."""
    base = robot.geometry.base
    radius, track = base.wheel_radius_m, base.track_m
    plate = box(-track / 2.0, 0.0, track + 2.0 * radius, track)
    return plate, wheel(0.0, track / 2.0, radius), wheel(0.0, -track / 2.0, radius)


class DifferentialRobot(Generic[G, M, S]):
    """The common part of all robots of one type; a `RobotType` is made of its attributes and methods."""

    def __init__(
        self,
        motion: Callable[[float, float], M],
        state: Callable[[Robot[G], float, float, Sensors], S],
        *,
        group: Group = "base",
        moves_mps: float = 0.010,
        turns_rad_s: float = 0.030,
        spin: float = 1.25,
        track: "Track[G] | None" = None,
    ) -> None:
        """Take the type's own parts.

        `motion` and `state` make M and S of speed and turn rate, the latter of sensors, too. Below
        `moves_mps` and `turns_rad_s` the robot counts as at standstill. One that turns `spin` times faster
        than its limit turns without a command. `track` is the one from wheel to wheel unless given.
        """
        self._motion, self._state, self._moves, self._track = motion, state, (moves_mps, turns_rad_s), track
        self._group = group
        self.spin: Final = spin
        self.groups: Final[Mapping[Group, frozenset[str]]] = {group: frozenset({LEFT, RIGHT})}
        """The axes, by their roles in the robot file, that stop together."""
        self.travelling: Final = frozenset({group})
        self.numbers: Final[Mapping[str, Callable[[M], float | None]]] = {
            "speed": lambda motion: motion.speed_mps,
            "turn rate": lambda motion: motion.turn_rad_s,
        }
        self.drawing: Final[Drawing[G, S]] = Drawing(above)
        self.turns_too_fast: Final[Interlock[G, M, S]] = Interlock(
            "turns too fast",
            self._turns_too_fast,
            "look for a wheel that slips or a drive that runs away, then arm",
            clear_after=CLEARS_AFTER,
            severity=Severity.CRITICAL,
            disarms=True,
        )
        self.speed_limit: Final = self._limit("speed limit", self._speed, "reduce the speed")
        self.turn_rate_limit: Final = self._limit("turn rate limit", self._turn, "turn more slowly")
        self.sideways_limit: Final = self._limit(
            "sideways limit", self._sideways, "reduce turn rate or speed"
        )
        self.acceleration_limit: Final = self._limit(
            "acceleration limit", self._acceleration, "change speed and turn more slowly", Severity.INFO
        )
        self.limits: Final = (
            self.speed_limit,
            self.turn_rate_limit,
            self.sideways_limit,
            self.acceleration_limit,
        )
        """Applied in this order; a later one sees what an earlier one left."""
        self.turn_value: Final[Value[M, S]] = Value("TURN", SECOND // 10, _turn_deg_s, "deg/s, left positive")
        self.parameters: Final[tuple[Fixed[G], ...]] = (
            Fixed("WHEEL_R", self.meters_rolled, "m"),
            Fixed("TRACK", lambda robot: robot.geometry.base.track_m, "m"),
            Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
            Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
            Fixed("TURN_MAX", lambda robot: robot.geometry.limits.turn_rate_rad_s, "rad/s"),
        )

    def kinematics(self, robot: Robot[G]) -> DifferentialKinematics[G, M, S]:
        """Return the kinematic model of one robot."""
        return DifferentialKinematics(robot, self._group, self._state, self._moves, self._track)

    @property
    def body(self) -> Callable[[Robot[G]], DifferentialKinematics[G, M, S]]:
        """The old name of `kinematics`."""
        renamed.warn("body", "kinematics", "DifferentialRobot")
        return self.kinematics

    def reach(self, robot: Robot[G]) -> Iterator[tuple[M, S]]:
        """Yield the fastest motions: ahead, on the spot, and in the turn that pulls sideways at the limit."""
        limits = robot.geometry.limits
        # The last one is where full speed and turn rate just reach the sideways limit.
        for turn in (0.0, limits.turn_rate_rad_s, limits.sideways_mps2 / limits.speed_mps):
            turned = min(turn, limits.turn_rate_rad_s)
            # In the tightest turn the sideways limit, not the speed limit, is what bounds the speed.
            speed = min(limits.speed_mps, fastest_in_turn(turned, limits.sideways_mps2))
            for forward in (-speed, speed):
                for side in (-turned, turned):
                    yield self._motion(forward, side), self._state(robot, forward, side, {})

    def slowed(self, view: View[G, M, S], share: float) -> tuple[M, str | None]:
        """Clip the speed to a share of its top; turning takes the robot nowhere."""
        allowed, reason = bounded(view.allowed.speed_mps, share * view.geometry.limits.speed_mps, "m/s")
        return replace(view.allowed, speed_mps=allowed), reason

    def stick(self, stick: Stick, command: M, robot: Robot[G]) -> M:
        """Return the command for a stick: full stick is a limit; with `r` unused `y` turns."""
        limits = robot.geometry.limits
        # A stick without a rudder axis steers with its sideways one.
        side = stick.left if stick.turn is None else stick.turn
        return replace(
            command,
            speed_mps=(stick.forward or 0.0) * limits.speed_mps,
            turn_rad_s=(side or 0.0) * limits.turn_rate_rad_s,
        )

    def target(self, velocity: Velocity, command: M, _robot: Robot[G]) -> M | Unusable:
        """Return the command for a velocity along the robot and a turn rate."""
        if velocity.left_mps != 0.0:
            return Unusable("sideways", "this robot moves forward and backward only")
        return replace(command, speed_mps=velocity.forward_mps, turn_rad_s=velocity.yaw_rate_rad_s or 0.0)

    def twist(self, state: S) -> Twist:
        """Return how the axle's middle moves."""
        return Twist(state.speed_mps, 0.0, state.turn_rad_s)

    def largest(self, robot: Robot[G]) -> Twist:
        """Return the limits."""
        return Twist(robot.geometry.limits.speed_mps, 0.0, robot.geometry.limits.turn_rate_rad_s)

    def meters_rolled(self, robot: Robot[G]) -> float:
        """Return the wheels' radius."""
        return robot.geometry.base.wheel_radius_m

    def metres_rolled(self, robot: Robot[G]) -> float:
        """Return the same under its name of the release before."""
        renamed.warn("metres_rolled", "meters_rolled", "DifferentialRobot")
        return self.meters_rolled(robot)

    def _limit(
        self,
        name: str,
        clip: Callable[[View[G, M, S]], tuple[M, str | None]],
        remedy: str,
        severity: Severity = Severity.WARNING,
    ) -> Limit[G, M, S]:
        return Limit(name, clip, remedy, clear_after=CLEARS_AFTER, severity=severity)

    def _turns_too_fast(self, view: View[G, M, S]) -> str | None:
        limit = view.geometry.limits.turn_rate_rad_s
        turn = view.body.turn_rad_s
        # Trips above a multiple of the limit and clears at the limit itself, so that it does not flicker.
        if abs(turn) <= (limit if view.was_active else self.spin * limit):
            return None
        return f"the robot turns with {turn:.2f} rad/s, limit {limit:.2f} rad/s"

    def _speed(self, view: View[G, M, S]) -> tuple[M, str | None]:
        return self.slowed(view, 1.0)

    def _turn(self, view: View[G, M, S]) -> tuple[M, str | None]:
        allowed, reason = bounded(view.allowed.turn_rad_s, view.geometry.limits.turn_rate_rad_s, "rad/s")
        return replace(view.allowed, turn_rad_s=allowed), reason

    def _sideways(self, view: View[G, M, S]) -> tuple[M, str | None]:
        fastest = fastest_in_turn(view.allowed.turn_rad_s, view.geometry.limits.sideways_mps2)
        allowed, reason = bounded(view.allowed.speed_mps, fastest, "m/s")
        return replace(view.allowed, speed_mps=allowed), reason

    def _acceleration(self, view: View[G, M, S]) -> tuple[M, str | None]:
        """Clip nothing, the ramp does; say where it will take more than one cycle."""
        commanded, requested = view.seen.commanded, view.allowed
        speed, turn = ramp_of(view.robot).step(
            (commanded.speed_mps, commanded.turn_rad_s),
            (requested.speed_mps, requested.turn_rad_s),
            view.robot.cycle,
        )
        if (
            abs(requested.speed_mps - speed) <= SPEED_TOLERANCE
            and abs(requested.turn_rad_s - turn) <= SPEED_TOLERANCE
        ):
            return requested, None
        return requested, (
            f"requested a step from {commanded.speed_mps:.2f} m/s and {commanded.turn_rad_s:.2f} rad/s "
            f"to {requested.speed_mps:.2f} m/s and {requested.turn_rad_s:.2f} rad/s at once"
        )


def _turn_deg_s(seen: Snapshot[M, S]) -> float:
    return math.degrees(seen.body.turn_rad_s)
