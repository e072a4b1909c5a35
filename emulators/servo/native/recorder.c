/* Records fields of an axis tick by tick: recorder.py says it readably. */
#include "recorder.h"

#include "arithmetic.h"

static void trigger(servo_recorder *recorder)
{
    recorder->triggered = 1;
    recorder->remaining = largest(1, recorder->capacity - recorder->preceding);
}

static void sample(servo_axis *axis, servo_recorder *recorder)
{
    const int64_t *fields = (const int64_t *)axis, *sources = recorder->sources;
    int64_t *place = (int64_t *)recorder->memory + recorder->next * recorder->width, k;
    for (k = 0; k < recorder->width; k++)
        place[k] = fields[sources[k]];
    recorder->next = (recorder->next + 1) % recorder->capacity;
    recorder->filled = least(recorder->filled + 1, recorder->capacity);
    if (recorder->triggered && --recorder->remaining == 0)
        axis->recording = 0;
}

void servo_record(servo_axis *axis, servo_recorder *recorder)
{
    int64_t moving = axis->powered && axis->velocity_demand, happened = 0;
    if (!recorder->triggered) {
        if (axis->pins != recorder->pins)
            happened = INPUT_EDGE;
        if (moving != recorder->moving)
            happened |= moving ? MOVEMENT_START : MOVEMENT_END;
        if (happened & recorder->triggers)
            trigger(recorder);
    }
    recorder->moving = moving;
    recorder->pins = axis->pins;
    if (recorder->left) {
        recorder->left -= 1;
        return;
    }
    recorder->left = recorder->period - 1;
    sample(axis, recorder);
}
