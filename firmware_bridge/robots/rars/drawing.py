"""RARS from above: its plate, two wheels on the rear axle, two that steer."""

from typing import Final

from firmware_bridge.motion.outline import WIDTH, Polygon, box, wheel
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsState


def above(robot: Robot[RarsGeometry]) -> tuple[Polygon, ...]:
    """Return the plate and the wheels; the pose is that of the rear axle's middle."""
    base = robot.geometry.base
    radius, long = base.wheel_radius_m, base.wheelbase_m
    plate = box(long / 2.0, 0.0, long + 2.0 * radius, 2.0 * base.half_support_width_m - WIDTH * radius)
    # The support of 2.3.1 ends at the front wheels' contacts.
    axles = ((0.0, base.rear_track_m / 2.0), (long, base.half_support_width_m))
    return plate, *(wheel(x, side * half, radius) for x, half in axles for side in (1.0, -1.0))


DRAWING: Final[Drawing[RarsGeometry, RarsState]] = Drawing(above)
