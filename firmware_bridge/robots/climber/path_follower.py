"""The climber's path followers: along a path on the unrolled surface, by the polar law. They give commands.

The law is (27) to (29) of Qualls et al., JAMRIS 10(3), 2016, in the form that is stable (Siegwart and
Nourbakhsh): with rho, alpha and beta the reference in polar coordinates from the robot,

    alpha = atan2(dy, dx) - theta       beta = theta_ref - theta - alpha
    v = k_rho rho                       w = k_alpha alpha + k_beta beta

The print lacks theta in alpha, and its sign of k_beta is the other one. To a reference that stands it comes
asymptotically only, so the reference moves: it is so far ahead of where the robot shall be, along the path's
tangent there, that k_rho rho is the path's speed; where the path goes slower, as at its end, v is less by as
much. What the path itself bends is added to w. At corners the robot turns on the spot. It drives nose first
as it was put on, or tail first, where the caster leads: it turns round where the joint's angle has grown, as
the other way that decays. No one steers a robot whose wheels are coupled, and it does not turn round either.
"""

import math
from collections.abc import Callable, Mapping
from typing import ClassVar, Final

from firmware_bridge.differential.kinematics import ramp_of
from firmware_bridge.motion.captured import Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry, Paths
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.paths import PATHS, Path, PathLeg
from firmware_bridge.robots.climber.surface import placed
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds, to_seconds

TURNED_RAD: Final = math.radians(0.5)
"""A turn on the spot is over so near to its heading; the law does the rest on the way."""
ARRIVED_M: Final = 0.0003
"""A leg is over so near to its end."""
SLOWEST_MPS: Final = 0.0005
"""A path that must brake to less than this is at its end."""
LOOKS: Final = 10
"""A path begins in the mean of so many poses of the robot at standstill: one alone has the cameras' noise."""
SHARE: Final = 0.2
"""Share of the limits' accelerations that a path uses, so that the law can correct."""
TURN_SHARE: Final = 0.5
"""The same of turns on the spot: nothing is steered by them."""


