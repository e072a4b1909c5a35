"""The I2C bus between the board, its only master, and the chips on it: byte by byte, in bus time.

Sources: UM10204 (START, STOP, acknowledge); ArduinoCore-avr's Wire library, 100 kHz unless set otherwise
(TWBR 72 at 16 MHz, exactly); it waits for ever for a stuck bus: its time-out is off by default. Assumed: a
START, a repeated START and a STOP take one bit time each; the processor's own time between two bytes is left
out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from firmware_bridge.units import NEVER, SECOND, Nanoseconds

STANDARD_RATE: Final = 100_000
"""Bit rate by default in Wire, in bits per second."""
BITS_PER_BYTE: Final = 9
"""Eight, and the acknowledge."""
GENERAL_CALL: Final = 0x00
NO_ANSWER: Final = 0xFF
"""Result of a read where no device pulls the line."""


@dataclass(frozen=True, slots=True)
class TransferSegment:
    """Part of a transfer after one START: bytes to a 7-bit address, or a number of bytes to read from it."""

    address: int
    written: bytes = b""
    to_read: int = 0

    @property
    def length(self) -> int:
        """Number of bytes on the bus, the address among them."""
        return 1 + (self.to_read or len(self.written))


@dataclass(frozen=True, slots=True)
class Transfer:
    """One transfer from START to STOP, with a repeated START between two segments."""

    segments: tuple[TransferSegment, ...]


@dataclass(frozen=True, slots=True)
class TransferResult:
    """Result of a transfer: the acknowledge of each byte, and the bytes read."""

    acknowledged: bool
    read: bytes


class Chip(Protocol):
    """A slave on the bus. `at` is when the byte's ninth bit has passed."""

    @property
    def hasty(self) -> bool:
        """True if outputs may change with every byte, and not with the STOP alone."""

    def acknowledges(self, address: int, *, reading: bool) -> bool:
        """Return whether the chip answers to this 7-bit address; it changes nothing."""

    def addressed(self, address: int, *, reading: bool, at: Nanoseconds) -> None:
        """Take a START and an address that the chip acknowledges."""

    def written(self, byte: int, at: Nanoseconds) -> bool:
        """Take a byte; return whether it is acknowledged."""

    def read(self, at: Nanoseconds) -> int:
        """Give the next byte."""

    def stopped(self, at: Nanoseconds) -> None:
        """Take a STOP, also one of a transfer to another address."""


def write(address: int, data: bytes) -> Transfer:
    """Return one write, as Wire's endTransmission() makes it."""
    return Transfer((TransferSegment(address, data),))


def read(address: int, count: int) -> Transfer:
    """Return one read, as Wire's requestFrom() makes it."""
    return Transfer((TransferSegment(address, to_read=count),))


