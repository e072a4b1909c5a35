"""A serial line between two ends, both ways at once: real byte times, receive buffers of real size.

A byte is ten bits: start (0), eight data bits from the lowest, stop (1); the line rests at 1. It refuses to
know parity.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from emulators.wires.ends import End, Observed
from emulators.world import World, WorldError, WorldNode
from firmware_bridge.node import Clocked
from firmware_bridge.packet import Packet
from firmware_bridge.units import SECOND, Nanoseconds

DATA_BITS: Final = 8
STOP: Final = DATA_BITS + 1


def received_as(byte: int, sent_at: int, received_at: int) -> int | None:
    """Return the byte that a receiver at another rate reads; None where the stop bit is missing.

    Rates in bits a second. The receiver looks at the middle of each of its own bits, from the falling edge of
    the start bit on; the rest of a slow sender's byte that it would receive as a second one is left out.
    """
    if sent_at == received_at:
        return byte
    read = 0
    for place in range(1, STOP + 1):
        # The bit that is on the line place + 1/2 of the receiver's bit times after the edge.
        on_line = (2 * place + 1) * sent_at // (2 * received_at)
        # Start bit 0, then the data from the lowest bit; stop bit and idle line are 1.
        level = 1 if on_line >= STOP else 0 if on_line == 0 else byte >> (on_line - 1) & 1
        read |= level << place
    return read >> 1 & 0xFF if read >> STOP else None


BITS_PER_BYTE: Final = 10
_ENDS: Final = 2


@dataclass(frozen=True, slots=True)
class Inbox:
    """A receive buffer that its owner empties only at multiples of `read_every`, as a main loop does."""

    buffer_bytes: int
    read_every: Nanoseconds


class _Uart(End):
    """One end: what it still sends, and what waits in its receive buffer until it is read."""

    __slots__ = ("begun_at", "buffer", "clock", "overruns", "queue", "rate", "reading", "sending", "since")

    def __init__(self, station: WorldNode, link: str, world: World) -> None:
        super().__init__(station, link, world)
        self.queue: deque[int] = deque()
        self.sending = False
        self.begun_at: Nanoseconds = 0
        self.since = 0
        node = station.node
        self.clock = node if isinstance(node, Clocked) else None
        self.rate = 0
        """Bit rate of the burst that is being sent."""
        self.buffer = bytearray()
        self.overruns = 0
        self.reading = False


class SerialWire(Observed):
    """A line at `baud` bits a second; an end that has a `baud` of its own runs at that one.

    Between two different rates bytes arrive as the receiver reads them, or not at all.

    A station with an inbox, by its name, loses what does not fit into it between two reads. To any other
    station each byte is handed over when its stop bit has passed.
    """

    def __init__(
        self, baud: int, inboxes: Mapping[str, Inbox] = MappingProxyType({}), name: str = "serial"
    ) -> None:
        if baud <= 0:
            raise WorldError(f"line '{name}': {baud} baud")
        for owner, inbox in inboxes.items():
            if inbox.buffer_bytes <= 0 or inbox.read_every <= 0:
                raise WorldError(f"line '{name}': the inbox of '{owner}' needs a size and a time above zero")
        super().__init__(name)
        self.baud = baud
        self.bytes = 0
        """Carried so far, both ways."""
        self._inboxes = dict(inboxes)
        self._uarts: dict[WorldNode, _Uart] = {}

    def join(self, world: World, station: WorldNode, link: str) -> None:
        """Connect a station, which calls this wire `link`; WorldError for a third one."""
        if len(self._uarts) == _ENDS:
            raise WorldError(f"line '{self.name}' has two ends, and '{station.name}' would be a third")
        uart = _Uart(station, link, world)
        self._ends.join(uart)
        self._uarts[station] = uart

    def leave(self, station: WorldNode) -> None:
        """Disconnect a station; what it has not sent yet is lost."""
        super().leave(station)
        self._uarts.pop(station).queue.clear()

    def overruns(self, name: str) -> int:
        """Return how many bytes for the station of this name found its buffer full."""
        return sum(uart.overruns for uart in self._uarts.values() if uart.station.name == name)

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Queue bytes behind those that are still being sent."""
        uart = self._uarts[sender]
        uart.queue.extend(packet.payload)
        if uart.queue and not uart.sending:
            uart.sending = True
            uart.begun_at = self._ends.world.now
            uart.since = 0
            uart.rate = self._rate(uart)
            self._plan(uart)

    def _rate(self, uart: _Uart) -> int:
        return self.baud if uart.clock is None else uart.clock.baud

    def _plan(self, uart: _Uart) -> None:
        # From the start of the burst, so that fractions of a nanosecond do not add up.
        uart.since += 1
        end = uart.begun_at + uart.since * BITS_PER_BYTE * SECOND // uart.rate
        self._ends.world.call_at(end, self._arrive, uart)

    def _arrive(self, uart: _Uart) -> None:
        # Emptied by `leave` while a byte was under way.
        if not uart.queue:
            uart.sending = False
            return
        byte = uart.queue.popleft()
        self.bytes += 1
        if self._ends.world.now < uart.station.silent_from:
            for other in self._uarts.values():
                if other is not uart:
                    received = received_as(byte, uart.rate, self._rate(other))
                    if received is not None:
                        self._store(uart, other, received)
        if uart.queue:
            self._plan(uart)
        else:
            uart.sending = False

    def _store(self, sender: _Uart, receiver: _Uart, byte: int) -> None:
        inbox = self._inboxes.get(receiver.station.name)
        if inbox is None:
            self._hand_over(sender, bytes((byte,)))
            return
        if len(receiver.buffer) == inbox.buffer_bytes:
            receiver.overruns += 1
            return
        receiver.buffer.append(byte)
        if not receiver.reading:
            receiver.reading = True
            world = self._ends.world
            # Up to the next turn of the owner's main loop.
            next_read = -(-world.now // inbox.read_every) * inbox.read_every
            world.call_at(next_read, self._read, (sender, receiver))

    def _read(self, pair: tuple[_Uart, _Uart]) -> None:
        sender, receiver = pair
        chunk = bytes(receiver.buffer)
        receiver.buffer.clear()
        receiver.reading = False
        self._hand_over(sender, chunk)

    def _hand_over(self, sender: _Uart, chunk: bytes) -> None:
        self._ends.hand_over(sender.station, Packet(sender.link, 0, chunk))
