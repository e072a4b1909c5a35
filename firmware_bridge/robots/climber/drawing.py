"""The climber from above: its plate, two wheels at its nose, and the caster behind them."""

from typing import Final

from firmware_bridge.motion.outline import Polygon, box, wheel
from firmware_bridge.robot import Robot
from firmware_bridge.robot_drawing import Drawing
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberState


def above(robot: Robot[ClimberGeometry]) -> tuple[Polygon, ...]:
    """Return the plate, the wheels and the caster; the pose is that of the axle's middle."""
    base, long = robot.geometry.base, robot.geometry.wall.length_m
    radius, half = base.wheel_radius_m, base.track_m / 2.0
    plate = box(-long / 2.0, 0.0, long + radius, base.track_m)
    return plate, wheel(0.0, half, radius), wheel(0.0, -half, radius), wheel(-long, 0.0, radius / 2.0)


DRAWING: Final[Drawing[ClimberGeometry, ClimberState]] = Drawing(above)
