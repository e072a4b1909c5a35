"""The climber's open-loop maneuvers: the chassis's speed ahead and turn rate are held, no path is kept to.

Cases 1 and 2 of Qualls et al., JAMRIS 10(3), 2016: vertical, horizontal, 45 degrees and a circle. The robot
turns on the spot to where the maneuver begins. From then on its pose gives the heading only, on which, with
the joint's angle, the wheel speeds depend that make the chassis's motion; where the robot goes is measured,
not corrected. The joint does not make it turn round. A circle nose first needs a joint that is flat at its
start, as of a robot that is put on looking round the tank: the angle grows else. Tail first it decays.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import ClassVar, Final

from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry, Paths
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.path_follower import ClimberPathFollower
from firmware_bridge.robots.climber.paths import PATHS, Path, PathLeg
from firmware_bridge.robots.climber.surface import planar_motion
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds

OPEN_LOOP: Final[Mapping[str, Callable[[Paths], Path]]] = MappingProxyType(
    {
        **{f"open_{name}": PATHS[name] for name in ("vertical", "horizontal", "spiral")},
        "open_circle": lambda paths: _circle(paths, 0.0),
        "open_circle_back": lambda paths: _circle(paths, -math.pi / 2.0),
    }
)
"""Maneuvers by the path followers' names: how far, where to, and how much they bend."""
TAIL_FIRST: Final = frozenset({"open_circle_back"})


def _circle(paths: Paths, heading: float) -> Path:
    """Return a circle to the left that begins in this direction."""
    return (PathLeg(math.tau * paths.radius_m, heading, 1.0 / paths.radius_m),)


class OpenLoopFollower(ClimberPathFollower):
    """A `firmware_bridge.robot_type.PathFollower` that holds the chassis's speeds."""

    paths: ClassVar[Mapping[str, Callable[[Paths], Path]]] = OPEN_LOOP

    def __init__(self, robot: Robot[ClimberGeometry], name: str) -> None:
        super().__init__(robot, name)
        self._tail = name in TAIL_FIRST
        self._joint = 0.0

    def command(self, seen: Snapshot[ClimberMotion, ClimberState], elapsed: Nanoseconds) -> ClimberMotion:
        """Return the motion whose wheel speeds give the chassis its speeds."""
        # Without an angle the joint's limit does not let it drive.
        self._joint = seen.body.joint_rad or 0.0
        return super().command(seen, elapsed)

    def _must_turn_round(self, _state: ClimberState) -> bool:
        return False

    def _driven(self, leg: PathLeg, pose: Pose, begin: tuple[float, float], _age: float) -> ClimberMotion:
        if self._way >= leg.length:
            self._next(leg, begin)
            return self._motion(0.0, 0.0)
        speed, turn = -self._rate if self._tail else self._rate, leg.bend * self._rate
        return self._motion(*planar_motion(self._geometry, speed, turn, pose.heading_rad, self._joint))
