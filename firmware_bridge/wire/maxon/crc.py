"""The check sum of both serial protocols: CRC-CCITT over 16-bit words, high byte first.

Polynomial 0x1021, start value 0; the final word of zeros that maxon's guides name is what makes it the plain
form. Source: EPOS2 Application Notes Collection, April 2013, p. 11-164 to 166, checked on the frames there.
"""

from binascii import crc_hqx
from typing import Final

SIZE: Final = 2


def checksum(first: int, body: bytes) -> int:
    """Return the check sum of the frame's first word and its data, whole words with the low byte first."""
    swapped = bytearray(len(body))
    swapped[0::2] = body[1::2]
    swapped[1::2] = body[0::2]
    return crc_hqx(swapped, crc_hqx(first.to_bytes(2, "big"), 0))
