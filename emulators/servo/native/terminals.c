/* Motors at half bridges that stay as they are: emulators/arduino_omni/motors.py says it readably. */
#include "kernel.h"
#include "plant.h"
#include "readings.h"

static void feed(const servo_terminals *motors, const double *outputs, double *inputs)
{
    int64_t count = motors->count, k;
    double supply = motors->supply < 0 ? motors->constant_supply : outputs[motors->supply];
    double period = (double)motors->period;
    for (k = 0; k < count; k++) {
        double driven = (double)((const int64_t *)motors->driven)[k];
        double conducting = (double)((const int64_t *)motors->conducting)[k];
        int64_t open = ((const int64_t *)motors->open)[k];
        double volts = (driven * supply - conducting * outputs[k] * motors->on_resistance) / period;
        if (open)
            volts += (double)open / period * ((const double *)motors->torque_constants)[k] * outputs[2 * count + k];
        inputs[k] = volts;
    }
}

static int64_t count_edges(servo_terminals *motors, const double *angles)
{
    int64_t *places = motors->places, *turned = motors->turned, *edges = motors->edges, all = 0, place, k;
    for (k = 0; k < motors->seen; k++) {
        double counts = angles[k] * motors->counts_per_radian;
        if (!whole(counts, &place)) {
            motors->fault_axis = k;
            motors->fault_value = counts;
            return ENDED_ANGLE;
        }
        turned[k] = place - places[k];
        all += turned[k] < 0 ? -turned[k] : turned[k];
    }
    for (k = 0; k < motors->seen; k++) {
        places[k] += turned[k];
        /* Towards zero: what is lost is lost from both directions alike. */
        edges[k] += all <= motors->most ? turned[k] : turned[k] * motors->most / all;
    }
    return ENDED_REACHED;
}

int64_t servo_turn(servo_terminals *motors, int64_t last)
{
    plant_calls *plant = motors->plant;
    const double *outputs = plant->outputs;
    int64_t ended;
    while (motors->tick < last) {
        feed(motors, outputs, plant->inputs);
        if ((ended = servo_plant_step(plant, motors->sampled, &motors->fault_status)) != ENDED_REACHED)
            return ended;
        motors->tick += 1;
        if ((ended = count_edges(motors, outputs + motors->count)) != ENDED_REACHED)
            return ended;
    }
    if (motors->sampled < plant->output_count
        && (motors->fault_status = servo_plant_read(plant, plant->output_count)) > WARNING)
        return ENDED_READ;
    return ENDED_REACHED;
}
