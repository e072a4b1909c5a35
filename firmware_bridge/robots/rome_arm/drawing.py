"""ROME whole: its base from above, and the arm that stands at the base's middle."""

from typing import Final

from firmware_bridge.motion.outline import Polygon
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing, Point
from firmware_bridge.robots.ar2.drawing import links
from firmware_bridge.robots.rome.drawing import base_above
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.motion import RomeArmState


def above(robot: Robot[RomeArmGeometry]) -> tuple[Polygon, ...]:
    """Return the base's plate and wheels."""
    return base_above(robot.geometry.base.base)


def arm(robot: Robot[RomeArmGeometry], state: RomeArmState) -> tuple[Point, ...]:
    """Return the joints' places above the floor."""
    return links(state.arm.angles, robot.geometry.balance.arm_height_m)


DRAWING: Final[Drawing[RomeArmGeometry, RomeArmState]] = Drawing(above, arm)
