"""Commands to one axis between two ticks: regulators handed over without a jump of the current, and braking.

Modes and states are not known here: who may command is decided elsewhere.
"""

from emulators.servo.axis import (
    CURRENT,
    DIRECT,
    IDLE,
    POSITION,
    PROFILE_DONE,
    RAMP,
    TARGET_REACHED,
    TRAPEZOID,
    VELOCITY,
    ServoAxis,
)
from emulators.servo.scaling import POSITION_I_PLACES, VELOCITY_PLACES, acceleration_units
from emulators.servo.signals import HALF, WRAP


def regulate_velocity(axis: ServoAxis) -> None:
    """Let the velocity regulator take over at the present speed and current."""
    if axis.regulator == POSITION:
        # Both integrators hold a current in mA: they differ in their binary places only.
        axis.velocity_integral = axis.position_integral >> (POSITION_I_PLACES - VELOCITY_PLACES)
    elif axis.regulator != VELOCITY:
        axis.velocity_integral = axis.current_demand_ma << VELOCITY_PLACES
        axis.velocity_demand = axis.shaft_speed()
    axis.regulator = VELOCITY


def regulate_position(axis: ServoAxis) -> None:
    """Let the position regulator take over at the present position, speed and current."""
    if axis.regulator == POSITION:
        return
    if axis.regulator == VELOCITY:
        axis.position_integral = axis.velocity_integral << (POSITION_I_PLACES - VELOCITY_PLACES)
    else:
        axis.position_integral = axis.current_demand_ma << POSITION_I_PLACES
        axis.velocity_demand = axis.shaft_speed()
    axis.position_demand = axis.position << axis.fraction
    axis.derivative = 0
    axis.regulator = POSITION


def brake(axis: ServoAxis, rpm_per_second: int) -> None:
    """Ramp the present demand to standstill, then hold the position if it was regulated, else no speed."""
    if axis.regulator in (IDLE, CURRENT):
        # Without a speed demand the ramp begins at the speed that the shaft has.
        axis.clear_demand()
        regulate_velocity(axis)
    elif axis.profile == DIRECT and axis.regulator == POSITION:
        axis.velocity_demand = axis.shaft_speed()
    axis.profile, axis.shape = RAMP, TRAPEZOID
    axis.target_velocity = 0
    axis.acceleration = axis.deceleration = acceleration_units(axis, rpm_per_second)
    judge_again(axis, there=axis.velocity_demand == 0)


def displace(axis: ServoAxis, distance: int) -> None:
    """Count the position from elsewhere: every place is further up by `distance` in qc; nothing moves."""
    before = axis.position
    axis.position = _wrapped(before + distance)
    axis.index_position = _wrapped(axis.index_position + distance)
    # By the wrapped difference: the regulator must see no step.
    moved = (axis.position - before) << axis.fraction
    axis.position_demand += moved
    axis.target_position += moved


def _wrapped(position: int) -> int:
    return ((position + HALF) & (WRAP - 1)) - HALF


def judge_again(axis: ServoAxis, *, there: bool) -> None:
    """Forget the arrival at the former target; one that is `there` already does not wait for the next ms."""
    axis.window_ms = 0
    if there:
        axis.flags |= PROFILE_DONE | TARGET_REACHED
    else:
        axis.flags &= ~(PROFILE_DONE | TARGET_REACHED)
