/* Whole numbers of 64 bits as Python reckons them. */
#ifndef SERVO_ARITHMETIC_H
#define SERVO_ARITHMETIC_H

#include <stdbool.h>
#include <stdint.h>

/* Shifts to the right round towards minus infinity, as in Python. */
typedef char right_shift_is_arithmetic[(-1 >> 1) == -1 ? 1 : -1];

static inline int64_t shifted(int64_t value, int64_t places) { return value * ((int64_t)1 << places); }

static inline int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

static inline int64_t largest(int64_t a, int64_t b) { return a > b ? a : b; }

static inline bool beyond(int64_t value, int64_t limit) { return value > limit || -value > limit; }

static inline int64_t within(int64_t value, int64_t widest)
{
    return value > widest ? widest : largest(value, -widest);
}

static inline int64_t floor_division(int64_t dividend, int64_t divisor)
{
    int64_t quotient = dividend / divisor;
    return quotient * divisor != dividend && (dividend < 0) != (divisor < 0) ? quotient - 1 : quotient;
}

static inline int64_t whole_root(int64_t square)
{
    uint64_t rest = (uint64_t)square, root = 0, bit = (uint64_t)1 << 62;
    while (bit > rest)
        bit >>= 2;
    for (; bit; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (int64_t)root;
}

#endif
