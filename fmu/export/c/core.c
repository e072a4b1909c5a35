/* Values, phases and the integrator of one instance. */

#include "core.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FB_MESSAGE 256

static bool finite_value(double x) { return x - x == 0.0; }

void fb_fail(fb_instance *instance, const char *format, ...) {
  char message[FB_MESSAGE];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  instance->image.phase = FB_FAILED;
  fb_log_error(instance->environment, instance->logger, instance->name, message);
}

bool fb_allowed(fb_instance *instance, const char *function, int phases) {
  static const char *const names[] = {"instantiated", "initialisation mode", "step mode", "terminated",
                                      "failed"};
  char message[FB_MESSAGE];
  int index = 0;
  if (instance->image.phase & phases) return true;
  while (index < 4 && !(instance->image.phase >> index & 1)) index++;
  snprintf(message, sizeof message, "%s is not allowed in state '%s'", function, names[index]);
  fb_log_error(instance->environment, instance->logger, instance->name, message);
  return false;
}

fb_instance *fb_instantiate(const char *name, const char *token, void *environment, const void *logger,
                            bool logging) {
  fb_instance *instance;
  size_t length;
  if (!name || !*name) {
    fb_log_error(environment, logger, "", "instantiate: the instance needs a name");
    return NULL;
  }
  if (!token || strcmp(token, FB_TOKEN) != 0) {
    fb_log_error(environment, logger, name, "instantiate: the token is not that of modelDescription.xml");
    return NULL;
  }
  length = strlen(name) + 1;
  instance = calloc(1, sizeof *instance);
  if (instance) instance->name = malloc(length);
  if (!instance || !instance->name) {
    free(instance);
    fb_log_error(environment, logger, name, "instantiate: out of memory");
    return NULL;
  }
  memcpy(instance->name, name, length);
  instance->environment = environment;
  instance->logger = logger;
  instance->logging = logging;
  fb_reset(instance);
  return instance;
}

void fb_free(fb_instance *instance) {
  if (!instance) return;
  free(instance->name);
  free(instance);
}

void fb_reset(fb_instance *instance) {
  memset(&instance->image, 0, sizeof instance->image);
  memcpy(instance->image.values + FB_FIRST_PARAMETER, fb_parameter_starts, sizeof fb_parameter_starts);
  instance->image.phase = FB_INSTANTIATED;
  instance->image.stale_constants = true;
  instance->image.stale_readings = true;
}

static void refresh(fb_image *image) {
  const double *p = image->values + FB_FIRST_PARAMETER;
  if (image->stale_constants) {
    fb_constants(p, image->constants);
    fb_starts(p, image->constants, image->states);
    image->stale_constants = false;
  }
  fb_readings(image->states, image->values + FB_FIRST_INPUT, p, image->constants,
              image->values + FB_FIRST_READING);
  image->stale_readings = false;
}

bool fb_enter_initialisation(fb_instance *instance, double start_time, bool stop_defined, double stop_time) {
  fb_image *image = &instance->image;
  if (!finite_value(start_time) || (stop_defined && !(stop_time > start_time))) {
    fb_fail(instance, "start time %g s and stop time %g s make no interval", start_time, stop_time);
    return false;
  }
  image->values[0] = start_time;
  image->stop_time_defined = stop_defined;
  image->stop_time = stop_time;
  image->phase = FB_INITIALISING;
  return true;
}

bool fb_exit_initialisation(fb_instance *instance) {
  fb_image *image = &instance->image;
  int i;
  refresh(image);
  for (i = FB_FIRST_READING; i < FB_VARIABLES; i++)
    if (!finite_value(image->values[i])) {
      fb_fail(instance, "%s is not a number: the parameters contradict each other", fb_names[i]);
      return false;
    }
  image->phase = FB_STEPPING;
  return true;
}

