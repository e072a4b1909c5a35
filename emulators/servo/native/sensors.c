/* The sensors of an axis: sensors.py says it readably. */
#include "sensors.h"

#include "arithmetic.h"

static int64_t modulo(int64_t dividend, int64_t divisor)
{
    return dividend - floor_division(dividend, divisor) * divisor;
}

int64_t servo_counted(servo_axis *axis, int64_t turned)
{
    int64_t step = turned, faults = axis->sensor_faults;
    if (faults & BROKEN) {
        step = 0;
    } else if (axis->encoder_loss) {
        int64_t rest = axis->loss_rest + (step >= 0 ? step : -step) * axis->encoder_loss;
        int64_t lost = floor_division(rest, PER_MILLE);
        axis->loss_rest = rest - lost * PER_MILLE;
        step = step >= 0 ? largest(0, step - lost) : least(0, step + lost);
    }
    if (!(faults & SWAPPED) != !axis->encoder_reversed)
        step = -step;
    axis->turned = turned;
    axis->slipped += step - turned;
    return step;
}

bool servo_passed(const servo_axis *axis, int64_t behind, int64_t *mark)
{
    int64_t turn = axis->encoder_resolution, shaft = axis->encoder - behind;
    int64_t after = floor_division(shaft, turn), before = floor_division(shaft - axis->turned, turn);
    *mark = (after > before ? after : after + 1) * turn + behind;
    return after != before;
}

static int64_t pattern_of(int64_t sector) { return HALL_SEQUENCE >> 3 * (SECTORS - 1 - sector) & HALL_LINES; }

static int64_t hall_pattern(const servo_axis *axis)
{
    int64_t pairs = axis->mounted_pole_pairs ? axis->mounted_pole_pairs : axis->hall_pole_pairs;
    int64_t faults = axis->sensor_faults, turn = axis->encoder_resolution;
    int64_t sector = modulo(axis->encoder, turn) * SECTORS * pairs / turn % SECTORS;
    return (pattern_of(sector) | (faults >> HALL_HIGH & HALL_LINES)) & ~(faults >> HALL_LOW) & HALL_LINES;
}

static int64_t electrical_angle(const servo_axis *axis, int64_t pattern)
{
    int64_t sector = 0, counts = modulo(axis->encoder + axis->slipped, axis->resolution);
    while (sector < SECTORS && pattern_of(sector) != pattern)
        sector += 1;
    return counts * 2 * SECTORS * axis->hall_pole_pairs - (2 * sector + 1) * axis->resolution;
}

static int64_t judged_index(servo_axis *axis)
{
    int64_t counts = axis->encoder + axis->slipped, turn = axis->resolution;
    int64_t before = axis->index_before, known = axis->index_known, tolerance = turn >> INDEX_TOLERANCE, way;
    if (axis->index_passes == axis->index_judged) {
        if (!beyond(counts - before, INDEX_TURNS * turn))
            return 0;
        axis->index_before = counts;
        axis->index_known = 0;
        return INDEX_LOST;
    }
    axis->index_judged = axis->index_passes;
    axis->index_before = axis->index_count;
    axis->index_known = 1;
    way = axis->index_count >= before ? axis->index_count - before : before - axis->index_count;
    if (!known || way <= tolerance || !beyond(way - turn, tolerance))
        return 0;
    return way <= turn >> INDEX_SOONEST ? INDEX_LOST : INDEX_DISTANCE_WRONG;
}

static int64_t judged_hall(const servo_axis *axis)
{
    int64_t pattern = hall_pattern(axis), whole = 2 * SECTORS * axis->resolution, apart;
    if (pattern == 0 || pattern == HALL_LINES)
        return HALL_IMPOSSIBLE;
    if (!axis->hall_angle_supervised)
        return 0;
    apart = modulo(electrical_angle(axis, pattern) - axis->hall_zero + whole / 2, whole) - whole / 2;
    return beyond(apart, whole / 4) ? HALL_ANGLE_APART : 0;
}

static int64_t judged_direction(servo_axis *axis)
{
    int64_t limit = floor_division(axis->supply_mv * axis->voltage_percent, 100);
    int64_t voltage = axis->voltage_mv, step = axis->step, average = axis->velocity_average;
    if (voltage < 0) {
        voltage = -voltage;
        step = -step;
        average = -average;
    }
    if (!(voltage >= limit && step < 0 && -average > axis->rest_window) || shifted(1 - step, axis->fraction) < -average) {
        axis->contrary_ms = 0;
        return 0;
    }
    axis->contrary_ms += 1;
    return axis->contrary_ms >= CONTRARY_MS ? ENCODER_AGAINST_MOTOR : 0;
}

int64_t servo_supervise(servo_axis *axis)
{
    int64_t flags = 0;
    if (axis->encoder_supervised) {
        if (axis->sensor_faults & BROKEN)
            flags = ENCODER_BROKEN;
        if (axis->index_supervised)
            flags |= judged_index(axis);
    }
    if (axis->powered) {
        if (axis->hall_pole_pairs)
            flags |= judged_hall(axis);
        if (axis->regulator == VELOCITY || axis->regulator == POSITION)
            flags |= judged_direction(axis);
        if (axis->auxiliary_supervised && axis->sensor_faults & AUXILIARY_SWAPPED)
            if (beyond(axis->encoder - axis->switched_on_at, axis->encoder_resolution))
                flags |= AUXILIARY_AGAINST_MAIN;
    }
    return flags;
}