class ClimberPathFollower:
    """A `firmware_bridge.robot_type.PathFollower` along one path."""

    paths: ClassVar[Mapping[str, Callable[[Paths], Path]]] = PATHS
    """By the names that it may be made for."""

    def __init__(self, robot: Robot[ClimberGeometry], name: str) -> None:
        geometry = robot.geometry
        self._geometry: Final = geometry
        self._control: Final = geometry.control
        self._limits: Final = geometry.limits
        self._legs: Final = self.paths[name](geometry.paths)
        self._axes: Final = tuple(axis.name for axis in robot.axes)
        self._ramp: Final = ramp_of(robot)
        self._commanded = 0.0, 0.0
        self._lead: Final = self._control.speed_mps / self._control.k_rho_per_s
        """So far ahead the reference is: at a smaller speed the angles to a nearer one are but noise."""
        self._begin: tuple[float, float] | None = None
        """Start of the leg, m."""
        self._looks: list[tuple[float, float]] = []
        self._leg = 0
        self._turning = True
        self._tail = False
        self._way = 0.0
        """Set-point on the leg, m, and its speed."""
        self._rate = 0.0
        self._done_m = 0.0
        """The legs before this one."""
        self._posed_at: Nanoseconds | None = None
        """Time of the samples whose pose comes next."""

    def reset(self) -> None:
        """Begin from rest again: the robot was held back."""
        self._rate = 0.0

    def command(self, seen: Snapshot[ClimberMotion, ClimberState], elapsed: Nanoseconds) -> ClimberMotion:
        """Return the motion towards where the path is now."""
        located, age = seen.located, self._age(seen)
        self._commanded = seen.commanded.speed_mps, seen.commanded.turn_rad_s
        if located is not None and located.source is Source.UNSEEN:
            return self._motion(0.0, 0.0)
        pose = seen.pose if located is not None else placed(self._geometry, seen.pose)
        if self._begin is None:
            self._looks.append((pose.x_m, pose.y_m))
            if len(self._looks) < LOOKS:
                return self._motion(0.0, 0.0)
            x, y = (sum(look) / LOOKS for look in zip(*self._looks, strict=True))
            self._begin = x, y
        if self._leg == len(self._legs):
            return self._motion(0.0, 0.0)
        leg = self._legs[self._leg]
        stops = self._must_turn_round(seen.body)
        # Only at standstill, to which `_go_on` has brought the set-point before.
        if stops and self._rate == 0.0:
            self._tail, self._turning = not self._tail, True
        if self._turning:
            command = self._turned(leg, pose)
            if command is not None:
                return command
        self._go_on(leg, to_seconds(elapsed), stops=stops)
        return self._driven(leg, pose, self._begin, to_seconds(age))

    def _age(self, seen: Snapshot[ClimberMotion, ClimberState]) -> Nanoseconds:
        """Return how old the pose is: it is carried on behind this, so it is that of the samples before."""
        # The oldest of the samples: the pose is carried on when all of them are there.
        sampled = min(seen.facts.axes[name].sampled_at for name in self._axes)
        age = seen.facts.now - (sampled if self._posed_at is None else self._posed_at)
        self._posed_at = sampled
        return age

    def _must_turn_round(self, state: ClimberState) -> bool:
        """Return whether the joint is turned so far that it is better to turn round, if it can."""
        joint = state.joint_rad
        if joint is None or self._geometry.base.coupled:
            return False
        grown = -joint if self._tail else joint
        return grown >= math.radians(self._geometry.joint.turns_round_deg)

    def _turned(self, leg: PathLeg, pose: Pose) -> ClimberMotion | None:
        """Return the turn on the spot towards the leg; None where it is over, or none is needed."""
        off = self._askew(leg.at(self._way)[2], pose)
        if abs(off) <= TURNED_RAD:
            self._turning = False
            return None
        limits = self._limits
        # The fastest turn from which the rest of the angle is enough to stop.
        braking = math.sqrt(2.0 * TURN_SHARE * limits.turn_acceleration_rad_s2 * abs(off))
        turn = min(self._control.k_alpha_per_s * abs(off), braking, limits.turn_rate_rad_s)
        self._rate = 0.0
        return self._motion(0.0, math.copysign(turn, off))

    def _driven(self, leg: PathLeg, pose: Pose, begin: tuple[float, float], age: float) -> ClimberMotion:
        """Return the polar law's motion towards a reference ahead of where the robot shall be."""
        side = -1.0 if self._tail else 1.0
        # The pose is that of the samples before, of that instant.
        arc, height, heading = leg.at(max(self._way - self._rate * age, 0.0))
        cosine, sine = math.cos(heading), math.sin(heading)
        lead = self._lead
        dx = begin[0] + arc + lead * cosine - pose.x_m
        dy = begin[1] + height + lead * sine - pose.y_m
        # Tail first, the tail is the front: the law sees a robot that is turned by half a turn.
        theta = pose.heading_rad + (math.pi if self._tail else 0.0)
        ahead = dx * math.cos(theta) + dy * math.sin(theta)
        left = dy * math.cos(theta) - dx * math.sin(theta)
        # The reference is never behind: where the robot is too far on, it waits, or goes back straight.
        alpha = math.atan2(left, max(ahead, lead))
        beta = math.remainder(heading - theta - alpha, math.tau)
        control = self._control
        speed = control.k_rho_per_s * (ahead - lead) + self._rate
        turn = control.k_alpha_per_s * alpha + control.k_beta_per_s * beta + leg.bend * self._rate
        if self._way >= leg.length and abs(ahead - lead) <= ARRIVED_M:
            self._next(leg, begin)
            return self._motion(0.0, 0.0)
        return self._motion(side * speed, turn)

    def _go_on(self, leg: PathLeg, seconds: float, *, stops: bool) -> None:
        """Move where the robot shall be on along the leg: as fast as the path may be; at its end it stops.

        It comes to standstill before where it `stops`.
        """
        reach = SHARE * self._limits.acceleration_mps2
        if stops:
            rate = max(self._rate - reach * seconds, 0.0)
            # Trapezoid: the mean of both speeds over the step.
            self._way, self._rate = self._way + 0.5 * (self._rate + rate) * seconds, rate
            return
        left = max(leg.length - self._way, 0.0)
        braking = math.sqrt(2.0 * reach * left)
        fastest = min(self._rate + reach * seconds, self._control.speed_mps, braking)
        step = 0.5 * (self._rate + fastest) * seconds
        if step >= left or braking < SLOWEST_MPS:
            self._way, self._rate = leg.length, 0.0
        else:
            self._way, self._rate = self._way + step, fastest

    def _next(self, leg: PathLeg, begin: tuple[float, float]) -> None:
        """Turn to the next leg, which begins where this one ends."""
        arc, height, _ = leg.at(leg.length)
        self._begin = begin[0] + arc, begin[1] + height
        self._done_m += leg.length
        self._leg, self._way, self._rate, self._turning = self._leg + 1, 0.0, 0.0, True

    def _askew(self, heading: float, pose: Pose) -> float:
        return math.remainder(heading + (math.pi if self._tail else 0.0) - pose.heading_rad, math.tau)

    def _motion(self, speed: float, turn: float) -> ClimberMotion:
        """Return the motion, which is no faster than the robot may be, nor sooner than its ramp allows."""
        limits = self._limits
        command = (
            min(max(speed, -limits.speed_mps), limits.speed_mps),
            min(max(turn, -limits.turn_rate_rad_s), limits.turn_rate_rad_s),
        )
        speed, turn = self._ramp.step(self._commanded, command, self._ramp.longest_step)
        return ClimberMotion(speed, turn, path_s=(self._done_m + self._way) / self._control.speed_mps)
