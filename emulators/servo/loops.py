"""An axis' work of every millisecond: count, average, profile, regulate, supervise.

Whole numbers only, shifts instead of divisions by powers of two, each product within 63 bits: the same lines
in C give the same results. The current loop runs ten times as often and is in `emulators.servo.bank`.
"""

from emulators.servo import setpoint
from emulators.servo.axis import (
    AT_REST,
    CURRENT,
    CURRENT_LIMITED,
    DIRECT,
    ELECTRONIC_GEAR,
    FOLLOWING_ERROR,
    GATE_SUPPLY_LOW,
    IDLE,
    LOGIC_SUPPLY_LOW,
    MOVE,
    OVER_CURRENT,
    OVER_TEMPERATURE,
    OVER_VOLTAGE,
    POSITION,
    POSITION_LIMIT_PASSED,
    PROFILE_DONE,
    RAMP,
    SINE,
    SPLINE,
    TARGET_REACHED,
    UNDER_VOLTAGE,
    VELOCITY,
    ServoAxis,
)
from emulators.servo.compare import compare
from emulators.servo.electronic_gear import electronic_gear
from emulators.servo.profile import move, ramp
from emulators.servo.scaling import (
    ACCELERATION_FORWARD_PLACES,
    FILTER_PLACES,
    POSITION_D_PLACES,
    POSITION_I_PLACES,
    POSITION_P_PLACES,
    SPEED_FORWARD_PLACES,
    VELOCITY_PLACES,
)
from emulators.servo.sensors import counted, supervise
from emulators.servo.signals import HALF, WRAP, notice, threshold
from emulators.servo.sine import legs
from emulators.servo.spline import spline

AVERAGE: int = 5
"""Low-pass of the averaged values: alpha = 2^-5 per sample (EPOS Firmware Specification)."""
HEATING: int = 17
"""Low-pass of the current's square: a time constant of 2^17 ms for the power stage (assumed)."""
HOTTEST_MC: int = 100_000
"""The power stage's temperature above which it switches off, 1/1000 degree Celsius (assumed)."""
COOLED_MC: int = 5_000
"""Temperature drop of the power stage after which the over-temperature is gone (assumed)."""
LEAST_LOGIC_MV: int = 4_500
"""The 5 V supply for sensors and logic (assumed: 10 % below)."""
LEAST_GATE_MV: int = 9_000
"""The supply of the power stage's gate drivers (assumed)."""
WIDEST_SPEED: int = 1 << 30
"""Velocity errors and what feed-forward takes saturate here, at more than twice 25 000 rpm."""
WIDEST_WAY: int = 1 << 36
"""Position errors saturate here, at some 60 turns: far past every current limit."""


def millisecond(axis: ServoAxis, encoder: int) -> bool:
    """Take the count (qc of the mounted encoder), run one ms, and say whether it raised an event."""
    turned = encoder - axis.encoder
    axis.encoder = encoder
    step = counted(axis, turned)
    axis.step = step
    axis.position = ((axis.position + step + HALF) & (WRAP - 1)) - HALF
    axis.velocity_average += ((step << axis.fraction) - axis.velocity_average) >> AVERAGE
    before = axis.flags
    flags = budget(axis, before & CURRENT_LIMITED) | electrical(axis)
    if axis.powered:
        regulator = axis.regulator
        flags |= profile_step(axis)
        if regulator == VELOCITY:
            velocity(axis)
        elif regulator == POSITION:
            flags |= position(axis)
        elif regulator == CURRENT:
            current_mode(axis)
        else:
            axis.current_demand_ma = 0
        if regulator != IDLE:
            flags |= arrival(axis, flags)
    flags |= rest(axis) | threshold(axis)
    raised = notice(axis)
    if axis.compare_direction or axis.compare_left:
        raised = compare(axis) or raised
    flags |= supervise(axis) | bounds(axis)
    axis.flags = flags
    # Requested by a mode or a spline: the drive is called although no flag has changed.
    if axis.call:
        axis.call = 0
        return True
    return raised or flags != before


