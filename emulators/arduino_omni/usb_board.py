"""The Mega on USB: the second chip, an ATmega16U2, that passes bytes on in its own time and pulls RESET.

As a node it is on the link "serial", which is its USB side: chunks come and go whole. A pty or a port carries
them as they are. DTR is passed as an empty packet with the address `DTR_UP` or `DTR_DOWN`.

Sources: Arduino-usbserial: rings of 128 bytes, bytes of the board go to the host every 4.096 ms (overflow of
timer 0), or when more than 96 bytes wait; RESET hangs on DTR through 100 nF, so its rise is what resets. Both
chips divide the same clock in the same way, so their rates fit.

Where they are silent:
* the host has set the rate that the sketch has.
* a host that sends more than the ring holds waits, and loses nothing.
* the host's own millisecond frames are left out.
"""

from collections import deque
from typing import Final

from emulators.arduino_omni.mega.mega import Mega
from emulators.arduino_omni.mega.uart import BITS_PER_BYTE
from firmware_bridge.node import DTR_DOWN, DTR_UP, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, NEVER, SECOND, Nanoseconds

FLUSH: Final[Nanoseconds] = 4_096 * MICROSECOND
NEARLY_FULL: Final = 96


class UsbBoard:
    """A Mega with its USB chip. The first call of `wake` is power-on.

    `flush` 0 hands each byte to the host as it comes, as a chip without that timer would.
    """

    def __init__(self, mega: Mega, *, flush: Nanoseconds = FLUSH) -> None:
        self.mega: Final = mega
        self._flush: Final = flush
        self._to_board: deque[int] = deque()
        self._burst_at: Nanoseconds = 0
        self._burst = 0
        self._to_host = bytearray()
        self._powered_at: Nanoseconds = NEVER
        self._flush_at: Nanoseconds = NEVER
        self._dtr = False
        self._sent: list[Packet] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a chunk from the host, or what became of DTR."""
        self.advance(now)
        if packet.address in {DTR_UP, DTR_DOWN} and not packet.payload:
            # 100 nF between DTR and RESET: the edge resets, the level does not.
            risen = packet.address == DTR_UP and not self._dtr
            self._dtr = packet.address == DTR_UP
            if risen:
                self.reset(now)
        else:
            self._enqueue(packet.payload, now)
        self.advance(now)
        return self._reaction(now)

    def reset(self, now: Nanoseconds) -> None:
        """Pull RESET; what has passed by now has passed."""
        self.advance(now)
        self.mega.reset(now)

    def hang(self, now: Nanoseconds) -> None:
        """Let the firmware do nothing more until it is reset."""
        self.advance(now)
        self.mega.hang(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        if self._powered_at == NEVER:
            self._powered_at = now
            self.reset(now)
        self.advance(now)
        return self._reaction(now)

    def advance(self, now: Nanoseconds) -> None:
        """Do everything up to `now`, in the order of its instants.

        It is called where someone may notice, and not at each byte: what was not noticed is done then.
        """
        while self._passes_at <= now:
            # Each at its own instant: the sketch may answer the first byte before the second one has come.
            at = self._passes_at
            self._burst += 1
            self.mega.receive(self._to_board.popleft(), at)
        self.mega.advance(now)
        # What is handed over, and when, changes nothing on the board.
        comes_at = self.mega.serial.leaves_at()
        while comes_at <= now or self._flush_at <= now:
            if comes_at <= self._flush_at:
                self._take(comes_at, min(self._flush_at, now))
                comes_at = self.mega.serial.leaves_at()
            else:
                self._hand_over()

    def _enqueue(self, chunk: bytes, now: Nanoseconds) -> None:
        if not self._to_board:
            self._burst_at, self._burst = now, 0
        self._to_board.extend(chunk)

    @property
    def _passes_at(self) -> Nanoseconds:
        """Arrival of the host's next byte at the board's pins."""
        if not self._to_board:
            return NEVER
        return self._burst_at + (self._burst + 1) * BITS_PER_BYTE * SECOND // self.mega.baud

    @property
    def _hands_over_at(self) -> Nanoseconds:
        """Next hand-over to the host: bytes that wait for the timer do not wait for one that has room."""
        room = NEARLY_FULL - len(self._to_host) if self._flush and self._flush_at != NEVER else 0
        return min(self._flush_at, self.mega.serial.leaves_at(room))

    def _may_hand_over_at(self, now: Nanoseconds) -> Nanoseconds:
        """Return the time before which the host receives nothing, provided that it sends no more.

        Bytes that the board sends between two turns of the timer wait for the second, or until the ring is
        nearly full.
        """
        does_at = min(self._passes_at, self.mega.due)
        if not self._flush or self._powered_at == NEVER:
            return min(self._hands_over_at, does_at)
        if self._flush_at != NEVER:
            turns_at = self._flush_at
        else:
            comes_at = min(self.mega.serial.leaves_at(), does_at)
            if comes_at == NEVER:
                return NEVER
            turns_at = self._turns_after(comes_at)
        # The chunk goes early when 97 bytes wait: at the earliest after the time of those that are missing.
        room = NEARLY_FULL + 1 - len(self._to_host)
        return min(turns_at, now + room * BITS_PER_BYTE * SECOND // self.mega.baud)

    def _turns_after(self, at: Nanoseconds) -> Nanoseconds:
        """Return the timer's next turn."""
        return self._powered_at + ((at - self._powered_at) // self._flush + 1) * self._flush

    def _take(self, at: Nanoseconds, until: Nanoseconds) -> None:
        """Take the byte that comes `at` an instant, and those `until` something else happens."""
        if self._flush and self._flush_at == NEVER:
            self._flush_at = self._turns_after(at)
        # Bytes behind the timer's turn belong to its next chunk.
        until = min(until, self._flush_at) if self._flush else at
        self._to_host += self.mega.serial.taken(until, NEARLY_FULL + 1 - len(self._to_host))
        if not self._flush or len(self._to_host) > NEARLY_FULL:
            self._hand_over()

    def _hand_over(self) -> None:
        self._sent.append(Packet(SERIAL, 0, bytes(self._to_host)))
        self._to_host.clear()
        self._flush_at = NEVER

    def _reaction(self, now: Nanoseconds) -> Reaction:
        sent = tuple(self._sent)
        self._sent.clear()
        return Reaction(sent, max(now, self._may_hand_over_at(now)))
