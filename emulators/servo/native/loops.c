/* What an axis does every millisecond: loops.py says it readably. */
#include "arithmetic.h"
#include "compare.h"
#include "kernel.h"
#include "profile.h"
#include "sensors.h"
#include "signals.h"

static int64_t electrical(servo_axis *axis)
{
    int64_t flags = 0, hottest = axis->flags & OVER_TEMPERATURE ? HOTTEST_MC - COOLED_MC : HOTTEST_MC;
    if (beyond(axis->current_ma, axis->over_current_ma))
        flags = OVER_CURRENT;
    if (axis->logic_mv < LEAST_LOGIC_MV)
        flags |= LOGIC_SUPPLY_LOW;
    if (axis->gate_mv < LEAST_GATE_MV)
        flags |= GATE_SUPPLY_LOW;
    axis->heat += (axis->current_ma * axis->current_ma - axis->heat) >> HEATING;
    if (axis->heat > (hottest - axis->ambient_mc) * axis->square_per_mc)
        flags |= OVER_TEMPERATURE;
    if (axis->supply_mv < axis->under_voltage_mv)
        flags |= UNDER_VOLTAGE;
    else if (axis->supply_mv > axis->over_voltage_mv)
        flags |= OVER_VOLTAGE;
    return flags;
}

static int64_t bounds(const servo_axis *axis)
{
    int64_t past = axis->position - axis->highest_qc, step = axis->step;
    int64_t demand = axis->velocity_demand, speed = axis->velocity_average, change = axis->acceleration_demand;
    int64_t demanded = axis->position_demand >> axis->fraction;
    bool outwards;
    if (!axis->position_limited || !axis->powered)
        return 0;
    if (axis->regulator == POSITION && axis->lowest_qc <= demanded && demanded <= axis->highest_qc)
        return 0;
    if (past <= 0) {
        past = axis->lowest_qc - axis->position;
        step = -step;
        demand = -demand;
        speed = -speed;
        change = -change;
    }
    if (past <= 0)
        return 0;
    outwards = demand > 0 || (step > 0 && speed > axis->rest_window);
    return past <= step || (outwards && change >= 0) ? POSITION_LIMIT_PASSED : 0;
}

static int64_t budget(servo_axis *axis, int64_t flags)
{
    int64_t full = axis->thermal_full;
    int64_t thermal = axis->thermal + axis->current_ma * axis->current_ma - axis->continuous_ma * axis->continuous_ma;
    if (thermal >= full) {
        thermal = full;
        flags |= CURRENT_LIMITED;
    } else if (thermal <= full >> 1) {
        flags &= ~CURRENT_LIMITED;
        thermal = largest(thermal, 0);
    }
    axis->thermal = thermal;
    axis->current_limit_ma = flags & CURRENT_LIMITED ? axis->continuous_ma : axis->peak_ma;
    return flags;
}

/* The current that a regulator may have, and its integrator: held while limited unless it leads back. */
static int64_t limited(const servo_axis *axis, int64_t wanted, int64_t integral, int64_t *kept, int64_t places)
{
    int64_t bounded = within(wanted, axis->current_limit_ma);
    if (bounded == wanted || (integral > *kept) != (wanted > 0))
        *kept = within(integral, shifted(axis->current_limit_ma, places));
    return bounded;
}

static int64_t ahead(const servo_axis *axis, int64_t speed, int64_t acceleration)
{
    int64_t at_speed = within(axis->velocity_demand, WIDEST_SPEED);
    int64_t at_acceleration = within(axis->acceleration_demand, WIDEST_SPEED);
    return ((speed * at_speed) >> SPEED_FORWARD_PLACES)
           + ((acceleration * at_acceleration) >> ACCELERATION_FORWARD_PLACES);
}

static void velocity(servo_axis *axis)
{
    int64_t demand = axis->velocity_demand;
    int64_t error = within(demand - shifted(axis->step, axis->fraction), WIDEST_SPEED);
    int64_t integral = axis->velocity_integral + axis->velocity_i * error;
    int64_t wanted = (axis->velocity_p * error + integral) >> VELOCITY_PLACES;
    wanted += ahead(axis, axis->velocity_speed_forward, axis->velocity_acceleration_forward);
    axis->current_demand_ma = limited(axis, wanted, integral, &axis->velocity_integral, VELOCITY_PLACES);
}

