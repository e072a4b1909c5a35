"""One frame of the serial protocols: an opcode, whole words of data, check sum; its bytes on either line."""

from binascii import crc_hqx
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Final, TypeAlias

ANSWER: Final = 0x00
"""The opcode of every answer."""
DLE: Final = 0x90
STX: Final = 0x02
CHECKSUM_SIZE: Final = 2
MOST_WORDS: Final = 143
"""Most data words by V2's length (EPOS4 Communication Guide, by analogy)."""
_MOST_WORDS_V1: Final = 256
_SYNC: Final = bytes((DLE, STX))


class Generation(StrEnum):
    """The serial protocol of a line."""

    V1 = "v1"
    """RS232: single bytes of handshake, half-duplex."""
    V2 = "v2"
    """USB: frames that begin with DLE STX."""


class Failure(Enum):
    """Reason why a command has no answer."""

    SILENCE = "no answer in time"
    REFUSED = "the device does not know the command"
    DAMAGED = "the device found the check sum wrong"
    GARBLED = "the answer's check sum is wrong"


@dataclass(frozen=True, slots=True)
class Frame:
    """An opcode and its data: whole words, low byte first."""

    opcode: int
    body: bytes

    def __post_init__(self) -> None:
        """Refuse data that is not made of words."""
        if len(self.body) % 2:
            raise ValueError(f"a serial frame carries whole words, not {len(self.body)} bytes")


@dataclass(frozen=True, slots=True)
class MaxonAnswer:
    """The device's answer to a command; empty to one that V1 does not answer."""

    body: bytes


Outcome: TypeAlias = MaxonAnswer | Failure


def checksum(first: int, body: bytes) -> int:
    """Return the check sum of the frame's first word and its data, whole words with the low byte first.

    CRC-CCITT over 16-bit words, high byte first: polynomial 0x1021, start value 0; the final word of zeros
    that maxon's guides name is what makes it the plain form. Source: EPOS2 Application Notes Collection,
    April 2013, p. 11-164 to 166, checked on the frames there.
    """
    # The CRC takes each word with its high byte first, the line carries the low byte first.
    swapped = bytearray(len(body))
    swapped[0::2] = body[1::2]
    swapped[1::2] = body[0::2]
    return crc_hqx(swapped, crc_hqx(first.to_bytes(2, "big"), 0))


def encode_v1(frame: Frame) -> bytes:
    """Return opcode, length less one, data and check sum; at least one word."""
    words = len(frame.body) // 2
    if not 1 <= words <= _MOST_WORDS_V1:
        raise ValueError(f"a V1 frame carries 1 to {_MOST_WORDS_V1} words, not {words}")
    # V1 counts words less one, and has the opcode in the high byte; V2 has it the other way round.
    crc = checksum(frame.opcode << 8 | words - 1, frame.body)
    return bytes((frame.opcode, words - 1)) + frame.body + crc.to_bytes(2, "little")


def encode_v2(frame: Frame) -> bytes:
    """Return DLE STX, opcode, length, data and check sum, each DLE after the first doubled.

    Length and check sum are those of the frame without the doubled bytes.
    """
    words = len(frame.body) // 2
    if words > MOST_WORDS:
        raise ValueError(f"a V2 frame carries at most {MOST_WORDS} words, not {words}")
    crc = checksum(words << 8 | frame.opcode, frame.body)
    plain = bytes((frame.opcode, words)) + frame.body + crc.to_bytes(2, "little")
    # Doubled only behind DLE STX: a single DLE within a frame would begin the next one.
    return _SYNC + plain.replace(b"\x90", b"\x90\x90")
