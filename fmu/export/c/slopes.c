/* Directional derivatives: one pass through the tangents of the equations. */

#include "core.h"

typedef struct {
  double u[FB_INPUTS + 1], p[FB_PARAMETERS + 1], s[FB_STATES], k[FB_CONSTANTS];
  double unknown[FB_READINGS + FB_STATES];
} fb_slope;

/* Where the seed of this known goes; NULL where it is none in this phase. */
static double *place(const fb_image *image, fb_slope *slope, unsigned reference) {
  bool starting = image->phase == FB_INITIALISING;
  const int *states = starting ? fb_settable_state : fb_state_of_reading;
  if (reference >= FB_FIRST_INPUT && reference < FB_FIRST_PARAMETER)
    return slope->u + (reference - FB_FIRST_INPUT);
  if (starting && reference >= FB_FIRST_PARAMETER && reference < FB_FIRST_READING)
    return slope->p + (reference - FB_FIRST_PARAMETER);
  if (reference >= FB_FIRST_READING && reference < FB_FIRST_RATE && states[reference - FB_FIRST_READING] >= 0)
    return slope->s + states[reference - FB_FIRST_READING];
  return NULL;
}

static const char *name_of(unsigned reference) {
  return reference < FB_VARIABLES ? fb_names[reference] : "a variable that there is not";
}

bool fb_slopes(fb_instance *instance, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns,
               size_t known_count, const double *seed, double *slopes) {
  fb_image *image = &instance->image;
  const double *u = image->values + FB_FIRST_INPUT, *p = image->values + FB_FIRST_PARAMETER;
  const double *k = image->constants, *s = image->states;
  fb_slope slope = {{0}, {0}, {0}, {0}, {0}};
  bool outputs = false, derived = false, locals = false, rates = false;
  size_t i;
  for (i = 0; i < known_count; i++) {
    double *at;
    if (knowns[i] == 0) continue; /* The time: nothing hangs on it. */
    at = place(image, &slope, knowns[i]);
    if (!at) {
      fb_fail(instance, "%s is no known of directional derivatives in this state", name_of(knowns[i]));
      return false;
    }
    *at += seed[i];
  }
  for (i = 0; i < unknown_count; i++) {
    if (unknowns[i] < FB_FIRST_READING || unknowns[i] >= FB_VARIABLES) {
      fb_fail(instance, "%s is no unknown of directional derivatives", name_of(unknowns[i]));
      return false;
    }
    rates |= unknowns[i] >= FB_FIRST_RATE;
    locals |= unknowns[i] >= FB_FIRST_LOCAL && unknowns[i] < FB_FIRST_RATE;
    derived |= unknowns[i] >= FB_FIRST_DERIVED && unknowns[i] < FB_FIRST_LOCAL;
    outputs |= unknowns[i] < FB_FIRST_DERIVED;
  }
  fb_refresh_constants(image);
  if (image->phase == FB_INITIALISING) {
    fb_constants_tangent(p, slope.p, slope.k);
    fb_starts_tangent(s, p, k, slope.p, slope.k, slope.s);
  }
  if (outputs) fb_outputs_tangent(s, u, p, k, slope.s, slope.u, slope.p, slope.k, slope.unknown);
  if (derived) fb_derived_tangent(s, u, p, k, slope.s, slope.u, slope.p, slope.k, slope.unknown);
  if (locals) fb_locals_tangent(s, u, p, k, slope.s, slope.u, slope.p, slope.k, slope.unknown);
  if (rates) fb_rates_tangent(s, u, p, k, slope.s, slope.u, slope.p, slope.k, slope.unknown + FB_READINGS);
  for (i = 0; i < unknown_count; i++) slopes[i] = slope.unknown[unknowns[i] - FB_FIRST_READING];
  return true;
}