static int64_t position(servo_axis *axis)
{
    int64_t demand = axis->velocity_demand, fraction = axis->fraction, limit = axis->following_limit_qc;
    int64_t error = axis->position_demand - shifted(axis->position, fraction);
    int64_t flags = limit >= 0 && beyond(error >> fraction, limit) ? FOLLOWING_ERROR : 0;
    int64_t difference = within(demand - shifted(axis->step, fraction), WIDEST_SPEED);
    int64_t derivative = axis->derivative, integral, wanted;
    error = within(error, WIDEST_WAY);
    derivative += ((difference - derivative) * axis->position_filter) >> FILTER_PLACES;
    axis->derivative = derivative;
    integral = axis->position_integral + axis->position_i * error;
    wanted = (axis->position_p * error) >> POSITION_P_PLACES;
    wanted += integral >> POSITION_I_PLACES;
    wanted += (axis->position_d * derivative) >> POSITION_D_PLACES;
    wanted += ahead(axis, axis->position_speed_forward, axis->position_acceleration_forward);
    axis->current_demand_ma = limited(axis, wanted, integral, &axis->position_integral, POSITION_I_PLACES);
    return flags;
}

static void current_mode(servo_axis *axis)
{
    int64_t wanted = within(axis->current_setting_ma, axis->current_limit_ma);
    int64_t speed = axis->velocity_average;
    if ((wanted > 0 && speed > axis->speed_limit) || (wanted < 0 && -speed > axis->speed_limit))
        wanted = 0;
    axis->current_demand_ma = wanted;
}

static int64_t arrival(servo_axis *axis, int64_t flags)
{
    int64_t window, needed, away;
    bool positioned = axis->regulator == POSITION;
    if (positioned) {
        window = axis->position_window_qc;
        needed = axis->position_window_ms;
        away = (axis->target_position - shifted(axis->position, axis->fraction)) >> axis->fraction;
    } else {
        window = axis->velocity_window;
        needed = axis->velocity_window_ms;
        away = axis->target_velocity - shifted(axis->step, axis->fraction);
    }
    if (window < 0 || axis->profile != (positioned ? MOVE : RAMP))
        return flags & PROFILE_DONE ? TARGET_REACHED : 0;
    if (beyond(away, window)) {
        axis->window_ms = 0;
        return 0;
    }
    if (axis->window_ms < needed) {
        axis->window_ms += 1;
        return 0;
    }
    return TARGET_REACHED;
}

static int64_t rest(servo_axis *axis)
{
    if (beyond(axis->velocity_average, axis->rest_window) || (axis->velocity_demand != 0 && axis->powered)) {
        axis->still_ms = 0;
        return 0;
    }
    if (axis->still_ms < axis->rest_ms) {
        axis->still_ms += 1;
        return 0;
    }
    return AT_REST;
}

int64_t servo_millisecond(servo_axis *axis, int64_t encoder)
{
    int64_t before = axis->flags, flags, step = encoder - axis->encoder;
    bool noticed;
    axis->encoder = encoder;
    step = servo_counted(axis, step);
    axis->step = step;
    axis->position = ((axis->position + step + HALF) & (WRAP - 1)) - HALF;
    axis->velocity_average += (shifted(step, axis->fraction) - axis->velocity_average) >> AVERAGE;
    flags = budget(axis, before & CURRENT_LIMITED) | electrical(axis);
    if (axis->powered) {
        flags |= servo_profile_step(axis);
        if (axis->regulator == VELOCITY)
            velocity(axis);
        else if (axis->regulator == POSITION)
            flags |= position(axis);
        else if (axis->regulator == CURRENT)
            current_mode(axis);
        else
            axis->current_demand_ma = 0;
        if (axis->regulator != IDLE)
            flags |= arrival(axis, flags);
    }
    flags |= rest(axis) | servo_threshold(axis);
    noticed = servo_notice(axis);
    if (axis->compare_direction || axis->compare_left)
        noticed = servo_compare(axis) || noticed;
    flags |= servo_supervise(axis) | bounds(axis);
    axis->flags = flags;
    if (axis->call) {
        axis->call = 0;
        return 1;
    }
    return noticed || flags != before;
}
