"""Numbers as the AVR has them: int of 16 bits, long of 32, division towards zero, float of 32 bits.

Source: the C standard; avr-libc. Overflow of a signed number wraps here, as the machine's code for it does.
"""

import math
from struct import Struct
from typing import Final

_FLOAT: Final = Struct("<f")
_DIGITS: Final = b"0123456789"
_BLANKS: Final = b" \t\n\v\f\r"


def wrapped(value: int, bits: int) -> int:
    """Return the low bits of a number as a signed one."""
    half = 1 << (bits - 1)
    return (value + half) % (1 << bits) - half


def int16(value: int) -> int:
    """Return an int."""
    return wrapped(value, 16)


def int32(value: int) -> int:
    """Return a long."""
    return wrapped(value, 32)


def float32(value: float) -> float:
    """Return a float, or a double, which is one here; OverflowError beyond its range.

    What +, -, * and / give of two of them in 64 bits, rounded once more, is what they give in 32.
    """
    rounded: float = _FLOAT.unpack(_FLOAT.pack(value))[0]
    return rounded


def quotient(dividend: int, divisor: int) -> int:
    """Return a long divided, towards zero.

    By zero, which C leaves undefined, libgcc's loop gives all ones, with the dividend's sign: so does the
    sketch's binary in simavr.
    """
    if divisor == 0:
        return 1 if dividend < 0 else -1
    size = abs(dividend) // abs(divisor)
    return int32(-size if (dividend < 0) != (divisor < 0) else size)


def atoi(text: bytes) -> int:
    """Return the number that a text begins with, as avr-libc reads it: 16 bits, 0 for none."""
    text = text.lstrip(_BLANKS)
    negative = text[:1] == b"-"
    value = 0
    for byte in text[1:] if text[:1] in {b"-", b"+"} else text:
        if byte not in _DIGITS:
            break
        # Wrapped at each digit, as the 16-bit sum of avr-libc is.
        value = int16(10 * value + byte - 0x30)
    return int16(-value if negative else value)


def single(value: float) -> float:
    """Return a float as a sum, a product or a division leaves it: infinite beyond its range."""
    try:
        return float32(value)
    except OverflowError:
        return math.copysign(math.inf, value)


def divided(dividend: float, divisor: float) -> float:
    """Return a float divided; by zero infinite, and none at all for zero by zero."""
    if divisor == 0.0:
        sign = math.copysign(1.0, divisor)
        return math.nan if dividend == 0.0 or math.isnan(dividend) else sign * dividend * math.inf
    return single(dividend / divisor)


def truncated(value: float) -> int:
    """Return the long that a float becomes, towards zero.

    Beyond a long, which C leaves undefined, it is 0 here.
    """
    if not -(2.0**31) <= value < 2.0**31:
        return 0
    return int(value)
