#include "kernel.h"

#include <stdbool.h>
#include <stddef.h>

#ifndef SERVO_SOURCE
#define SERVO_SOURCE 0
#endif

/* Shifts to the right round towards minus infinity, as in Python. */
typedef char right_shift_is_arithmetic[(-1 >> 1) == -1 ? 1 : -1];

/* Arithmetic */

static int64_t shifted(int64_t value, int64_t places) { return value * ((int64_t)1 << places); }

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

static int64_t largest(int64_t a, int64_t b) { return a > b ? a : b; }

static bool beyond(int64_t value, int64_t limit) { return value > limit || -value > limit; }

static int64_t within(int64_t value, int64_t widest)
{
    return value > widest ? widest : largest(value, -widest);
}

static int64_t floor_division(int64_t dividend, int64_t divisor)
{
    int64_t quotient = dividend / divisor;
    return quotient * divisor != dividend && (dividend < 0) != (divisor < 0) ? quotient - 1 : quotient;
}

static int64_t whole_root(int64_t square)
{
    uint64_t rest = (uint64_t)square, root = 0, bit = (uint64_t)1 << 62;
    while (bit > rest)
        bit >>= 2;
    for (; bit; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (int64_t)root;
}

/* Profiles: profile.py */

static bool ramp(servo_axis *axis)
{
    int64_t speed = axis->velocity_demand, target = axis->target_velocity, following = target;
    if (speed < target) {
        if (speed < 0)
            following = least(least(speed + axis->deceleration, target), 0);
        else
            following = least(speed + axis->acceleration, target);
    } else if (speed > target) {
        if (speed > 0)
            following = largest(largest(speed - axis->deceleration, target), 0);
        else
            following = largest(speed - axis->acceleration, target);
    }
    axis->acceleration_demand = following - speed;
    axis->velocity_demand = following;
    axis->position_demand += following;
    return following == target;
}

static bool move(servo_axis *axis)
{
    int64_t left = axis->target_position - axis->position_demand;
    bool forward = left >= 0;
    int64_t way = forward ? left : -left;
    int64_t speed = forward ? axis->velocity_demand : -axis->velocity_demand;
    int64_t slowing = axis->deceleration, wish, following;
    if (way >= axis->stopping_distance)
        wish = axis->cruise;
    else if (way <= slowing)
        wish = least(way, axis->cruise);
    else
        wish = least((whole_root(8 * slowing * way + slowing * slowing) - slowing) >> 1, axis->cruise);
    if (speed < 0)
        following = least(speed + slowing, 0);
    else if (speed < wish)
        following = least(speed + axis->acceleration, wish);
    else
        following = largest(speed - slowing, wish);
    axis->acceleration_demand = forward ? following - speed : speed - following;
    axis->velocity_demand = forward ? following : -following;
    axis->position_demand += axis->velocity_demand;
    return following == 0 && way == 0;
}

static int64_t profile_step(servo_axis *axis)
{
    if (axis->profile == RAMP)
        return ramp(axis) ? PROFILE_DONE : 0;
    if (axis->profile == MOVE)
        return move(axis) ? PROFILE_DONE : 0;
    axis->acceleration_demand = 0;
    return PROFILE_DONE;
}

/* Every millisecond: loops.py */

static int64_t electrical(const servo_axis *axis)
{
    int64_t flags = 0;
    if (beyond(axis->current_ma, axis->over_current_ma))
        flags = OVER_CURRENT;
    if (axis->supply_mv < axis->under_voltage_mv)
        flags |= UNDER_VOLTAGE;
    else if (axis->supply_mv > axis->over_voltage_mv)
        flags |= OVER_VOLTAGE;
    return flags;
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
static int64_t limited(const servo_axis *axis, int64_t wish, int64_t integral, int64_t *kept, int64_t places)
{
    int64_t bounded = within(wish, axis->current_limit_ma);
    if (bounded == wish || (integral > *kept) != (wish > 0))
        *kept = within(integral, shifted(axis->current_limit_ma, places));
    return bounded;
}

static void velocity(servo_axis *axis)
{
    int64_t demand = axis->velocity_demand;
    int64_t error = within(demand - shifted(axis->step, axis->fraction), WIDEST_SPEED);
    int64_t integral = axis->velocity_integral + axis->velocity_i * error;
    int64_t wish = (axis->velocity_p * error + integral) >> VELOCITY_PLACES;
    wish += (axis->velocity_speed_forward * demand) >> SPEED_FORWARD_PLACES;
    wish += (axis->velocity_acceleration_forward * axis->acceleration_demand) >> ACCELERATION_FORWARD_PLACES;
    axis->current_demand_ma = limited(axis, wish, integral, &axis->velocity_integral, VELOCITY_PLACES);
}

static int64_t position(servo_axis *axis)
{
    int64_t demand = axis->velocity_demand, fraction = axis->fraction, limit = axis->following_limit_qc;
    int64_t error = axis->position_demand - shifted(axis->position, fraction);
    int64_t flags = limit >= 0 && beyond(error >> fraction, limit) ? FOLLOWING_ERROR : 0;
    int64_t difference = within(demand - shifted(axis->step, fraction), WIDEST_SPEED);
    int64_t derivative = axis->derivative, integral, wish;
    error = within(error, WIDEST_WAY);
    derivative += ((difference - derivative) * axis->position_filter) >> FILTER_PLACES;
    axis->derivative = derivative;
    integral = axis->position_integral + axis->position_i * error;
    wish = (axis->position_p * error) >> POSITION_P_PLACES;
    wish += integral >> POSITION_I_PLACES;
    wish += (axis->position_d * derivative) >> POSITION_D_PLACES;
    wish += (axis->position_speed_forward * demand) >> SPEED_FORWARD_PLACES;
    wish += (axis->position_acceleration_forward * axis->acceleration_demand) >> ACCELERATION_FORWARD_PLACES;
    axis->current_demand_ma = limited(axis, wish, integral, &axis->position_integral, POSITION_I_PLACES);
    return flags;
}

static void current_mode(servo_axis *axis)
{
    int64_t wish = within(axis->current_setting_ma, axis->current_limit_ma);
    int64_t speed = axis->velocity_average;
    if ((wish > 0 && speed > axis->speed_limit) || (wish < 0 && -speed > axis->speed_limit))
        wish = 0;
    axis->current_demand_ma = wish;
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
    axis->encoder = encoder;
    axis->step = step;
    axis->position = ((axis->position + step + HALF) & (WRAP - 1)) - HALF;
    axis->velocity_average += (shifted(step, axis->fraction) - axis->velocity_average) >> AVERAGE;
    flags = budget(axis, before & CURRENT_LIMITED) | electrical(axis);
    if (axis->powered) {
        flags |= profile_step(axis);
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
    flags |= rest(axis);
    axis->flags = flags;
    if (axis->call) {
        axis->call = 0;
        return 1;
    }
    return flags != before;
}

/* Every tick: winding.py */

static void measure(servo_axis *axis, int64_t current)
{
    axis->current_ma = current;
    axis->current_average += (shifted(current, AVERAGE_PLACES) - axis->current_average) >> AVERAGE;
}

static int64_t regulate(servo_axis *axis, int64_t current)
{
    int64_t error = axis->current_demand_ma - current;
    int64_t integral = axis->current_integral + axis->current_i * error;
    int64_t voltage = (axis->current_p * error + integral) >> CURRENT_PLACES;
    int64_t limit = floor_division(axis->supply_mv * axis->voltage_percent, 100);
    measure(axis, current);
    if (-limit <= voltage && voltage <= limit) {
        axis->current_integral = integral;
    } else {
        voltage = voltage > 0 ? limit : -limit;
        if ((integral > axis->current_integral) != (voltage > 0))
            axis->current_integral = integral;
    }
    axis->voltage_mv = voltage;
    return voltage;
}

static bool turns(servo_axis *axis, int64_t speed)
{
    int64_t current = axis->current_ma;
    if (beyond(speed, LEARNING)) {
        int64_t constant = axis->back_emf;
        if (constant == 0)
            constant = largest(0, floor_division(shifted(axis->voltage_mv, BACK_EMF_PLACES), speed));
        if (beyond(current, 1))
            constant = largest(0, constant + floor_division(-(current * LEARNING_RATE), speed));
        axis->back_emf = least(constant, WIDEST_BACK_EMF);
        return true;
    }
    return axis->voltage_mv != 0 || current != 0 || beyond(axis->current_average, FADED) || beyond(speed, RESTING);
}

static int64_t opened(servo_axis *axis, int64_t current, int64_t speed)
{
    int64_t voltage = axis->voltage_mv;
    if (!beyond(speed, RESTING))
        voltage = 0;
    else if (axis->back_emf)
        voltage = (axis->back_emf * speed + ((int64_t)1 << BACK_EMF_PLACES >> 1)) >> BACK_EMF_PLACES;
    measure(axis, current);
    axis->voltage_mv = voltage;
    return voltage;
}

/* The plant's floating point */

static servo_axis *axis_at(const servo_bank *bank, int64_t k) { return ((servo_axis **)bank->axes)[k]; }

static int64_t refuse(servo_bank *bank, int64_t ended, int64_t axis, double value)
{
    bank->fault_axis = axis;
    bank->fault_value = value;
    return ended;
}

/* Thousandths towards zero; a value that is not finite fails the comparison, too. */
static bool reading(double value, int64_t *thousandths)
{
    double scaled = value * 1000.0;
    if (!(scaled >= -(double)WIDEST_READING && scaled <= (double)WIDEST_READING))
        return false;
    *thousandths = (int64_t)scaled;
    return true;
}

static bool counted(const servo_axis *axis, double counts, int64_t *encoder)
{
    int64_t count;
    if (!(counts >= -(double)WIDEST_ANGLE && counts <= (double)WIDEST_ANGLE))
        return false;
    count = (int64_t)counts;
    if ((double)count > counts)
        count -= 1;
    *encoder = count;
    return !beyond(count - axis->encoder, WIDEST_STEP);
}

static int64_t sample_supply(servo_bank *bank, double volts)
{
    int64_t supply_mv, k;
    if (!reading(volts, &supply_mv))
        return refuse(bank, ENDED_SUPPLY, -1, volts);
    for (k = 0; k < bank->count; k++) {
        double divider = ((const double *)bank->dividers)[k];
        axis_at(bank, k)->supply_mv = supply_mv;
        if (divider != 0.0)
            axis_at(bank, k)->analogue_1_mv = (int64_t)((double)supply_mv / divider);
    }
    return ENDED_REACHED;
}

static int64_t milliseconds(servo_bank *bank, const double *outputs)
{
    int64_t ended = ENDED_REACHED, count = bank->count, k;
    if (bank->supply >= 0 && (ended = sample_supply(bank, outputs[bank->supply])) != ENDED_REACHED)
        return ended;
    for (k = 0; k < count; k++) {
        servo_axis *axis = axis_at(bank, k);
        double current = outputs[k], angle = outputs[count + k], speed = outputs[2 * count + k];
        int64_t encoder, milliradians;
        if (!reading(current, &axis->current_ma))
            return refuse(bank, ENDED_CURRENT, k, current);
        if (!counted(axis, angle * ((const double *)bank->counts_per_radian)[k], &encoder))
            return refuse(bank, ENDED_ANGLE, k, angle);
        axis->told = servo_millisecond(axis, encoder);
        if (axis->told)
            ended = ENDED_TOLD;
        if (!axis->powered) {
            if (!reading(speed, &milliradians))
                return refuse(bank, ENDED_SPEED, k, speed);
            axis->turning = turns(axis, milliradians);
        }
    }
    return ended;
}

static int64_t tick(servo_bank *bank, const double *outputs, double *inputs)
{
    int64_t count = bank->count, milliamperes, milliradians, k;
    for (k = 0; k < count; k++) {
        servo_axis *axis = axis_at(bank, k);
        if (!axis->powered)
            continue;
        if (!reading(outputs[k], &milliamperes))
            return refuse(bank, ENDED_CURRENT, k, outputs[k]);
        inputs[k] = (double)regulate(axis, milliamperes) * 0.001;
    }
    for (k = 0; k < count; k++) {
        servo_axis *axis = axis_at(bank, k);
        if (axis->powered || !axis->turning)
            continue;
        if (!reading(outputs[k], &milliamperes))
            return refuse(bank, ENDED_CURRENT, k, outputs[k]);
        if (!reading(outputs[2 * count + k], &milliradians))
            return refuse(bank, ENDED_SPEED, k, outputs[2 * count + k]);
        inputs[k] = (double)opened(axis, milliamperes, milliradians) * 0.001;
    }
    return ENDED_REACHED;
}

/* The plant: an FMU's functions for setting, stepping and getting (FMI 2.0.4, 2.1 and 4.2; FMI 3.0.1, 2.2 and 4.2) */

typedef int (*set_real)(void *, const uint32_t *, size_t, const double *);
typedef int (*get_real)(void *, const uint32_t *, size_t, double *);
typedef int (*step_2)(void *, double, double, int);
typedef int (*set_float64)(void *, const uint32_t *, size_t, const double *, size_t);
typedef int (*get_float64)(void *, const uint32_t *, size_t, double *, size_t);
typedef int (*step_3)(void *, double, double, bool, bool *, bool *, bool *, double *);

#define WARNING 1
#define SECOND_NS 1e9

static int plant_write(const plant_calls *plant)
{
    size_t count = (size_t)plant->input_count;
    if (plant->fmi == 2)
        return ((set_real)plant->write)(plant->component, plant->input_references, count, plant->inputs);
    return ((set_float64)plant->write)(plant->component, plant->input_references, count, plant->inputs, count);
}

/* The state may be set back to before this instant, when the world is rewound: hence no promise that it will not. */
static int plant_forward(const plant_calls *plant)
{
    double now = (double)(plant->steps_done * plant->step_ns) / SECOND_NS, step = (double)plant->step_ns / SECOND_NS;
    bool event = false, over = false, early = false;
    double reached = 0.0;
    if (plant->fmi == 2)
        return ((step_2)plant->forward)(plant->component, now, step, 0);
    return ((step_3)plant->forward)(plant->component, now, step, false, &event, &over, &early, &reached);
}

static int plant_read(const plant_calls *plant, int64_t outputs)
{
    size_t count = (size_t)outputs;
    if (plant->fmi == 2)
        return ((get_real)plant->read)(plant->component, plant->output_references, count, plant->outputs);
    return ((get_float64)plant->read)(plant->component, plant->output_references, count, plant->outputs, count);
}

static int64_t plant_step(servo_bank *bank, plant_calls *plant)
{
    bank->fault_status = WARNING + 1;
    if (!plant->write || (bank->fault_status = plant_write(plant)) > WARNING)
        return ENDED_WRITE;
    if ((bank->fault_status = plant_forward(plant)) > WARNING)
        return ENDED_STEP;
    plant->steps_done += 1;
    if ((bank->fault_status = plant_read(plant, bank->sampled)) > WARNING)
        return ENDED_READ;
    return ENDED_REACHED;
}

/* The runner: twin.py */

uint64_t servo_source(void) { return SERVO_SOURCE; }

int64_t servo_run(servo_bank *bank, int64_t last)
{
    plant_calls *plant = bank->plant;
    const double *outputs = plant->outputs;
    double *inputs = plant->inputs;
    int64_t told = ENDED_REACHED, ended, k;
    if (bank->tick >= last)
        return ENDED_REACHED;
    while (bank->tick < last && !told) {
        if (bank->tick % TICKS_PER_MILLISECOND == 0 && (told = milliseconds(bank, outputs)) > ENDED_TOLD)
            return told;
        if ((ended = tick(bank, outputs, inputs)) != ENDED_REACHED)
            return ended;
        if ((ended = plant_step(bank, plant)) != ENDED_REACHED)
            return ended;
        bank->tick += 1;
    }
    /* What no axis needs is read where somebody may look at it. */
    if (bank->sampled < plant->output_count && (bank->fault_status = plant_read(plant, plant->output_count)) > WARNING)
        return ENDED_READ;
    for (k = 0; k < bank->count; k++)
        axis_at(bank, k)->now = bank->tick * TICK;
    return told;
}
