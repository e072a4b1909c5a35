"""Hosts at the other end of a board's USB, in virtual time by hand; a chip that records its commands."""

from collections.abc import Callable

from emulators.arduino_omni.mega.mega import Mega, Sketch
from emulators.arduino_omni.shield.tb6612 import BridgeDuty
from emulators.arduino_omni.usb_board import UsbBoard
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

READY = 3 * SECOND


class Spy:
    """A second chip at the shield's address: it sees the shield's commands."""

    hasty = True

    def __init__(self) -> None:
        self.transfers: list[str] = []
        self._now: list[int] = []

    def acknowledges(self, address: int, *, reading: bool) -> bool:
        return address == 0x60 and not reading

    def addressed(self, address: int, *, reading: bool, at: Nanoseconds) -> None:
        del address, reading, at
        self._now = []

    def written(self, byte: int, at: Nanoseconds) -> bool:
        del at
        self._now.append(byte)
        return True

    def read(self, at: Nanoseconds) -> int:
        raise AssertionError(at)

    def stopped(self, at: Nanoseconds) -> None:
        del at
        if self._now:
            self.transfers.append(bytes(self._now).hex(" ").upper())
        self._now = []


class Host:
    """One board, plugged in and started, and its output since."""

    def __init__(self, sketch: Callable[[Mega], Sketch], baud: int, *, ready: Nanoseconds = READY) -> None:
        self.spy = Spy()
        self.mega = Mega(sketch, baud, others=(self.spy,))
        self.board = UsbBoard(self.mega, flush=0)
        self.received = bytearray()
        self.now: Nanoseconds = 0
        self.wake_at: Nanoseconds = 0
        self.run(ready)
        self.banner = self.taken()
        self.spy.transfers.clear()

    def run(self, duration: Nanoseconds) -> "Host":
        until = self.now + duration
        while self.wake_at <= until:
            self.now = max(self.now, self.wake_at)
            self._take(self.board.wake(self.now))
        self.now = until
        return self

    def _take(self, reaction: Reaction) -> None:
        for packet in reaction.sent:
            self.received += packet.payload
        self.wake_at = reaction.wake_at

    def send(self, data: bytes, address: int = 0) -> None:
        self._take(self.board.receive(Packet(SERIAL, address, data), self.now))

    def taken(self) -> bytes:
        taken = bytes(self.received)
        self.received.clear()
        return taken

    def ask(self, data: bytes, wait: Nanoseconds = 100 * MILLISECOND) -> bytes:
        """Send it whole, and return the answer."""
        self.send(data)
        self.run(wait)
        return self.taken()

    def ask_slowly(self, data: bytes, wait: Nanoseconds = 100 * MILLISECOND) -> bytes:
        """Send it byte by byte, 3 ms apart, and return the answer."""
        for byte in data:
            self.send(bytes((byte,)))
            self.run(3 * MILLISECOND)
        self.run(wait)
        return self.taken()

    def motors(self) -> tuple[BridgeDuty, ...]:
        return self.mega.shield.outputs(self.now)
