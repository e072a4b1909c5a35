/* Co-simulation: the integrator of an instance. */

#include <math.h>

#include "core.h"

/* Of the integrator in one communication step: more would keep the master for minutes, or for ever. */
#define MOST_STEPS 1e8
#define LOOKS 1000

static bool finite_value(double x) { return x - x == 0.0; }

/* One classical Runge-Kutta step of 4th order. */
static void integrate(const fb_image *image, double h, double *FB_RESTRICT s) {
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
  long long count;
  double h;
  int i, n;
  if (!(fabs(from - now) <= tolerance)) {
    fb_fail(instance, "a step from %.9g s was asked for, but the plant stands at %.9g s", from, now);
    return false;
  }
  if (!(length > 0.0) || !(length <= MOST_STEPS * FB_INNER_STEP)) {
    fb_fail(instance, "a step of %g s is not possible: above 0 to %g s; take it in parts", length, MOST_STEPS * FB_INNER_STEP);
    return false;
  }
  if (image->stop_time_defined && from + length > image->stop_time + tolerance) {
    fb_fail(instance, "a step to %.9g s leads past the stop time %.9g s", from + length, image->stop_time);
    return false;
  }
  count = (long long)(length / FB_INNER_STEP + 0.999999);
  if (count < 1) count = 1;
  h = length / (double)count;
  fb_refresh_constants(image);
  /* A long step that has run away ends soon. */
  for (; count > 0; count -= LOOKS) {
    int part = count < LOOKS ? (int)count : LOOKS;
    for (n = 0; n < part; n++) integrate(image, h, image->states);
    for (i = 0; i < FB_STATES; i++)
      if (!finite_value(image->states[i])) {
        fb_fail(instance, "%s ran away between %.9g s and %.9g s", fb_state_names[i], from, from + length);
        return false;
      }
  }
  image->values[0] = from + length;
  image->fresh = FB_FIRST_READING;
  return true;
}
