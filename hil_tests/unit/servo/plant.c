/* A plant for tests, with the functions of both FMI versions: motors with noise on their loads, one or many.

   Sums and products only, so that every compiler gives the same bits. It breaks down on demand. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#define MOST 64

typedef struct {
    int64_t count, fails_at, steps;
    int64_t failing; /* 1 writing, 2 stepping, 3 reading, 4 an output of the first motor is replaced,
                        6 a step wants to end the simulation, 7 a step stops short */
    int64_t replaced; /* which of its outputs: 0 current, 1 angle, 2 speed */
    double replacement, supply, noise;
    uint32_t seed;
    double voltage[MOST], current[MOST], angle[MOST], speed[MOST];
} plant;

plant *plant_new(int64_t count, uint32_t seed, double noise)
{
    plant *self = calloc(1, sizeof *self);
    self->count = count;
    self->seed = seed;
    self->noise = noise;
    self->supply = 24.0;
    self->fails_at = -1;
    return self;
}

void plant_break(plant *self, int64_t at, int64_t failing, int64_t replaced, double replacement)
{
    self->fails_at = at;
    self->failing = failing;
    self->replaced = replaced;
    self->replacement = replacement;
}

void plant_free(plant *self) { free(self); }

static int status(const plant *self, int64_t call, int64_t step)
{
    return self->failing == call && self->fails_at == step ? 3 : 0;
}

static double drawn(plant *self)
{
    self->seed = self->seed * 1664525u + 1013904223u;
    return (double)(self->seed >> 8) * (1.0 / 8388608.0) - 1.0;
}

int fmi2SetReal(plant *self, const uint32_t *references, size_t count, const double *values)
{
    size_t k;
    for (k = 0; k < count; k++)
        self->voltage[references[k]] = values[k];
    return status(self, 1, self->steps);
}

static void turn(plant *self, int64_t k, double step)
{
    double winding = self->voltage[k] - 0.6 * self->current[k] - 0.04 * self->speed[k];
    double torque = 0.04 * self->current[k] - 1e-5 * self->speed[k] + self->noise * drawn(self);
    self->current[k] += step * winding * 3000.0;
    self->speed[k] += step * torque * 8000.0;
    self->angle[k] += step * self->speed[k];
}

int fmi2DoStep(plant *self, double now, double step, int kept)
{
    int64_t k;
    (void)kept;
    if (now != (double)(self->steps * 100000) / 1e9)
        return 4;
    for (k = 0; k < self->count; k++)
        turn(self, k, step);
    self->supply += 0.001 * drawn(self);
    return status(self, 2, self->steps++);
}

int fmi2GetReal(plant *self, const uint32_t *references, size_t count, double *values)
{
    size_t k;
    int64_t n = self->count;
    for (k = 0; k < count; k++) {
        int64_t r = references[k];
        if (r < 3 * n)
            values[k] = r < n ? self->current[r] : r < 2 * n ? self->angle[r - n] : self->speed[r - 2 * n];
        else
            values[k] = self->supply;
        if (self->failing == 4 && self->steps >= self->fails_at && self->fails_at >= 0 && r == self->replaced * n)
            values[k] = self->replacement;
    }
    return status(self, 3, self->steps);
}

int fmi3SetFloat64(plant *self, const uint32_t *references, size_t count, const double *values, size_t valued)
{
    return count == valued ? fmi2SetReal(self, references, count, values) : 4;
}

int fmi3DoStep(plant *self, double now, double step, bool kept, bool *event, bool *over, bool *early, double *reached)
{
    *event = false;
    *over = status(self, 6, self->steps) != 0;
    *early = status(self, 7, self->steps) != 0;
    *reached = now + step;
    return fmi2DoStep(self, now, step, kept);
}

int fmi3GetFloat64(plant *self, const uint32_t *references, size_t count, double *values, size_t valued)
{
    return count == valued ? fmi2GetReal(self, references, count, values) : 4;
}
