/* The demand, one millisecond on: profile.py says it readably. */
#include "profile.h"

#include "arithmetic.h"
#include "electronic_gear.h"
#include "sine.h"
#include "spline.h"

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
    int64_t slowing = axis->deceleration, wanted, following;
    if (way >= axis->stopping_distance)
        wanted = axis->cruise;
    else if (way <= slowing)
        wanted = least(way, axis->cruise);
    else
        wanted = least((whole_root(8 * slowing * way + slowing * slowing) - slowing) >> 1, axis->cruise);
    if (speed < 0)
        following = least(speed + slowing, 0);
    else if (speed < wanted)
        following = least(speed + axis->acceleration, wanted);
    else
        following = largest(speed - slowing, wanted);
    axis->acceleration_demand = forward ? following - speed : speed - following;
    axis->velocity_demand = forward ? following : -following;
    axis->position_demand += axis->velocity_demand;
    return following == 0 && way == 0;
}

int64_t servo_profile_step(servo_axis *axis)
{
    bool done;
    if (axis->profile == DIRECT) {
        axis->acceleration_demand = 0;
        if (axis->analogue_input)
            servo_setpoint(axis);
        return PROFILE_DONE;
    }
    if (axis->profile == SPLINE)
        done = servo_spline(axis);
    else if (axis->profile == ELECTRONIC_GEAR)
        done = servo_electronic_gear(axis);
    else if (axis->shape == SINE)
        done = servo_legs(axis);
    else
        done = axis->profile == MOVE ? move(axis) : ramp(axis);
    return done ? PROFILE_DONE : 0;
}
