/* Axes and plant from one event to the next: reference.py says it readably. */
#include "kernel.h"
#include "plant.h"
#include "readings.h"
#include "recorder.h"
#include "winding.h"

#ifndef SERVO_SOURCE
#define SERVO_SOURCE 0
#endif

static int64_t sample_supply(servo_bank *bank, double volts)
{
    int64_t supply_mv, k;
    if (!reading(volts, &supply_mv))
        return refuse(bank, ENDED_SUPPLY, -1, volts);
    for (k = 0; k < bank->count; k++) {
        double divider = ((const double *)bank->dividers)[k];
        servo_axis *axis = axis_at(bank, k);
        axis->source_mv = supply_mv;
        axis->supply_mv = axis->forced_supply_mv ? axis->forced_supply_mv : supply_mv;
        if (divider != 0.0)
            axis->analogue_1_mv = (int64_t)((double)axis->supply_mv / divider);
    }
    return ENDED_REACHED;
}

static int64_t sample_pins(servo_bank *bank, const double *outputs, double *inputs)
{
    const servo_line *line = bank->input_lines, *end = line + bank->input_line_count;
    int64_t signal;
    for (; line != end; line++) {
        servo_axis *axis = axis_at(bank, line->axis);
        double value = outputs[line->variable];
        if (!(line->mask == MASTER ? whole(value, &signal) : reading(value, &signal)))
            return refuse(bank, line->mask < MASTER ? ENDED_PIN : ENDED_SENSOR, line->axis, value);
        if (line->mask == MASTER)
            axis->master = signal;
        else if (line->mask == ANALOGUE_1)
            axis->analogue_1_mv = signal;
        else if (line->mask == ANALOGUE_2)
            axis->analogue_2_mv = signal;
        else
            axis->pins = signal > CLOSED ? axis->pins | line->mask : axis->pins & ~line->mask;
    }
    line = bank->output_lines;
    for (end = line + bank->output_line_count; line != end; line++)
        inputs[line->variable] = axis_at(bank, line->axis)->outputs & line->mask ? 1.0 : 0.0;
    return ENDED_REACHED;
}

static int64_t milliseconds(servo_bank *bank, const double *outputs, double *inputs)
{
    int64_t ended = ENDED_REACHED, count = bank->count, k;
    if (bank->supply >= 0 && (ended = sample_supply(bank, outputs[bank->supply])) != ENDED_REACHED)
        return ended;
    if ((ended = sample_pins(bank, outputs, inputs)) != ENDED_REACHED)
        return ended;
    for (k = 0; k < count; k++) {
        servo_axis *axis = axis_at(bank, k);
        double current = outputs[k], angle = outputs[count + k], speed = outputs[2 * count + k];
        int64_t encoder, milliradians;
        if (!reading(current, &axis->current_ma))
            return refuse(bank, ENDED_CURRENT, k, current);
        if (!counted(axis, angle * ((const double *)bank->counts_per_radian)[k], &encoder))
            return refuse(bank, ENDED_ANGLE, k, angle);
        axis->event = servo_millisecond(axis, encoder);
        if (axis->event)
            ended = ENDED_EVENT;
        if (!axis->powered) {
            if (!reading(speed, &milliradians))
                return refuse(bank, ENDED_SPEED, k, speed);
            axis->turning = servo_turns(axis, milliradians);
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
        inputs[k] = (double)servo_regulate(axis, milliamperes) * 0.001;
    }
    for (k = 0; k < count; k++) {
        servo_axis *axis = axis_at(bank, k);
        if (axis->powered || !axis->turning)
            continue;
        if (!reading(outputs[k], &milliamperes))
            return refuse(bank, ENDED_CURRENT, k, outputs[k]);
        if (!reading(outputs[2 * count + k], &milliradians))
            return refuse(bank, ENDED_SPEED, k, outputs[2 * count + k]);
        inputs[k] = (double)servo_opened(axis, milliamperes, milliradians) * 0.001;
    }
    for (k = 0; k < count; k++)
        if (axis_at(bank, k)->recording)
            servo_record(axis_at(bank, k), ((servo_recorder **)bank->recorders)[k]);
    return ENDED_REACHED;
}

uint64_t servo_source(void) { return SERVO_SOURCE; }

int64_t servo_run(servo_bank *bank, int64_t last)
{
    plant_calls *plant = bank->plant;
    const double *outputs = plant->outputs;
    double *inputs = plant->inputs;
    int64_t event = ENDED_REACHED, ended, k;
    if (bank->tick >= last)
        return ENDED_REACHED;
    while (bank->tick < last && !event) {
        if (bank->tick % TICKS_PER_MILLISECOND == 0 && (event = milliseconds(bank, outputs, inputs)) > ENDED_EVENT)
            return event;
        if ((ended = tick(bank, outputs, inputs)) != ENDED_REACHED)
            return ended;
        if ((ended = servo_plant_step(plant, bank->sampled, &bank->fault_status)) != ENDED_REACHED)
            return ended;
        bank->tick += 1;
    }
    /* What no axis needs is read where someone may look at it. */
    if (bank->sampled < plant->output_count && (bank->fault_status = servo_plant_read(plant, plant->output_count)) > WARNING)
        return ENDED_READ;
    for (k = 0; k < bank->count; k++)
        axis_at(bank, k)->now = bank->tick * TICK;
    return event;
}
