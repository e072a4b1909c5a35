/* Model exchange: time and states come from the master's solver, rates and event indicators go back.
   Rates hold on both sides of an event, so that a master may pass it by; switches wait for it. */

#include <string.h>

#include "core.h"

static bool finite_value(double x) { return x - x == 0.0; }

static bool counted(fb_instance *instance, size_t count) {
  if (count == FB_STATES) return true;
  fb_fail(instance, "%u continuous states were given, but there are %d", (unsigned)count, FB_STATES);
  return false;
}

bool fb_set_time(fb_instance *instance, double time) {
  if (!finite_value(time)) {
    fb_fail(instance, "time cannot be %g", time);
    return false;
  }
  instance->image.values[0] = time;
  return true;
}

bool fb_set_states(fb_instance *instance, const double *states, size_t count) {
  size_t i;
  if (!counted(instance, count)) return false;
  for (i = 0; i < count; i++)
    if (!finite_value(states[i])) {
      fb_fail(instance, "%s cannot be %g", fb_state_names[i], states[i]);
      return false;
    }
  memcpy(instance->image.states, states, sizeof instance->image.states);
  instance->image.fresh = FB_FIRST_READING;
  return true;
}

bool fb_get_states(fb_instance *instance, double *states, size_t count) {
  if (!counted(instance, count)) return false;
  fb_refresh_constants(&instance->image);
  memcpy(states, instance->image.states, sizeof instance->image.states);
  return true;
}

bool fb_get_nominals(fb_instance *instance, double *nominals, size_t count) {
  if (!counted(instance, count)) return false;
  memcpy(nominals, fb_state_nominals, sizeof fb_state_nominals);
  return true;
}

fb_level fb_get_rates(fb_instance *instance, double *rates, size_t count) {
  const fb_image *image = &instance->image;
  size_t i;
  if (!counted(instance, count)) return FB_ERROR;
  fb_refresh_constants(&instance->image);
  fb_rates(image->states, image->values + FB_FIRST_INPUT, image->values + FB_FIRST_PARAMETER, image->constants,
           rates);
  for (i = 0; i < count; i++)
    if (!finite_value(rates[i])) {
      fb_say(instance, FB_DISCARD, "the rate of %s is not finite at %.9g s", fb_state_names[i], image->values[0]);
      return FB_DISCARD;
    }
  return FB_OK;
}

bool fb_get_indicators(fb_instance *instance, double *indicators, size_t count) {
  const fb_image *image = &instance->image;
  if (count != FB_INDICATORS) {
    fb_fail(instance, "%u event indicators were asked for, but there are %d", (unsigned)count, FB_INDICATORS);
    return false;
  }
  fb_refresh_constants(&instance->image);
  fb_indicators(image->states, image->values + FB_FIRST_INPUT, image->values + FB_FIRST_PARAMETER,
                image->constants, indicators);
  return true;
}