def electrical(axis: ServoAxis) -> int:
    """Report currents and supply voltages that the hardware does not stand."""
    flags = 0
    current, over = axis.current_ma, axis.over_current_ma
    if current > over or -current > over:
        flags = OVER_CURRENT
    if axis.logic_mv < LEAST_LOGIC_MV:
        flags |= LOGIC_SUPPLY_LOW
    if axis.gate_mv < LEAST_GATE_MV:
        flags |= GATE_SUPPLY_LOW
    axis.heat += (current * current - axis.heat) >> HEATING
    hottest = HOTTEST_MC - COOLED_MC if axis.flags & OVER_TEMPERATURE else HOTTEST_MC
    if axis.heat > (hottest - axis.ambient_mc) * axis.square_per_mc:
        flags |= OVER_TEMPERATURE
    supply = axis.supply_mv
    if supply < axis.under_voltage_mv:
        flags |= UNDER_VOLTAGE
    elif supply > axis.over_voltage_mv:
        flags |= OVER_VOLTAGE
    return flags


def bounds(axis: ServoAxis) -> int:
    """Report that the shaft passes a software position limit, or is driven on beyond it.

    Assumed: what leads back or comes to rest is no fault, or no one could bring the shaft back after a reset.
    Assumed: while a position is regulated its demand must be beyond, too, or every move to the very limit
    would be a fault by the last count of its overshoot.
    """
    if not (axis.position_limited and axis.powered):
        return 0
    demanded = axis.position_demand >> axis.fraction
    if axis.regulator == POSITION and axis.lowest_qc <= demanded <= axis.highest_qc:
        return 0
    beyond, step = axis.position - axis.highest_qc, axis.step
    demand, speed, change = axis.velocity_demand, axis.velocity_average, axis.acceleration_demand
    if beyond <= 0:
        beyond, step = axis.lowest_qc - axis.position, -step
        demand, speed, change = -demand, -speed, -change
    if beyond <= 0:
        return 0
    outwards = demand > 0 or (step > 0 and speed > axis.rest_window)
    return POSITION_LIMIT_PASSED if beyond <= step or (outwards and change >= 0) else 0


def within(value: int, widest: int) -> int:
    """Saturate a value at either side."""
    if value > widest:
        return widest
    return max(value, -widest)


def budget(axis: ServoAxis, flags: int) -> int:
    """I2t: spend the square of the current above the continuous one; when spent, allow no more than that.

    Assumed: the output current limit is allowed again when half of the budget has been regained.
    """
    current, continuous = axis.current_ma, axis.continuous_ma
    thermal = axis.thermal + current * current - continuous * continuous
    full = axis.thermal_full
    if thermal >= full:
        thermal = full
        flags |= CURRENT_LIMITED
    elif thermal <= full >> 1:
        flags &= ~CURRENT_LIMITED
        thermal = max(thermal, 0)
    axis.thermal = thermal
    axis.current_limit_ma = continuous if flags & CURRENT_LIMITED else axis.peak_ma
    return flags


def profile_step(axis: ServoAxis) -> int:
    """Step the profile, if one runs; return a flag once its demand has arrived."""
    profile = axis.profile
    if profile == DIRECT:
        axis.acceleration_demand = 0
        if axis.analogue_input:
            setpoint.take(axis)
        return PROFILE_DONE
    if profile == SPLINE:
        done = spline(axis)
    elif profile == ELECTRONIC_GEAR:
        done = electronic_gear(axis)
    elif axis.shape == SINE:
        done = legs(axis)
    else:
        done = move(axis) if profile == MOVE else ramp(axis)
    return PROFILE_DONE if done else 0


def _forward(axis: ServoAxis, speed: int, acceleration: int) -> int:
    """Return the feed-forward current in mA by the gains for speed and acceleration."""
    # A gear's input and a spline may jump further: products with the gains must stay within 63 bits.
    at_speed = within(axis.velocity_demand, WIDEST_SPEED)
    at_acceleration = within(axis.acceleration_demand, WIDEST_SPEED)
    ahead = (speed * at_speed) >> SPEED_FORWARD_PLACES
    return ahead + ((acceleration * at_acceleration) >> ACCELERATION_FORWARD_PLACES)


