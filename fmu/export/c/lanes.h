/* Two copies of one part side by side, in one vector register where the machine has such. The operations on each
   are the same ones in the same order as alone, so the bits are, too; -DFB_ALONE does without. */

#ifndef FB_LANES_H
#define FB_LANES_H

#include "elementary.h"

#if defined(__GNUC__) && !defined(FB_ALONE)

typedef double fb_lanes __attribute__((vector_size(16)));
#define FB_LANES 2
static inline fb_lanes fb_both(double x) { return (fb_lanes){x, x}; }

#ifdef __SSE2__
/* Of a choice for each lane compilers make branches, or three operations for one. */
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

static inline fb_lanes fb_positive_part_lanes(fb_lanes x) { return fb_larger_lanes(x, fb_both(0.0)); }
static inline fb_lanes fb_clamped_lanes(fb_lanes x, fb_lanes bound) {
  return fb_larger_lanes(-bound, fb_smaller_lanes(bound, x));
}
static inline fb_lanes fb_reciprocal_lanes(fb_lanes x) { return 1.0 / x; }
static inline fb_lanes fb_square_lanes(fb_lanes x) { return x * x; }
static inline fb_lanes fb_cube_lanes(fb_lanes x) { return x * x * x; }
static inline fb_lanes fb_fourth_lanes(fb_lanes x) { return fb_square_lanes(fb_square_lanes(x)); }

#endif

#endif
