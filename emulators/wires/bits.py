"""What a serial receiver makes of a byte that was sent at another rate than its own.

A byte is ten bits: start (0), eight data bits from the lowest, stop (1); the line rests at 1. The receiver
looks at the middle of each of its own bits, from the falling edge of the start bit on. It refuses to know the
bytes before and after: what is heard of a slow sender's byte as a second one is left out.
"""

from typing import Final

DATA_BITS: Final = 8
STOP: Final = DATA_BITS + 1


def heard_as(byte: int, sent_at: int, heard_at: int) -> int | None:
    """Return the byte that is read; None where the stop bit is missing. Rates in bits a second."""
    if sent_at == heard_at:
        return byte
    read = 0
    for place in range(1, STOP + 1):
        # The bit that is on the line place + 1/2 of the receiver's bit times after the edge.
        on_line = (2 * place + 1) * sent_at // (2 * heard_at)
        level = 1 if on_line >= STOP else 0 if on_line == 0 else byte >> (on_line - 1) & 1
        read |= level << place
    return read >> 1 & 0xFF if read >> STOP else None
