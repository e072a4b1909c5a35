/* Copies of one part side by side: two in a vector register where the compiler has such, else one by one. The
   operations on each copy are the same ones in the same order, so the bits are, too. */

#ifndef FB_LANES_H
#define FB_LANES_H

#include "elementary.h"

#ifdef __GNUC__

typedef double fb_lanes __attribute__((vector_size(16)));
#define FB_GROUPS(copies) (((copies) + 1) / 2)
#define FB_PAIR(x, y) {x, y}
#define FB_ALL(x) ((fb_lanes){x, x})
#define FB_OF(array, copy) array[(copy) / 2][(copy) % 2]

#ifdef __SSE2__
/* What compilers make of a choice for each lane is branches, or three operations for one. */
#include <emmintrin.h>
static inline fb_lanes fb_larger_lanes(fb_lanes x, fb_lanes y) { return _mm_max_pd(x, y); }
static inline fb_lanes fb_smaller_lanes(fb_lanes x, fb_lanes y) { return _mm_min_pd(x, y); }
static inline fb_lanes fb_size_lanes(fb_lanes x) { return _mm_andnot_pd(_mm_set1_pd(-0.0), x); }
static inline fb_lanes fb_root_lanes(fb_lanes x) { return _mm_sqrt_pd(x); }
#else
static inline fb_lanes fb_larger_lanes(fb_lanes x, fb_lanes y) {
  return (fb_lanes){fb_larger(x[0], y[0]), fb_larger(x[1], y[1])};
}
static inline fb_lanes fb_smaller_lanes(fb_lanes x, fb_lanes y) {
  return (fb_lanes){fb_smaller(x[0], y[0]), fb_smaller(x[1], y[1])};
}
static inline fb_lanes fb_size_lanes(fb_lanes x) { return (fb_lanes){fabs(x[0]), fabs(x[1])}; }
static inline fb_lanes fb_root_lanes(fb_lanes x) { return (fb_lanes){sqrt(x[0]), sqrt(x[1])}; }
#endif

#else

typedef double fb_lanes;
#define FB_GROUPS(copies) (((copies) + 1) / 2 * 2)
#define FB_PAIR(x, y) x, y
#define FB_ALL(x) (x)
#define FB_OF(array, copy) array[copy]
static inline fb_lanes fb_larger_lanes(fb_lanes x, fb_lanes y) { return fb_larger(x, y); }
static inline fb_lanes fb_smaller_lanes(fb_lanes x, fb_lanes y) { return fb_smaller(x, y); }
static inline fb_lanes fb_size_lanes(fb_lanes x) { return fabs(x); }
static inline fb_lanes fb_root_lanes(fb_lanes x) { return sqrt(x); }

#endif

static inline fb_lanes fb_positive_part_lanes(fb_lanes x) { return fb_larger_lanes(x, FB_ALL(0.0)); }
static inline fb_lanes fb_clamped_lanes(fb_lanes x, fb_lanes bound) {
  return fb_larger_lanes(-bound, fb_smaller_lanes(bound, x));
}
static inline fb_lanes fb_reciprocal_lanes(fb_lanes x) { return 1.0 / x; }
static inline fb_lanes fb_square_lanes(fb_lanes x) { return x * x; }
static inline fb_lanes fb_cube_lanes(fb_lanes x) { return x * x * x; }
static inline fb_lanes fb_fourth_lanes(fb_lanes x) { return fb_square_lanes(fb_square_lanes(x)); }

#endif
