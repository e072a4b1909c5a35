/* What both FMI shells share: one instance of the model, its values, its integrator. No global state. */

#ifndef FB_CORE_H
#define FB_CORE_H

#include <stdbool.h>
#include <stddef.h>

#include "model.h"

/* Variables by value reference: time, inputs, parameters, readings. */
#define FB_FIRST_INPUT 1
#define FB_FIRST_PARAMETER (FB_FIRST_INPUT + FB_INPUTS)
#define FB_FIRST_READING (FB_FIRST_PARAMETER + FB_PARAMETERS)
#define FB_VARIABLES (FB_FIRST_READING + FB_READINGS)

typedef enum {
  FB_INSTANTIATED = 1,
  FB_INITIALISING = 2,
  FB_STEPPING = 4,
  FB_TERMINATED = 8,
  FB_FAILED = 16
} fb_phase;

/* All that a run changes: saved and restored by copying. */
typedef struct {
  double values[FB_VARIABLES];
  double states[FB_STATES];
  double constants[FB_CONSTANTS];
  double stop_time;
  int phase;
  bool stop_time_defined;
  bool stale_constants;
  bool stale_readings;
} fb_image;

typedef struct {
  fb_image image;
  char *name;
  void *environment;
  const void *logger;
  bool logging;
} fb_instance;

/* Written from the equations. */
extern const char *const fb_names[FB_VARIABLES];
extern const double fb_parameter_starts[FB_PARAMETERS];
extern const char *const fb_state_names[FB_STATES];
extern const int fb_state_of_reading[FB_READINGS]; /* -1: cannot be set */
void fb_constants(const double *restrict p, double *restrict k);
void fb_starts(const double *restrict p, const double *restrict k, double *restrict s);
void fb_rates(const double *restrict s, const double *restrict u, const double *restrict p,
              const double *restrict k, double *restrict rate);
void fb_readings(const double *restrict s, const double *restrict u, const double *restrict p,
                 const double *restrict k, double *restrict reading);

/* The shared part of the shells. Functions that can fail return false after telling the logger why. */
fb_instance *fb_instantiate(const char *name, const char *token, void *environment, const void *logger,
                            bool logging);
void fb_free(fb_instance *instance);
void fb_reset(fb_instance *instance);
bool fb_allowed(fb_instance *instance, const char *function, int phases);
bool fb_enter_initialisation(fb_instance *instance, double start_time, bool stop_defined, double stop_time);
bool fb_exit_initialisation(fb_instance *instance);
bool fb_set(fb_instance *instance, const unsigned *references, size_t count, const double *values);
bool fb_get(fb_instance *instance, const unsigned *references, size_t count, double *values);
bool fb_step(fb_instance *instance, double from, double length);
void fb_fail(fb_instance *instance, const char *format, ...);

/* Given by each shell: pass one finished error message on. Instance may be NULL on instantiation only. */
void fb_log_error(void *environment, const void *logger, const char *name, const char *message);

#endif
