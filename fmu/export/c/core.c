/* Values and phases of one instance. */

#include "core.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool finite_value(double x) { return x - x == 0.0; }

fb_instance *fb_instantiate(const char *name, const char *token, void *environment, const void *logger,
                            bool logging, bool exchange) {
  fb_instance *instance;
  size_t length;
  if (!name || !*name) {
    fb_emit(environment, logger, "", FB_ERROR, "instantiate: the instance needs a name");
    return NULL;
  }
  if (!token || strcmp(token, FB_TOKEN) != 0) {
    fb_emit(environment, logger, name, FB_ERROR, "instantiate: the token is not that of modelDescription.xml");
    return NULL;
  }
  length = strlen(name) + 1;
  instance = calloc(1, sizeof *instance);
  if (instance) instance->name = malloc(length);
  if (!instance || !instance->name) {
    free(instance);
    fb_emit(environment, logger, name, FB_ERROR, "instantiate: out of memory");
    return NULL;
  }
  memcpy(instance->name, name, length);
  instance->environment = environment;
  instance->logger = logger;
  instance->levels = logging ? ~0 : 0;
  instance->image.exchange = exchange;
  fb_reset(instance);
  fb_say(instance, FB_OK, "instantiated for %s", exchange ? "model exchange" : "co-simulation");
  return instance;
}

void fb_free(fb_instance *instance) {
  if (!instance) return;
  free(instance->name);
  free(instance);
}

void fb_reset(fb_instance *instance) {
  fb_image *image = &instance->image;
  bool exchange = image->exchange;
  memset(image, 0, sizeof *image);
  memcpy(image->values + FB_FIRST_PARAMETER, fb_parameter_starts, FB_PARAMETERS * sizeof(double));
  image->exchange = exchange;
  image->phase = FB_INSTANTIATED;
  image->stale_constants = image->stale_starts = true;
  image->fresh = FB_FIRST_READING;
}

static void refresh(fb_image *image, int reference);

void fb_move(fb_instance *instance, fb_phase phase) {
  /* What an event has changed is known before continuous time goes on. */
  if (phase == FB_CONTINUOUS) refresh(&instance->image, FB_FIRST_READING);
  if (phase == FB_EVENT) instance->image.fresh = FB_FIRST_READING;
  if (phase == FB_TERMINATED) fb_say(instance, FB_OK, "terminated at %.9g s", instance->image.values[0]);
  instance->image.phase = phase;
}

void fb_refresh_constants(fb_image *image) {
  const double *p = image->values + FB_FIRST_PARAMETER;
  if (!image->stale_constants) return;
  fb_constants(p, image->constants);
  /* A parameter that is tuned in a run moves nothing. */
  if (image->stale_starts) fb_starts(p, image->constants, image->states);
  image->stale_constants = image->stale_starts = false;
}

/* A solver stops on an edge, a rounding before it or behind: at an event, switches look so far ahead, in s. */
#define AHEAD 1e-9

/* Prompt outputs; those of switches keep in continuous time what they had at the last event. */
static void read_outputs(fb_image *image) {
  const double *u = image->values + FB_FIRST_INPUT, *p = image->values + FB_FIRST_PARAMETER;
  double *reading = image->values + FB_FIRST_READING;
  double held[FB_SWITCHES + 1];
  int i;
  for (i = 0; i < FB_SWITCHES; i++) held[i] = reading[fb_switch_readings[i]];
  if (FB_SWITCHES > 0 && image->phase == FB_EVENT) {
    double ahead[FB_STATES], rate[FB_STATES];
    fb_rates(image->states, u, p, image->constants, rate);
    for (i = 0; i < FB_STATES; i++) ahead[i] = image->states[i] + AHEAD * rate[i];
    fb_outputs(ahead, u, p, image->constants, reading);
    for (i = 0; i < FB_SWITCHES; i++) held[i] = reading[fb_switch_readings[i]];
  }
  fb_outputs(image->states, u, p, image->constants, reading);
  if (image->phase == FB_CONTINUOUS || image->phase == FB_EVENT)
    for (i = 0; i < FB_SWITCHES; i++) reading[fb_switch_readings[i]] = held[i];
}

