"""A CAN frame: its address word as SocketCAN packs it, its length on the bus, its rank in arbitration.

The length is exact, CRC-15 and stuff bits included (ISO 11898-1; Bosch CAN 2.0, part B, sections 3 and 5).
"""

from functools import lru_cache
from typing import Final

EXTENDED: Final = 1 << 31
"""Flag: 29-bit identifier."""
REMOTE: Final = 1 << 30
"""Flag: remote transmission request; the payload's length is the length code, its bytes do not count."""
ERROR: Final = 1 << 29
"""Flag: an error report of the controller, not a frame of the bus."""
STANDARD_MASK: Final = 0x7FF
EXTENDED_MASK: Final = 0x1FFF_FFFF
MAX_PAYLOAD: Final = 8


def identifier(address: int) -> int:
    """Return the 11-bit or 29-bit identifier without its flags."""
    return address & (EXTENDED_MASK if address & EXTENDED else STANDARD_MASK)


INTERFRAME_BITS: Final = 3
"""The intermission between two frames; not part of `frame_bits`."""

_CRC_POLYNOMIAL: Final = 0x4599
_CRC_BITS: Final = 15
_TAIL_BITS: Final = 10
"""After the CRC, never stuffed: CRC delimiter, acknowledge slot and delimiter, 7 bits end of frame."""
_RUN: Final = 5
"""After this many equal bits the sender inserts one of the other kind."""


def _crc_table() -> tuple[int, ...]:
    table = []
    for first in range(256):
        crc = first << 7
        for _ in range(8):
            # CRC-15 of ISO 11898-1; bit 14 decides whether the polynomial is subtracted (modulo 2: xor).
            crc = (crc << 1) ^ (_CRC_POLYNOMIAL if crc & 0x4000 else 0)
        table.append(crc & 0x7FFF)
    return tuple(table)


def _stuff_table() -> tuple[int, ...]:
    """Return, for (state, byte), the stuff bits shifted by 12 and the next state shifted by 8.

    A state is the last bit on the bus and how many of its kind came in a row, stuff bits included.
    """
    table = []
    for state in range(2 * _RUN):
        for byte in range(256):
            last, run = divmod(state, _RUN)
            run += 1
            # A stuff bit counts as the first of its own run, so two of them may follow each other closely.
            stuffed = 0
            for position in range(7, -1, -1):
                bit = byte >> position & 1
                run = run + 1 if bit == last else 1
                last = bit
                if run == _RUN:
                    stuffed += 1
                    last, run = 1 - bit, 1
            # Runs of 1 to 5 become 0 to 4: after a stuff bit the run is 1 again, so 5 never leaves this loop.
            table.append(stuffed << 12 | (last * _RUN + run - 1) << 8)
    return tuple(table)


_CRC_TABLE: Final = _crc_table()
_STUFF_TABLE: Final = _stuff_table()


def crc15(bits: int, count: int) -> int:
    """Return the frame check sequence of the lowest `count` bits of `bits`, the first bit being the highest.

    Zeros in front change nothing, because the register starts at zero; that is what makes whole bytes of it.
    """
    crc = 0
    for byte in bits.to_bytes((count + 7) >> 3, "big"):
        crc = ((crc << 8) & 0x7FFF) ^ _CRC_TABLE[(crc >> 7) ^ byte]
    return crc


@lru_cache(maxsize=2048)
def _head(address: int, length: int) -> tuple[int, int, int]:
    """Return what start of frame to control field leave behind: CRC, stuffing's state, bits on the bus."""
    # An error report is the controller's own and was never on the bus.
    if length > MAX_PAYLOAD or address & ERROR:
        raise ValueError(f"{address:08X} with {length} bytes is not a frame on a CAN bus")
    remote = 1 if address & REMOTE else 0
    if address & EXTENDED:
        base = address >> 18 & STANDARD_MASK
        # Base identifier, SRR and IDE (both recessive, hence 3), the 18 further bits, then RTR.
        bits = (base << 20 | 3 << 18 | address & 0x3FFFF) << 1 | remote
        count = 39
    else:
        bits = (address & STANDARD_MASK) << 1 | remote
        count = 19
    # Control field: two dominant bits (IDE and r0, or r1 and r0), then the length code in four bits.
    bits = bits << 6 | length
    # Whole bytes: alternating bits in front, a one last, leave the run of the start bit at one.
    padding = -count % 8
    state = stuffed = 0
    for byte in ((0x55 & (1 << padding) - 1) << count | bits).to_bytes((count + padding) >> 3, "big"):
        entry = _STUFF_TABLE[state | byte]
        state = entry & 0xF00
        stuffed += entry >> 12
    return crc15(bits, count), state, count + stuffed


@lru_cache(maxsize=8192)
def frame_bits(address: int, payload: bytes) -> int:
    """Return the bits from start of frame to end of frame, stuff bits included; ValueError for no such frame.

    Stuffing reaches from start of frame to the last bit of the CRC. The interframe space is not included.
    """
    crc, state, bits = _head(address, len(payload))
    # A remote frame has a length code and no data field.
    if not address & REMOTE:
        bits += 8 * len(payload)
        for byte in payload:
            crc = ((crc << 8) & 0x7FFF) ^ _CRC_TABLE[(crc >> 7) ^ byte]
            entry = _STUFF_TABLE[state | byte]
            state = entry & 0xF00
            bits += entry >> 12
    # Whole bytes again: after its last bit one of the other kind, which is never stuffed.
    for byte in (crc << 1 | ~crc & 1).to_bytes(2, "big"):
        entry = _STUFF_TABLE[state | byte]
        state = entry & 0xF00
        bits += entry >> 12
    return bits + _CRC_BITS + _TAIL_BITS


@lru_cache(maxsize=2048)
def arbitration_rank(address: int) -> int:
    """Return the bits that decide arbitration as one number: the lowest one wins the bus.

    The 11 base bits, then RTR or SRR, then the identifier extension bit, the other 18 bits and their RTR.
    """
    remote = 1 if address & REMOTE else 0
    if address & EXTENDED:
        # SRR takes the place of RTR and is recessive, so a standard frame wins over an extended one of the
        # same base.
        return (address >> 18 & STANDARD_MASK) << 21 | 3 << 19 | (address & 0x3FFFF) << 1 | remote
    return (address & STANDARD_MASK) << 21 | remote << 20
