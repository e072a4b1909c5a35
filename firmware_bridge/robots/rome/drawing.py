"""ROME's base from above: a round plate on three omni wheels, which stand across its radii."""

import math
from typing import Final

from firmware_bridge.motion.omni import ANGLES
from firmware_bridge.motion.outline import Polygon, disc, wheel
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing
from firmware_bridge.robots.rome.geometry import Base, RomeGeometry
from firmware_bridge.robots.rome.motion import RomeState


def base_above(base: Base) -> tuple[Polygon, ...]:
    """Return the plate and the wheels."""
    radius, far = base.wheel_radius_m, base.wheel_distance_m
    wheels = (
        wheel(far * math.cos(angle), far * math.sin(angle), radius, angle + math.pi / 2.0) for angle in ANGLES
    )
    return disc(far), *wheels


def above(robot: Robot[RomeGeometry]) -> tuple[Polygon, ...]:
    """Return the plate and the wheels."""
    return base_above(robot.geometry.base)


DRAWING: Final[Drawing[RomeGeometry, RomeState]] = Drawing(above)