bool fb_set(fb_instance *instance, const unsigned *references, size_t count, const double *values) {
  fb_image *image = &instance->image;
  size_t i;
  for (i = 0; i < count; i++) {
    unsigned reference = references[i];
    double value = values[i];
    int state = -1;
    if (reference >= FB_VARIABLES || reference == 0) {
      fb_fail(instance, "no variable with value reference %u can be set", reference);
      return false;
    }
    if (!finite_value(value)) {
      fb_fail(instance, "%s cannot be %g", fb_names[reference], value);
      return false;
    }
    if (reference >= FB_FIRST_READING) state = fb_state_of_reading[reference - FB_FIRST_READING];
    if (reference >= FB_FIRST_READING && state < 0) {
      fb_fail(instance, "%s is computed and cannot be set", fb_names[reference]);
      return false;
    }
    if (reference >= FB_FIRST_PARAMETER) {
      if (!(image->phase & (FB_INSTANTIATED | FB_INITIALISING))) {
        fb_fail(instance, "%s can be set only before the end of initialisation", fb_names[reference]);
        return false;
      }
      image->stale_constants = true;
    }
    image->values[reference] = value;
    if (state >= 0) image->states[state] = value;
  }
  image->stale_readings = true;
  return true;
}

bool fb_get(fb_instance *instance, const unsigned *references, size_t count, double *values) {
  fb_image *image = &instance->image;
  size_t i;
  if (image->stale_readings) refresh(image);
  for (i = 0; i < count; i++) {
    if (references[i] >= FB_VARIABLES) {
      fb_fail(instance, "there is no variable with value reference %u", references[i]);
      return false;
    }
    values[i] = image->values[references[i]];
  }
  return true;
}

/* One classical Runge-Kutta step of 4th order. */
static void integrate(const fb_image *image, double h, double *restrict s) {
  const double *u = image->values + FB_FIRST_INPUT;
  const double *p = image->values + FB_FIRST_PARAMETER;
  const double *k = image->constants;
  double rate[FB_STATES], sum[FB_STATES], at[FB_STATES];
  int i;
  fb_rates(s, u, p, k, rate);
  for (i = 0; i < FB_STATES; i++) {
    sum[i] = rate[i];
    at[i] = s[i] + 0.5 * h * rate[i];
  }
  fb_rates(at, u, p, k, rate);
  for (i = 0; i < FB_STATES; i++) {
    sum[i] += 2.0 * rate[i];
    at[i] = s[i] + 0.5 * h * rate[i];
  }
  fb_rates(at, u, p, k, rate);
  for (i = 0; i < FB_STATES; i++) {
    sum[i] += 2.0 * rate[i];
    at[i] = s[i] + h * rate[i];
  }
  fb_rates(at, u, p, k, rate);
  for (i = 0; i < FB_STATES; i++) s[i] += h / 6.0 * (sum[i] + rate[i]);
}

bool fb_step(fb_instance *instance, double from, double length) {
  fb_image *image = &instance->image;
  double now = image->values[0];
  double tolerance = 1e-9 * (1.0 + fabs(now));
  long count, n;
  int i;
  if (!(fabs(from - now) <= tolerance)) {
    fb_fail(instance, "a step from %.9g s was asked for, but the plant stands at %.9g s", from, now);
    return false;
  }
  if (!(length > 0.0) || !(length <= 1e6 * FB_INNER_STEP)) {
    fb_fail(instance, "a step of %g s is not possible: above 0 to %g s", length, 1e6 * FB_INNER_STEP);
    return false;
  }
  if (image->stop_time_defined && from + length > image->stop_time + tolerance) {
    fb_fail(instance, "a step to %.9g s leads past the stop time %.9g s", from + length, image->stop_time);
    return false;
  }
  count = (long)(length / FB_INNER_STEP + 0.999999);
  if (count < 1) count = 1;
  for (n = 0; n < count; n++) integrate(image, length / (double)count, image->states);
  for (i = 0; i < FB_STATES; i++)
    if (!finite_value(image->states[i])) {
      fb_fail(instance, "%s ran away between %.9g s and %.9g s", fb_state_names[i], from, from + length);
      return false;
    }
  image->values[0] = from + length;
  image->stale_readings = true;
  return true;
}
