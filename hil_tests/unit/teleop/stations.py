"""Several stations on one bench: each has its place, its numbers and its own count of frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from firmware_bridge.mavlink.frames import Codec, dialect
from hil_tests.unit.teleop.bench import acks

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

ARM, STOP, CLEAR, PAUSE, RELAY, INTERVAL, CONTROL = 400, 185, 5300, 193, 181, 511, 32100
FORCE = 21196.0


class Hand:
    """One station in the test's hand."""

    def __init__(self, bench: RarsBench, source: int, system: int = 255, component: int = 190) -> None:
        self.bench = bench
        self.codec = Codec(system, component)
        self.source = source
        self.beats()

    def say(self, message: Any) -> list[Any]:
        return self.send(self.codec.encode(message))

    def send(self, datagram: bytes) -> list[Any]:
        bench = self.bench
        replies = bench.operator.receive(datagram, bench.now, bench.decide, self.source)
        assert {reply.address for reply in replies} <= {self.source}
        return [message for reply in replies for message in self.codec.decode(reply.payload)]

    def beats(self) -> None:
        self.say(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))

    def stick(self, x: int = 0, *, r: int = 0, buttons: int = 0) -> list[Any]:
        return self.say(dialect.MAVLink_manual_control_message(1, x, 0x7FFF, 0, r, buttons))

    def order(self, command: int, *params: float) -> list[Any]:
        seven = (*params, *(0.0,) * (7 - len(params)))
        return self.say(dialect.MAVLink_command_long_message(1, 1, command, 0, *seven))

    def result(self, command: int, *params: float) -> int:
        [(_, result)] = acks(self.order(command, *params))
        return result
