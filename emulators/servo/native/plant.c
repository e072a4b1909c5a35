/* The plant: an FMU's functions for setting, stepping and getting (FMI 2.0.4, 2.1 and 4.2; FMI 3.0.1, 2.2 and 4.2).

   Whoever made it, and whoever loaded it: only the addresses of its functions count. */
#include "plant.h"

#include <stdbool.h>
#include <stddef.h>

typedef int (*set_real)(void *, const uint32_t *, size_t, const double *);
typedef int (*get_real)(void *, const uint32_t *, size_t, double *);
typedef int (*step_2)(void *, double, double, int);
typedef int (*set_float64)(void *, const uint32_t *, size_t, const double *, size_t);
typedef int (*get_float64)(void *, const uint32_t *, size_t, double *, size_t);
typedef int (*step_3)(void *, double, double, bool, bool *, bool *, bool *, double *);

/* What a step in FMI 3.0 tells beside its status, numbered on from the statuses: fmu/calls.py. */
#define WANTS_TO_END 6
#define STOPPED_SHORT 7
#define SECOND_NS 1e9

/* Give these of the first `count` values the other sign. */
static void turn_over(double *values, int64_t count, const int64_t *places, int64_t mirrored)
{
    int64_t k;
    for (k = 0; k < mirrored; k++)
        if (places[k] < count)
            values[places[k]] = -values[places[k]];
}

static int plant_set(const plant_calls *plant)
{
    size_t count = (size_t)plant->input_count;
    if (plant->fmi == 2)
        return ((set_real)plant->write)(plant->component, plant->input_references, count, plant->inputs);
    return ((set_float64)plant->write)(plant->component, plant->input_references, count, plant->inputs, count);
}

/* The master's own values stay as it has written them. */
static int plant_write(const plant_calls *plant)
{
    int status;
    turn_over(plant->inputs, plant->input_count, plant->mirrored_inputs, plant->mirrored_input_count);
    status = plant_set(plant);
    turn_over(plant->inputs, plant->input_count, plant->mirrored_inputs, plant->mirrored_input_count);
    return status;
}

/* The state may be set back to before this instant, when the world is rewound: hence no promise that it will not. */
static int plant_forward(const plant_calls *plant)
{
    double now = (double)(plant->steps_done * plant->step_ns) / SECOND_NS, step = (double)plant->step_ns / SECOND_NS;
    bool event = false, over = false, early = false;
    double reached = 0.0;
    int status;
    if (plant->fmi == 2)
        return ((step_2)plant->forward)(plant->component, now, step, 0);
    status = ((step_3)plant->forward)(plant->component, now, step, false, &event, &over, &early, &reached);
    if (status > WARNING)
        return status;
    return over ? WANTS_TO_END : early ? STOPPED_SHORT : status;
}

static int plant_get(const plant_calls *plant, size_t count)
{
    if (plant->fmi == 2)
        return ((get_real)plant->read)(plant->component, plant->output_references, count, plant->outputs);
    return ((get_float64)plant->read)(plant->component, plant->output_references, count, plant->outputs, count);
}

int servo_plant_read(const plant_calls *plant, int64_t outputs)
{
    int status = plant_get(plant, (size_t)outputs);
    if (status <= WARNING)
        turn_over(plant->outputs, outputs, plant->mirrored_outputs, plant->mirrored_output_count);
    return status;
}

int64_t servo_plant_step(plant_calls *plant, int64_t sampled, int64_t *status)
{
    *status = WARNING + 1;
    if (!plant->write || (*status = plant_write(plant)) > WARNING)
        return ENDED_WRITE;
    if ((*status = plant_forward(plant)) > WARNING)
        return ENDED_STEP;
    plant->steps_done += 1;
    if ((*status = servo_plant_read(plant, sampled)) > WARNING)
        return ENDED_READ;
    return ENDED_REACHED;
}