def velocity(axis: ServoAxis) -> None:
    """Velocity PI with feed-forward.

    Anti-windup (assumed): the integrator stays within the current limit, and holds while the output is
    limited unless it leads back.
    """
    demand = axis.velocity_demand
    error = within(demand - (axis.step << axis.fraction), WIDEST_SPEED)
    before = axis.velocity_integral
    integral = before + axis.velocity_i * error
    command = (axis.velocity_p * error + integral) >> VELOCITY_PLACES
    command += _forward(axis, axis.velocity_speed_forward, axis.velocity_acceleration_forward)
    limit = axis.current_limit_ma
    bounded = within(command, limit)
    if bounded == command or (integral > before) != (command > 0):
        axis.velocity_integral = within(integral, limit << VELOCITY_PLACES)
    axis.current_demand_ma = bounded


def position(axis: ServoAxis) -> int:
    """Position PID with feed-forward; the derivative is filtered and acts on the difference of velocities."""
    demand = axis.velocity_demand
    fraction = axis.fraction
    error = axis.position_demand - (axis.position << fraction)
    away = error >> fraction
    limit = axis.following_limit_qc
    flags = FOLLOWING_ERROR if limit >= 0 and (away > limit or -away > limit) else 0
    # Behind the check of the following error: products with the gains must stay within 63 bits.
    error = within(error, WIDEST_WAY)
    difference = within(demand - (axis.step << fraction), WIDEST_SPEED)
    derivative = axis.derivative
    derivative += ((difference - derivative) * axis.position_filter) >> FILTER_PLACES
    axis.derivative = derivative
    integral = axis.position_integral + axis.position_i * error
    command = (axis.position_p * error) >> POSITION_P_PLACES
    command += integral >> POSITION_I_PLACES
    command += (axis.position_d * derivative) >> POSITION_D_PLACES
    command += _forward(axis, axis.position_speed_forward, axis.position_acceleration_forward)
    bounded = within(command, axis.current_limit_ma)
    if bounded == command or (integral > axis.position_integral) != (command > 0):
        axis.position_integral = within(integral, axis.current_limit_ma << POSITION_I_PLACES)
    axis.current_demand_ma = bounded
    return flags


def current_mode(axis: ServoAxis) -> None:
    """Demand the current that was set, within the limits; none that drives past the largest motor speed."""
    command = within(axis.current_setting_ma, axis.current_limit_ma)
    speed = axis.velocity_average
    if (command > 0 and speed > axis.speed_limit) or (command < 0 and -speed > axis.speed_limit):
        command = 0
    axis.current_demand_ma = command


def arrival(axis: ServoAxis, flags: int) -> int:
    """Return whether the target is reached: by the window where there is one, else when the profile ends."""
    if axis.regulator == POSITION:
        window = axis.position_window_qc
        needed = axis.position_window_ms
        away = (axis.target_position - (axis.position << axis.fraction)) >> axis.fraction
    else:
        window = axis.velocity_window
        needed = axis.velocity_window_ms
        away = axis.target_velocity - (axis.step << axis.fraction)
    # 0xFFFFFFFF is no window: then the end of the profile counts.
    if window < 0 or axis.profile != (MOVE if axis.regulator == POSITION else RAMP):
        return TARGET_REACHED if flags & PROFILE_DONE else 0
    if away > window or -away > window:
        axis.window_ms = 0
        return 0
    if axis.window_ms < needed:
        axis.window_ms += 1
        return 0
    return TARGET_REACHED


def rest(axis: ServoAxis) -> int:
    """Return whether the shaft rests: the averaged speed within the standstill window, and no speed demanded.

    Assumed: window and time of the standstill supervision (0x2101) serve for the status bit "speed = 0", too.
    """
    speed = axis.velocity_average
    window = axis.rest_window
    if speed > window or -speed > window or (axis.velocity_demand != 0 and axis.powered):
        axis.still_ms = 0
        return 0
    if axis.still_ms < axis.rest_ms:
        axis.still_ms += 1
        return 0
    return AT_REST
