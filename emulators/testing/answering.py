"""Presence checks of devices: each call sends one request that changes nothing, and awaits the answer.

The caller reads `complete` every 50 ms. Time is counted in these looks, except the wait for devices that are
not there.
"""

import os
import select
import termios
from collections.abc import Callable
from typing import Final, Self

import serial

from emulators.family import Question, families
from emulators.testing.buses import Bus
from firmware_bridge.canopen.cia301 import SDO_REQUEST, SDO_RESPONSE
from firmware_bridge.canopen.objects import DEVICE_TYPE
from firmware_bridge.canopen.sdo import UploadResponse, decode_response, encode_upload
from firmware_bridge.cli.node_numbers import numbers
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import open_can
from firmware_bridge.units import from_seconds

REQUESTED_AGAIN: Final = 20
"""Number of looks, 1 s: a late answer comes before the request is repeated."""
ALREADY_S: Final = 0.3
"""Time after a request, or an answer of another, within which a present drive has answered."""
BOOTS: Final = 30
"""Number of looks, 1.5 s: a byte within the boot loader's 1.1 s keeps it for 9 s."""
BOOTS_AGAIN: Final = 220
"""Number of looks, 11 s: those 9 s, and the start after them."""
ROOM: Final = 4096
_OSPEED: Final = 5


def questions() -> dict[str, tuple[bytes, bytes]]:
    """Return the request to each board's firmware, by its protocol, and the begin of its answer."""
    return {name: one for family in families().values() for name, one in family.questions.items()}


class RollCall:
    """Request to the drives on a bus for their device type, until each has answered."""

    def __init__(self, bus: Bus, nodes: str) -> None:
        """Begin; PortError where there is no such bus."""
        self._missing: Final = set(numbers(nodes))
        self._port: Final = open_can(*bus)
        self._looks = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._port.close()

    def answering(self, within: float = ALREADY_S) -> list[int]:
        """Send the request once, and return the nodes that answered within that many seconds."""
        requested = set(self._missing)
        self.complete()
        # A missing drive sends nothing: only here is that waited for, whatever else is on the bus.
        clock, left, until = Clock(), set(self._missing), from_seconds(within)
        while clock.wait([self._port.fileno()], until):
            if self.complete() or clock.now() > until:
                break
            if self._missing != left:
                left, until = set(self._missing), clock.now() + from_seconds(within)
        return sorted(requested - self._missing)

    def complete(self) -> bool:
        """Look once; return whether all have answered."""
        if self._looks % REQUESTED_AGAIN == 0:
            for node in sorted(self._missing):
                self._port.write(SDO_REQUEST + node, encode_upload(DEVICE_TYPE), 0)
        self._looks += 1
        # Emptied at each look: on a busy bus the answer lies behind other frames.
        while select.select([self._port.fileno()], [], [], 0)[0]:
            received = self._port.read(0)
            if not received:
                break
            for address, payload in received:
                if isinstance(decode_response(payload), UploadResponse):
                    self._missing.discard(address - SDO_RESPONSE)
        return not self._missing


class _Line:
    """A serial line, read without waiting."""

    def __init__(self, port: str) -> None:
        self._line: Final = serial.Serial(port, _rate(port), timeout=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._line.close()


def _rate(port: str) -> int:
    """Return the bit rate that the emulated device has set on its line."""
    line = os.open(port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        speed = termios.tcgetattr(line)[_OSPEED]
    finally:
        os.close(line)
    rates: tuple[int, ...] = serial.Serial.BAUDRATES
    return next(rate for rate in rates if getattr(termios, f"B{rate}", None) == speed)


class LineCall(_Line):
    """Request to the device on a serial line, and to those behind it, one after the other."""

    def __init__(self, port: str, nodes: str, ask: Callable[[int], Question]) -> None:
        """Begin; OSError where there is no such line."""
        super().__init__(port)
        self._missing: Final = [ask(node) for node in numbers(nodes)]
        self._looks = 0

    def complete(self) -> bool:
        """Look once; return whether all have answered."""
        question = self._missing[0]
        if self._looks % REQUESTED_AGAIN == 0:
            self._line.write(question.begin())
        self._looks += 1
        self._line.write(question.receive(self._line.read(ROOM)))
        if question.answered:
            self._missing.pop(0)
            self._looks = 0
        return not self._missing


class BoardCall(_Line):
    """Request to the firmware of a board that is booting."""

    def __init__(self, port: str, spoken: str) -> None:
        """Begin; OSError where there is no such line."""
        super().__init__(port)
        self._question, self._answer = questions()[spoken]
        self._received = b""
        self._looks = -BOOTS

    def complete(self) -> bool:
        """Look once; return True if it has answered completely."""
        more = self._line.read(ROOM)
        # First after the boot loader's time: a byte within it would keep the loader for another 9 s.
        if self._looks % BOOTS_AGAIN == 0:
            self._line.write(self._question)
            self._received = b""
        self._looks += 1
        self._received += more
        # Not while bytes still come: the rest of the answer would be the test's first input.
        return self._looks > 0 and self._answer in self._received and not more
