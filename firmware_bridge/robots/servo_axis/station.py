"""The axis's rows on MAVLink: jog by stick or velocity, a target by an actuator, and its telemetry.

Full stick ahead is the speed limit; the share of an actuator is the share of the travel. An axis's unit takes
the place of the meter. Button 2 is the emergency stop.
"""

from typing import Final

from firmware_bridge.robot import CommandForm, Robot
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.kinematics import AXIS
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.teleop.station import (
    Actuator,
    Fixed,
    Place,
    StationRows,
    Stick,
    StickAxis,
    Twist,
    Unusable,
    Value,
    Velocity,
)
from firmware_bridge.units import SECOND


def of_stick(stick: Stick, command: AxisMotion, robot: Robot[AxisGeometry]) -> AxisMotion:
    """Return the command for a stick; a stick at rest leaves the target as it is."""
    if not stick.forward:
        return AxisMotion() if command.target is None else command
    return AxisMotion(stick.forward * robot.geometry.limits.speed)


def of_velocity(
    velocity: Velocity, _command: AxisMotion, _robot: Robot[AxisGeometry]
) -> AxisMotion | Unusable:
    """Return the command for a velocity, which an axis has in one direction."""
    if velocity.left_mps or velocity.yaw_rate_rad_s:
        return Unusable("direction", "one axis goes forward and back, with x of the velocity")
    return AxisMotion(velocity.forward_mps)


def of_place(place: Place, _command: AxisMotion, robot: Robot[AxisGeometry]) -> AxisMotion | Unusable:
    """Return the command for a place, which an axis by position goes to."""
    if robot.axis(AXIS).command is CommandForm.SPEED:
        return Unusable("place", "an axis that is commanded by speed goes to no place")
    return AxisMotion(robot.geometry.limits.speed, place.x)


def _sent_to(command: AxisMotion, share: float, robot: Robot[AxisGeometry]) -> AxisMotion:
    travel = robot.axis(AXIS).travel
    if travel is None:
        return command
    low, high = travel
    return AxisMotion(robot.geometry.limits.speed, low + share * (high - low))


def _largest(robot: Robot[AxisGeometry]) -> Twist:
    speed = robot.geometry.limits.speed
    return Twist(speed, speed, 1.0)


def _end(number: int, robot: Robot[AxisGeometry]) -> float:
    travel = robot.axis(AXIS).travel
    return 0.0 if travel is None else travel[number]


STATION: Final[StationRows[AxisGeometry, AxisMotion, AxisState]] = StationRows(
    stick=of_stick,
    target=of_velocity,
    place=of_place,
    twist=lambda _state: Twist(0.0, 0.0, 0.0),
    forgotten=lambda _command: AxisMotion(),
    largest=_largest,
    stop_button=2,
    axes=(StickAxis.FORWARD,),
    actuators=(Actuator("axis", _sent_to),),
    values=(
        Value("POS", SECOND // 10, lambda seen: seen.body.position, "the axis's position, in its unit"),
        Value("SPEED", SECOND // 10, lambda seen: seen.body.speed, "its speed, in its unit a second"),
    ),
    parameters=(
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed, "1/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration, "1/s2"),
        Fixed("POS_MIN", lambda robot: _end(0, robot), "1"),
        Fixed("POS_MAX", lambda robot: _end(1, robot), "1"),
    ),
)
