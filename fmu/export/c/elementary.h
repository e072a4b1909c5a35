/* Sine, cosine and arc tangent from additions, multiplications, divisions alone: the same bits with every
   compiler and on every CPU, which the C library does not promise. Errors below 1.5e-16 + 1 ulp for
   |x| up to 1e6 (sine, cosine) and everywhere (arc tangent); a test holds them to it. */

#ifndef FB_ELEMENTARY_H
#define FB_ELEMENTARY_H

#include <math.h>

#include "compiler.h"

#define FB_HALF_PI 1.5707963267948966
#define FB_HALF_PI_HIGH 1.5707963267341256
#define FB_HALF_PI_MIDDLE 6.077100506303966e-11
#define FB_HALF_PI_LOW 2.0222662487959506e-21

FB_INLINE double fb_square(double x) { return x * x; }
FB_INLINE double fb_cube(double x) { return x * x * x; }
FB_INLINE double fb_positive_part(double x) { return x > 0.0 ? x : 0.0; }
FB_INLINE double fb_larger(double x, double y) { return x > y ? x : y; }
FB_INLINE double fb_smaller(double x, double y) { return x < y ? x : y; }
FB_INLINE double fb_clamped(double x, double bound) { return fb_larger(-bound, fb_smaller(bound, x)); }
FB_INLINE double fb_reciprocal(double x) { return 1.0 / x; }
FB_INLINE double fb_fourth(double x) { return fb_square(fb_square(x)); }

/* Slopes of |x|, positive_part(x), clamped(x, b) by x and by b, and of the square root: 0 at their corners. */
FB_INLINE double fb_sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
FB_INLINE double fb_step_at(double x) { return x > 0.0 ? 1.0 : 0.0; }
FB_INLINE double fb_inside(double x, double bound) { return x < bound && x > -bound ? 1.0 : 0.0; }
FB_INLINE double fb_outside(double x, double bound) { return x > bound ? 1.0 : x < -bound ? -1.0 : 0.0; }
FB_INLINE double fb_root_slope(double x) { return x > 0.0 ? 0.5 / sqrt(x) : 0.0; }

/* Taylor series on -pi/4..pi/4; the first neglected terms are below 1e-19 and 3e-18. The sums are taken in
   pairs (Estrin): each pair can be computed while another one is. */
FB_INLINE double fb_sine_core(double x) {
  double z = x * x;
  double y = z * z;
  double r0 = z * (1.0 / 120.0) - 1.0 / 6.0;
  double r1 = z * (1.0 / 362880.0) - 1.0 / 5040.0;
  double r2 = z * (1.0 / 6227020800.0) - 1.0 / 39916800.0;
  double r3 = z * (1.0 / 355687428096000.0) - 1.0 / 1307674368000.0;
  double r = (y * y) * (y * r3 + r2) + (y * r1 + r0);
  return x + x * z * r;
}

FB_INLINE double fb_cosine_core(double x) {
  double z = x * x;
  double y = z * z;
  double r0 = 1.0 / 24.0 - z * (1.0 / 720.0);
  double r1 = 1.0 / 40320.0 - z * (1.0 / 3628800.0);
  double r2 = 1.0 / 479001600.0 - z * (1.0 / 87178291200.0);
  double r = (y * y) * (y * (1.0 / 20922789888000.0) + r2) + (y * r1 + r0);
  return 1.0 - (0.5 * z - z * z * r);
}

/* Subtract the nearest multiple of pi/2; pi/2 in three parts, the first two of 33 bits, so that their
   products with the count are exact up to 2^20 quarter turns. Adding 1.5 * 2^52 rounds to an integer. */
FB_INLINE double fb_reduce(double x, int *quarter) {
  const double magic = 6755399441055744.0;
  double count = (x * 0.63661977236758134 + magic) - magic;
  double scaled = count - 4.0 * ((count * 0.25 + magic) - magic);
  *quarter = (int)scaled & 3;
  return ((x - count * FB_HALF_PI_HIGH) - count * FB_HALF_PI_MIDDLE) - count * FB_HALF_PI_LOW;
}

FB_INLINE double fb_sine(double x) {
  int quarter;
  double rest = fb_reduce(x, &quarter);
  double value = (quarter & 1) ? fb_cosine_core(rest) : fb_sine_core(rest);
  return (quarter & 2) ? -value : value;
}

FB_INLINE double fb_cosine(double x) {
  int quarter;
  double rest = fb_reduce(x, &quarter);
  double value = (quarter & 1) ? fb_sine_core(rest) : fb_cosine_core(rest);
  return (quarter == 1 || quarter == 2) ? -value : value;
}

/* Chebyshev fit of (atan(t) / t - 1) / t2 for |t| up to tan(pi/8), error 3e-17. */
FB_INLINE double fb_arc_tangent_core(double t) {
  double z = t * t;
  double y = z * z;
  double w = y * y;
  double r0 = z * 0.1999999999999552 - 0.3333333333333333;
  double r1 = z * 0.11111111015256361 - 0.14285714284666542;
  double r2 = z * 0.07692183190826087 - 0.09090904578123903;
  double r3 = z * 0.0585814891280221 - 0.06664511447381948;
  double r4 = z * 0.03923165829558719 - 0.0508544973794026;
  double r = w * (w * (r4 - y * 0.01917688711906226) + (y * r3 + r2)) + (y * r1 + r0);
  return t + t * z * r;
}

/* The angle of the way (x, y), x above 0, by one division: larger ones by atan(q) = pi/4 + atan((q - 1) / (q + 1))
   and atan(q) = pi/2 - atan(1 / q). */
FB_INLINE double fb_angle(double y, double x) {
  double size = fabs(y), value;
  if (size <= x * 0.41421356237309503) return fb_arc_tangent_core(y / x);
  if (size <= x * 2.414213562373095)
    value = 0.5 * FB_HALF_PI + fb_arc_tangent_core((size - x) / (size + x));
  else
    value = FB_HALF_PI - fb_arc_tangent_core(x / size);
  return y < 0.0 ? -value : value;
}

FB_INLINE double fb_arc_tangent(double x) { return fb_angle(x, 1.0); }

#endif
