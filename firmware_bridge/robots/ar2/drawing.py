"""The arm AR2: its foot from above, and its links."""

from typing import Final

from firmware_bridge.motion.outline import Polygon, disc
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing, Point
from firmware_bridge.robots.ar2.arm import AR2, SHOULDER_M
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.motion import Ar2State


def links(angles: tuple[float, ...], foot_m: float = 0.0) -> tuple[Point, ...]:
    """Return the joints' places for their angles in rad, from the foot, at this height in m, to the tool."""
    places = (frame[:3, 3] for frame in AR2.frames(angles))
    return tuple((float(x), float(y), float(z) + foot_m) for x, y, z in places)


def above(_robot: Robot[Ar2Geometry]) -> tuple[Polygon, ...]:
    """Return the foot."""
    return (disc(SHOULDER_M),)


def arm(_robot: Robot[Ar2Geometry], state: Ar2State) -> tuple[Point, ...]:
    """Return the joints' places."""
    return links(state.angles)


DRAWING: Final[Drawing[Ar2Geometry, Ar2State]] = Drawing(above, arm)
