/* What both FMI shells share: one instance of the model, its values, its integrator. No global state. */

#ifndef FB_CORE_H
#define FB_CORE_H

#include <stdbool.h>
#include <stddef.h>

#include "compiler.h"
#include "model.h"

/* Variables by value reference: time, inputs, parameters, prompt and derived outputs, locals, rates of the
   states. */
#define FB_FIRST_INPUT 1
#define FB_FIRST_PARAMETER (FB_FIRST_INPUT + FB_INPUTS)
#define FB_FIRST_READING (FB_FIRST_PARAMETER + FB_PARAMETERS)
#define FB_FIRST_DERIVED (FB_FIRST_READING + FB_PROMPT)
#define FB_FIRST_LOCAL (FB_FIRST_READING + FB_OUTPUTS)
#define FB_READINGS (FB_OUTPUTS + FB_LOCALS)
#define FB_FIRST_RATE (FB_FIRST_READING + FB_READINGS)
#define FB_VARIABLES (FB_FIRST_RATE + FB_STATES)

typedef enum {
  FB_INSTANTIATED = 1,
  FB_INITIALISING = 2,
  FB_STEPPING = 4,    /* co-simulation */
  FB_EVENT = 8,       /* model exchange */
  FB_CONTINUOUS = 16, /* model exchange */
  FB_TERMINATED = 32,
  FB_FAILED = 64
} fb_phase;

#define FB_RUNNING (FB_STEPPING | FB_EVENT | FB_CONTINUOUS)
#define FB_ALIVE (FB_INSTANTIATED | FB_INITIALISING | FB_RUNNING | FB_TERMINATED)

/* The status that a message comes with, as both versions of FMI count it; each has a category. */
typedef enum { FB_OK, FB_WARNING, FB_DISCARD, FB_ERROR } fb_level;

/* What may be set, and when: see fb_set. */
typedef enum { FB_FREE, FB_SWITCH, FB_FIXED, FB_TUNABLE } fb_kind;

/* All that a run changes: saved and restored by copying. */
typedef struct {
  double values[FB_VARIABLES];
  double states[FB_STATES];
  double constants[FB_CONSTANTS];
  double stop_time;
  int phase;
  int fresh; /* variables below this value reference are up to date */
  bool exchange;
  bool stop_time_defined;
  bool stale_constants;
  bool stale_starts;
} fb_image;

typedef struct {
  fb_image image;
  char *name;
  void *environment;
  const void *logger;
  int levels; /* one bit for each fb_level that is logged */
} fb_instance;

/* Written from the equations. */
#define FB_CONST const double *FB_RESTRICT
#define FB_TARGET double *FB_RESTRICT
#define FB_MOMENT FB_CONST s, FB_CONST u, FB_CONST p, FB_CONST k
#define FB_TANGENTS FB_CONST ds, FB_CONST du, FB_CONST dp, FB_CONST dk
extern const char *const fb_names[FB_VARIABLES];
extern const fb_kind fb_kinds[FB_FIRST_READING]; /* of time, inputs and parameters, as the next two */
extern const double fb_least[FB_FIRST_READING];
extern const double fb_most[FB_FIRST_READING];
extern const double fb_parameter_starts[];
extern const char *const fb_state_names[FB_STATES];
extern const double fb_state_nominals[FB_STATES];
extern const int fb_state_of_reading[FB_READINGS]; /* -1: is no state */
extern const int fb_settable_state[FB_READINGS];   /* -1: cannot be set */
extern const int fb_switch_readings[];             /* outputs that change at events alone */
void fb_constants(FB_CONST p, FB_TARGET k);
void fb_starts(FB_CONST p, FB_CONST k, FB_TARGET s);
void fb_rates(FB_MOMENT, FB_TARGET rate);
void fb_outputs(FB_MOMENT, FB_TARGET reading);
void fb_derived(FB_MOMENT, FB_TARGET reading);
void fb_locals(FB_MOMENT, FB_TARGET reading);
void fb_indicators(FB_MOMENT, FB_TARGET indicator);
void fb_constants_tangent(FB_CONST p, FB_CONST dp, FB_TARGET dk);
void fb_starts_tangent(FB_CONST s, FB_CONST p, FB_CONST k, FB_CONST dp, FB_CONST dk, FB_TARGET ds);
void fb_rates_tangent(FB_MOMENT, FB_TANGENTS, FB_TARGET drate);
void fb_outputs_tangent(FB_MOMENT, FB_TANGENTS, FB_TARGET dreading);
void fb_derived_tangent(FB_MOMENT, FB_TANGENTS, FB_TARGET dreading);
void fb_locals_tangent(FB_MOMENT, FB_TANGENTS, FB_TARGET dreading);

/* The shared part of the shells. Functions that can fail return false after telling the logger why. */
fb_instance *fb_instantiate(const char *name, const char *token, void *environment, const void *logger,
                            bool logging, bool exchange);
void fb_free(fb_instance *instance);
void fb_reset(fb_instance *instance);
void fb_move(fb_instance *instance, fb_phase phase);
bool fb_enter_initialisation(fb_instance *instance, double start_time, bool stop_defined, double stop_time);
bool fb_exit_initialisation(fb_instance *instance);
fb_level fb_set(fb_instance *instance, const unsigned *references, size_t count, const double *values);
bool fb_get(fb_instance *instance, const unsigned *references, size_t count, double *values);
void fb_refresh_constants(fb_image *image);

/* Co-simulation: step.c */
bool fb_step(fb_instance *instance, double from, double length);

/* Model exchange: exchange.c */
bool fb_set_time(fb_instance *instance, double time);
bool fb_set_states(fb_instance *instance, const double *states, size_t count);
bool fb_get_states(fb_instance *instance, double *states, size_t count);
bool fb_get_nominals(fb_instance *instance, double *nominals, size_t count);
fb_level fb_get_rates(fb_instance *instance, double *rates, size_t count);
bool fb_get_indicators(fb_instance *instance, double *indicators, size_t count);

/* Directional derivatives: slopes.c */
bool fb_slopes(fb_instance *instance, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
               size_t known_count, const double *seed, double *slopes);

/* Saved states: states.c */
bool fb_save(fb_instance *instance, void **state);
bool fb_restore(fb_instance *instance, const void *state);
size_t fb_serial_size(void);
bool fb_serialise(fb_instance *instance, const void *state, char *bytes, size_t size);
bool fb_deserialise(fb_instance *instance, const char *bytes, size_t size, void **state);

/* Messages: messages.c */
bool fb_allowed(fb_instance *instance, const char *function, int phases);
bool fb_given(fb_instance *instance, const char *function, const char *argument, const void *pointer, size_t count);
void fb_fail(fb_instance *instance, const char *format, ...);
void fb_say(fb_instance *instance, fb_level level, const char *format, ...);
bool fb_listen(fb_instance *instance, bool on, size_t count, const char *const *categories);
extern const char *const fb_categories[4];

/* Given by each shell: pass one finished message on. */
void fb_emit(void *environment, const void *logger, const char *name, fb_level level, const char *message);

#endif
