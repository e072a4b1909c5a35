"""The board's serial port: the rates that its divider can make, and the two rings of the core.

Source: ArduinoCore-avr, HardwareSerial.cpp: 64-byte rings of which one byte stays free; a byte that finds the
receive ring full is dropped, without a word. Not known here: what the bytes mean.
"""

from collections import deque
from dataclasses import dataclass
from typing import Final

from firmware_bridge.units import NEVER, SECOND, Nanoseconds

CLOCK_HZ: Final = 16_000_000
RING: Final = 63
"""Usable size of the receive ring, in bytes of its 64."""
BITS_PER_BYTE: Final = 10
LARGEST_DIVIDER: Final = 4_095
WITHOUT_DOUBLE_SPEED: Final = 57_600
"""The core takes the coarser divider for this rate, as older boot loaders did."""
ON_ITS_WAY: Final = 2
"""Number of bytes beyond the transmit ring: in the data register, and in the shift register."""


@dataclass(frozen=True, slots=True)
class Divider:
    """Register values that Serial.begin() writes: UBRR, and U2X set or not."""

    ubrr: int
    double_speed: bool

    @property
    def rate(self) -> int:
        """Resulting bit rate, rounded."""
        bit = (8 if self.double_speed else 16) * (self.ubrr + 1)
        return (2 * CLOCK_HZ + bit) // (2 * bit)


def divider(baud: int) -> Divider:
    """Return what Serial.begin(baud) sets; integer divisions as in the core."""
    # With U2X a bit is 8 * (UBRR + 1) clocks: 115200 Bd becomes 117647, 2.1 % fast.
    ubrr = (CLOCK_HZ // 4 // baud - 1) // 2
    if baud == WITHOUT_DOUBLE_SPEED or ubrr > LARGEST_DIVIDER:
        return Divider((CLOCK_HZ // 8 // baud - 1) // 2, double_speed=False)
    return Divider(ubrr, double_speed=True)


class Uart:
    """Serial. What it sends is kept with the instants at which the bytes have left, until it is taken."""

    def __init__(self, baud: int) -> None:
        self.baud: Final = divider(baud).rate
        self.lost = 0
        """Number of bytes lost since the last reset because the ring was full."""
        self._ring: deque[int] = deque()
        self._sent: deque[tuple[Nanoseconds, int]] = deque()
        self._burst_at: Nanoseconds = 0
        self._burst = 0

    @property
    def available(self) -> int:
        """Number of bytes that wait to be read."""
        return len(self._ring)

    def arrived(self, byte: int) -> None:
        """Take a byte whose stop bit has passed; the newest is lost where there is no room."""
        if len(self._ring) == RING:
            self.lost += 1
        else:
            self._ring.append(byte)

    def read(self) -> int:
        """Return the next byte; -1 where there is none."""
        return self._ring.popleft() if self._ring else -1

    def flush_input(self) -> None:
        """Throw away what waits."""
        self._ring.clear()

    def reset(self, now: Nanoseconds) -> None:
        """Reset it with the processor; a byte that has not wholly left never does."""
        self._ring.clear()
        self.lost = 0
        while self._sent and self._sent[-1][0] > now:
            self._sent.pop()
        self._burst_at, self._burst = now, 0

    def write(self, data: bytes, now: Nanoseconds) -> Nanoseconds:
        """Send bytes; return when the call comes back, which is when the last one has found room."""
        # The former burst has left: a new grid of byte times begins now.
        if self._leaves(self._burst) <= now:
            self._burst_at, self._burst = now, 0
        for byte in data:
            self._burst += 1
            self._sent.append((self._leaves(self._burst), byte))
        # 63 bytes fit in the ring, and 2 are on their way: the call waits until the others have gone.
        return max(now, self._leaves(max(0, self._burst - RING - ON_ITS_WAY)))

    def taken(self, now: Nanoseconds, most: int | None = None) -> bytes:
        """Return what has left by now, once, or the first `most` bytes of it."""
        out = bytearray()
        while self._sent and self._sent[0][0] <= now and (most is None or len(out) < most):
            out.append(self._sent.popleft()[1])
        return bytes(out)

    def leaves_at(self, place: int = 0) -> Nanoseconds:
        """Return when the next byte will have left, or one so many places behind it; NEVER for none."""
        return self._sent[place][0] if place < len(self._sent) else NEVER

    def _leaves(self, count: int) -> Nanoseconds:
        # From the start of the burst, so that fractions of a nanosecond do not add up.
        return self._burst_at + count * BITS_PER_BYTE * SECOND // self.baud