class I2cBus:
    """One transfer at a time. Who has begun one calls `advance` at `due`, or later: instants stay true."""

    def __init__(self, chips: Sequence[Chip], rate: int = STANDARD_RATE) -> None:
        self.bit: Final[Nanoseconds] = SECOND // rate
        self.bytes = 0
        """Carried so far, addresses among them."""
        self.busy: Nanoseconds = 0
        """Bus time from START to STOP, all transfers together."""
        self.stuck = False
        """True if a line is held low, or nothing pulls it up: no START gets out, and Wire waits for ever."""
        self._chips: Final = tuple(chips)
        self._transfer: Transfer | None = None
        self._begun_at: Nanoseconds = 0
        self._segment = 0
        self._place = 0
        self._next_at: Nanoseconds = NEVER
        self._fine = False
        self._stop_at: Nanoseconds = NEVER
        self._ending = False
        self._acknowledged = True
        self._addressed: tuple[Chip, ...] = ()
        self._read = bytearray()

    @property
    def due(self) -> Nanoseconds:
        """Next time to call `advance`: the STOP, or each byte where one may matter by itself."""
        return self._next_at if self._fine else self._stop_at

    def begin(self, transfer: Transfer, now: Nanoseconds) -> None:
        """Send a START now."""
        self._transfer = transfer
        self._begun_at = now
        self._segment = self._place = 0
        self._ending = False
        self._acknowledged = True
        self._addressed = ()
        self._read.clear()
        if self.stuck:
            self._next_at = self._stop_at = NEVER
            return
        # START, then the address and its acknowledge.
        self._next_at = now + self.bit + BITS_PER_BYTE * self.bit
        self._stop_at = now + self.duration(transfer)
        self._fine = self._shows_each_byte(transfer)

    def duration(self, transfer: Transfer) -> Nanoseconds:
        """Return the time from START to STOP where everything is acknowledged."""
        # One bit time for each START, and one for the STOP.
        bits = sum([1 + BITS_PER_BYTE * segment.length for segment in transfer.segments]) + 1
        return bits * self.bit

    def advance(self, now: Nanoseconds) -> TransferResult | None:
        """Carry what has passed by `now`; return the result of a transfer whose STOP has."""
        while self._next_at <= now:
            if self._ending:
                return self._stop(self._next_at)
            self._carry(now)
        return None

    def jam(self, now: Nanoseconds, *, stuck: bool) -> None:
        """Let the bus be stuck from here on, or free; what is under way, or begun meanwhile, never ends."""
        self.advance(now)
        self.stuck = stuck
        if stuck:
            self._next_at = self._stop_at = NEVER

    def abandon(self, now: Nanoseconds) -> None:
        """Let go of the bus: the master was reset. What has passed has passed; there is no STOP."""
        if self.advance(now) is None and self._transfer is not None:
            self.busy += now - self._begun_at
        self._forget()

    def _shows_each_byte(self, transfer: Transfer) -> bool:
        """Return True if a chip or the master may notice a byte before the STOP."""
        for chip in self._chips:
            if chip.hasty:
                return True
        for segment in transfer.segments:
            if segment.address == GENERAL_CALL or not self._answering(segment):
                return True
        return False

    def _answering(self, segment: TransferSegment) -> tuple[Chip, ...]:
        reading = segment.to_read > 0
        return tuple([it for it in self._chips if it.acknowledges(segment.address, reading=reading)])

    def _carry(self, now: Nanoseconds) -> None:
        """Carry the bytes of a segment that have passed by `now`, and find out what follows the last one."""
        assert self._transfer is not None  # noqa: S101 - for the type checker: an instant is due
        segments = self._transfer.segments
        segment = segments[self._segment]
        at, place, length, each = self._next_at, self._place, segment.length, BITS_PER_BYTE * self.bit
        while at <= now:
            self.bytes += 1
            if not self._byte(segment, place, at):
                # Wire ends a transfer at the first byte without acknowledge, and still sends STOP.
                self._acknowledged = False
                self._end(at)
                return
            place += 1
            if place == length:
                self._segment += 1
                self._place = 0
                if self._segment < len(segments):
                    self._next_at = at + self.bit + each
                else:
                    self._end(at)
                return
            at += each
        self._place, self._next_at = place, at

    def _byte(self, segment: TransferSegment, place: int, at: Nanoseconds) -> bool:
        """Carry one byte; return whether it is acknowledged."""
        if place == 0:
            self._addressed = self._answering(segment)
            for chip in self._addressed:
                chip.addressed(segment.address, reading=segment.to_read > 0, at=at)
            return bool(self._addressed)
        if segment.to_read:
            byte = NO_ANSWER
            for chip in self._addressed:
                # Open drain: where several chips answer, a 0 wins.
                byte &= chip.read(at)
            self._read.append(byte)
            return True
        byte, acknowledged = segment.written[place - 1], False
        for chip in self._addressed:  # open drain: one chip that pulls is enough
            if chip.written(byte, at):
                acknowledged = True
        return acknowledged

    def _end(self, at: Nanoseconds) -> None:
        self._ending = True
        self._next_at = self._stop_at = at + self.bit

    def _stop(self, at: Nanoseconds) -> TransferResult:
        for chip in self._chips:
            chip.stopped(at)
        self.busy += at - self._begun_at
        self._forget()
        return TransferResult(self._acknowledged, bytes(self._read))

    def _forget(self) -> None:
        self._transfer = None
        self._next_at = self._stop_at = NEVER
