"""A ground station that has a clock of its own, and answers requests for its time."""

from __future__ import annotations

from typing import Any

from firmware_bridge.mavlink.age import BOOT_WRAPS
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.trust import EPOCH, UNIT, Trust
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, rars, target_message

HERE, THERE = number_of("10.0.0.1", 14550), number_of("192.0.2.7", 14550)
NOW = EPOCH + 300_000_000 * SECOND
QUESTIONS = {"TIMESYNC", "PING"}
BEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


class Station:
    """A ground station with a clock of its own, whose messages arrive `late` after it has sent them."""

    def __init__(self, bench: RarsBench, source: int = HERE, *, key: bytes | None = None) -> None:
        self.bench = bench
        self.source = source
        self.codec = Codec(255, 190, None if key is None else (key, 1))
        self.ahead: Nanoseconds = 1_000 * SECOND
        """Its clock, less ours; it stamps by the same."""
        self.boot_ahead: Nanoseconds | None = None
        """The clock of its set-points, less ours, where that is another one."""
        self.late: Nanoseconds = 0
        self.answers = QUESTIONS
        self.answers_at_once = False
        """True if its answers come at once, in spite of late other messages."""
        self.requested: list[Any] = []
        self.sends(BEAT)

    def frame(self, message: Any, sent_at: Nanoseconds) -> bytes:
        return self.codec.encode(message, (NOW + sent_at + self.ahead - EPOCH) // UNIT)

    def sends(self, message: Any) -> list[Any]:
        """Send a message that arrives now, `late` after it was sent."""
        return self.comes(self.frame(message, self.bench.now - self.late))

    def comes(self, frame: bytes, source: int | None = None) -> list[Any]:
        bench, place = self.bench, self.source if source is None else source
        replies = bench.operator.receive(frame, bench.now, bench.decide, place)
        return [message for reply in replies for message in Codec(9, 9).decode(reply.payload)]

    def goes(self, vx: float = 0.2) -> list[Any]:
        return self.sends(self.set_point(vx))

    def set_point(self, vx: float, sent_at: Nanoseconds | None = None) -> Any:
        message = target_message(vx)
        at = self.bench.now - self.late if sent_at is None else sent_at
        ahead = self.ahead if self.boot_ahead is None else self.boot_ahead
        message.time_boot_ms = (at + ahead) // MILLISECOND % BOOT_WRAPS
        return message

    def orders(self, command: int, *params: float) -> list[Any]:
        seven = (*params, *(0.0,) * (7 - len(params)))
        return self.sends(dialect.MAVLink_command_long_message(1, 1, command, 0, *seven))

    def answer(self, question: Any) -> bytes:
        """An answer that was written `late` ago."""
        at = self.bench.now - (0 if self.answers_at_once else self.late)
        if question.get_type() == "TIMESYNC":
            return self.frame(dialect.MAVLink_timesync_message(at + self.ahead, question.ts1), at)
        return self.frame(dialect.MAVLink_ping_message(question.time_usec, question.seq, 1, 1), at)

    def drives(self, seconds: float, vx: float = 0.0) -> None:
        """Go on for so long: set-points at 20 Hz, each question answered as it comes."""
        bench = self.bench
        for _ in range(round(seconds * SECOND / CYCLE)):
            bench.now += CYCLE
            self.goes(vx)
            for packet in bench.operator.report(bench.snapshot(), (), bench.now):
                for one in Codec(9, 9).decode(packet.payload):
                    if one.get_type() in QUESTIONS and packet.address == self.source:
                        self.requested.append(one)
                        if one.get_type() in self.answers:
                            self.comes(self.answer(one))


def driving(*, key: bytes | None = None, seconds: float = 2.0, **how: Any) -> Station:
    """A station that has taken control, and driven for some seconds."""
    bench = rars()
    bench.trust = Trust(key=key, started_at=NOW)
    bench.restart()
    station = Station(bench, key=key)
    for name, value in how.items():
        setattr(station, name, value)
    station.orders(400, 1.0)
    station.drives(seconds)
    return station


def age_of(station: Station) -> Any:
    """The newest motion command's age in s, and whether it is dated."""
    intent = station.bench.operator.intent
    return None if intent.sent_at is None else (
        intent.received_at - intent.sent_at
    ) / SECOND, intent.timestamped
