/* What compilers call the same thing by different names; MSVC is one of them, and older C is another. */

#ifndef FB_COMPILER_H
#define FB_COMPILER_H

#if defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define FB_INLINE static inline
#define FB_RESTRICT restrict
#elif defined(_MSC_VER) || defined(__GNUC__)
#define FB_INLINE static __inline
#define FB_RESTRICT __restrict
#else
#define FB_INLINE static
#define FB_RESTRICT
#endif

/* Contraction into fused multiply-adds would give other bits; others are told on the command line. */
#if defined(_MSC_VER)
#pragma fp_contract(off)
#endif

#endif