/* Bring all variables up to the group of this one up to date: prompt outputs, derived ones, locals, rates. */
static void refresh(fb_image *image, int reference) {
  const double *u = image->values + FB_FIRST_INPUT;
  const double *p = image->values + FB_FIRST_PARAMETER;
  fb_refresh_constants(image);
  if (image->fresh < FB_FIRST_DERIVED) {
    read_outputs(image);
    image->fresh = FB_FIRST_DERIVED;
  }
  if (reference >= FB_FIRST_DERIVED && image->fresh < FB_FIRST_LOCAL) {
    fb_derived(image->states, u, p, image->constants, image->values + FB_FIRST_READING);
    image->fresh = FB_FIRST_LOCAL;
  }
  if (reference >= FB_FIRST_LOCAL && image->fresh < FB_FIRST_RATE) {
    fb_locals(image->states, u, p, image->constants, image->values + FB_FIRST_READING);
    image->fresh = FB_FIRST_RATE;
  }
  if (reference >= FB_FIRST_RATE && image->fresh < FB_VARIABLES) {
    fb_rates(image->states, u, p, image->constants, image->values + FB_FIRST_RATE);
    image->fresh = FB_VARIABLES;
  }
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
  refresh(image, FB_VARIABLES);
  for (i = FB_FIRST_READING; i < FB_VARIABLES; i++)
    if (!finite_value(image->values[i])) {
      fb_fail(instance, "%s is not a number: the parameters contradict each other", fb_names[i]);
      return false;
    }
  image->phase = image->exchange ? FB_EVENT : FB_STEPPING;
  fb_say(instance, FB_OK, "initialised at %.9g s", image->values[0]);
  return true;
}

/* Take the value of an input or parameter; false after telling why not. */
static bool acceptable(fb_instance *instance, unsigned reference, double *value, bool *clamped) {
  const char *name = fb_names[reference];
  double least = fb_least[reference], most = fb_most[reference];
  int phase = instance->image.phase;
  fb_kind kind = fb_kinds[reference];
  if (kind == FB_SWITCH && phase == FB_CONTINUOUS) {
    fb_fail(instance, "%s is a switch: it can be set in event mode, not in continuous time", name);
    return false;
  }
  if (kind == FB_FIXED && !(phase & (FB_INSTANTIATED | FB_INITIALISING))) {
    fb_fail(instance, "%s can be set only before the end of initialisation", name);
    return false;
  }
  if (kind == FB_TUNABLE && phase == FB_CONTINUOUS) {
    fb_fail(instance, "%s can be tuned in event mode, not in continuous time", name);
    return false;
  }
  if (*value >= least && *value <= most) return true;
  if (kind == FB_SWITCH) {
    double nearest = *value < least ? least : most;
    if (instance->image.values[reference] != nearest)
      fb_say(instance, FB_WARNING, "%s is a switch, %g open to %g closed: %g is taken as %g", name, least, most,
             *value, nearest);
    *value = nearest;
    *clamped = true;
    return true;
  }
  if (*value < least)
    fb_fail(instance, "%s cannot be %g: it is %g or more", name, *value, least);
  else
    fb_fail(instance, "%s cannot be %g: it is %g or less", name, *value, most);
  return false;
}

fb_level fb_set(fb_instance *instance, const unsigned *references, size_t count, const double *values) {
  fb_image *image = &instance->image;
  bool clamped = false;
  size_t i;
  for (i = 0; i < count; i++) {
    unsigned reference = references[i];
    double value = values[i];
    int state = -1;
    if (reference >= FB_VARIABLES || reference == 0) {
      fb_fail(instance, "no variable with value reference %u can be set", reference);
      return FB_ERROR;
    }
    if (!finite_value(value)) {
      fb_fail(instance, "%s cannot be %g", fb_names[reference], value);
      return FB_ERROR;
    }
    if (reference < FB_FIRST_READING) {
      /* Most calls set the voltages of a model without switches. */
      if ((FB_SWITCH_INPUTS || reference >= FB_FIRST_PARAMETER) && fb_kinds[reference] != FB_FREE &&
          !acceptable(instance, reference, &value, &clamped))
        return FB_ERROR;
    } else {
      if (reference < FB_FIRST_RATE) state = fb_settable_state[reference - FB_FIRST_READING];
      if (state < 0) {
        fb_fail(instance, "%s is computed and cannot be set", fb_names[reference]);
        return FB_ERROR;
      }
      if (!(image->phase & (FB_INSTANTIATED | FB_INITIALISING))) {
        fb_fail(instance, "%s can be set only before the end of initialisation", fb_names[reference]);
        return FB_ERROR;
      }
    }
    if (reference >= FB_FIRST_PARAMETER) {
      image->stale_constants = true;
      if (image->phase & (FB_INSTANTIATED | FB_INITIALISING)) image->stale_starts = true;
    }
    image->values[reference] = value;
    if (state >= 0) image->states[state] = value;
  }
  image->fresh = FB_FIRST_READING;
  return clamped ? FB_WARNING : FB_OK;
}

bool fb_get(fb_instance *instance, const unsigned *references, size_t count, double *values) {
  fb_image *image = &instance->image;
  size_t i;
  for (i = 0; i < count; i++) {
    if (references[i] >= FB_VARIABLES) {
      fb_fail(instance, "there is no variable with value reference %u", references[i]);
      return false;
    }
    if ((int)references[i] >= image->fresh) refresh(image, (int)references[i]);
    values[i] = image->values[references[i]];
  }
  return true;
}
