"""One record of interpolated position mode, 0x20C1: position, velocity and time in eight bytes.

Sources: maxon EDS for the EPOS2 70/10; application note Interpolation Position Mode, December 2008.
"""

from dataclasses import dataclass
from typing import Final, Self

RECORD_BITS: Final = 64
_POSITION_BITS: Final = 32
_VELOCITY_BITS: Final = 24
_TIME_SHIFT: Final = 56
LONGEST_MS: Final = 0xFF


def _signed(word: int, bits: int) -> int:
    word &= (1 << bits) - 1
    # struct has no type of 24 bits, so the sign is extended here.
    return word - (1 << bits) if word >> (bits - 1) else word


@dataclass(frozen=True, slots=True)
class PvtRecord:
    """A knot of the path, and how long the way to the next one takes."""

    position: int
    """qc, 32 bits with sign."""
    velocity: int
    """rpm, 24 bits with sign."""
    ms: int
    """Time in ms, 0 to 255; 0 ends the path here."""

    @classmethod
    def decode(cls, word: int) -> Self:
        """Take apart the 64 bits of a record."""
        velocity = _signed(word >> _POSITION_BITS, _VELOCITY_BITS)
        return cls(_signed(word, _POSITION_BITS), velocity, word >> _TIME_SHIFT & LONGEST_MS)

    def encode(self) -> bytes:
        """Return the eight bytes, low byte first; ValueError where a part does not fit."""
        if not 0 <= self.ms <= LONGEST_MS:
            raise ValueError(f"a record lasts 0 to {LONGEST_MS} ms, not {self.ms}")
        for bits, value in ((_POSITION_BITS, self.position), (_VELOCITY_BITS, self.velocity)):
            if value != _signed(value, bits):
                raise ValueError(f"{value} does not fit {bits} bits of a PVT record")
        velocity = self.velocity & (1 << _VELOCITY_BITS) - 1
        position = self.position & (1 << _POSITION_BITS) - 1
        # Position in bits 0 to 31, velocity in 32 to 55, time in 56 to 63 (0x20C1).
        return (position | velocity << _POSITION_BITS | self.ms << _TIME_SHIFT).to_bytes(8, "little")
