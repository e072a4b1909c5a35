"""Failures in a run, or while it stops: they end neither the stop nor the reports to others."""

import os
import signal
from collections.abc import Callable, Sequence
from typing import Final

import pytest

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort
from firmware_bridge.runtime.runner import AGAIN, run
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.unit.runtime.test_runner import Flat, Winding

STOPS: Final = [0x100, 0x100, 0x100]


class Unhurried(Winding):
    """Node that reports if it may be left."""

    unattended = "its wheels may turn"
    leave = False
    requested = 0

    def may_leave(self, now: Nanoseconds) -> bool:
        del now
        self.requested += 1
        return self.leave


class Interrupted(Unhurried):
    """Node at whose 2nd tick two signals come, and a third one while it stops."""

    def tick(self, number: int) -> None:
        if number == 2:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGTERM)

    def stop(self, now: Nanoseconds) -> Reaction:
        signal.raise_signal(signal.SIGQUIT)
        return super().stop(now)


def test_what_must_come_to_rest_is_cut_short_by_no_signal() -> None:
    node, port = Interrupted(), Flat()
    ending = run(node, {"can": port}, Clock())
    assert (ending.reason, ending.in_order, node.requested) == ("SIGINT", True, 2)
    assert port.written[-3:] == STOPS


def test_where_it_may_be_left_it_is_and_states_what_becomes_of_it() -> None:
    node, port = Interrupted(), Flat()
    node.leave = True
    ending = run(node, {"can": port}, Clock())
    assert not ending.in_order
    assert ending.verdict == "it did not stop in good order; its wheels may turn"
    assert 0x100 not in port.written


class Steady(Clock):
    """Clock of a machine that is never busy: time passes while one waits, and for nothing else."""

    def restart(self) -> None:
        super().restart()
        self._at: Nanoseconds = 0

    def now(self) -> Nanoseconds:
        return self._at

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        ready = super().wait(filenos, 0)
        self._at = self._at if ready else max(self._at, until)
        return ready


def test_the_end_of_the_time_does_not_cut_a_stop_short() -> None:
    class Early(Winding):
        def tick(self, number: int) -> None:
            if number == 2:
                signal.raise_signal(signal.SIGINT)

    port = Flat()
    ending = run(Early(), {"can": port}, Steady(), until=8 * MILLISECOND)
    assert (ending.reason, ending.in_order) == ("SIGINT", True)
    assert port.written[-3:] == STOPS


def test_a_hang_up_that_is_ignored_stays_ignored() -> None:
    class Left(Winding):
        def tick(self, number: int) -> None:
            if number == 2:
                signal.raise_signal(signal.SIGHUP)

    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        ending = run(Left(), {"can": Flat()}, Clock(), until=20 * MILLISECOND)
    finally:
        signal.signal(signal.SIGHUP, before)
    assert ending.reason == "the time is over"


FAILURES: Final[tuple[Callable[[], BaseException], ...]] = (
    lambda: ZeroDivisionError("a mistake"),
    lambda: MemoryError("a mistake"),
    lambda: SystemExit("a mistake"),
    lambda: KeyboardInterrupt("a mistake"),
    lambda: OSError(28, "a mistake"),
)


PLACES: Final = ("receive", "wake", "stop", "stopping", "finished", "holding", "wait", "flush")


class Fault:
    """Fault that happens twice at one place: the second time while the node stops."""

    def __init__(self, place: str, failure: Callable[[], BaseException]) -> None:
        self.place = place
        self._failure = failure
        self._times = 2

    def at(self, place: str) -> None:
        if place == self.place and self._times:
            self._times -= 1
            raise self._failure()


class Failing(Winding):
    """Node that fails where its fault is; its stop is requested at its 4th tick, if it had not failed."""

    def __init__(self, fault: Fault, port: Flat) -> None:
        super().__init__()
        self.fault = fault
        self.port = port

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        reaction = super().receive(packet, now)
        self.fault.at("receive")
        return reaction

    def tick(self, number: int) -> None:
        if number == 2:
            self.port.take(b"x")
            self.fault.at("wake")
        if number == 4:
            signal.raise_signal(signal.SIGTERM)

    def wake(self, now: Nanoseconds) -> Reaction:
        if self.left == 2:
            self.fault.at("stopping")
            self.fault.at("wake")
        return super().wake(now)

    def stop(self, now: Nanoseconds) -> Reaction:
        self.port.take(b"x")
        self.fault.at("stop")
        return super().stop(now)

    @property
    def finished(self) -> bool:
        if len(self.woken) > 1:
            self.fault.at("finished")
        return False

    @property
    def holding(self) -> bool:
        self.fault.at("holding")
        return False


class FailingClock(Clock):
    def __init__(self, fault: Fault) -> None:
        super().__init__()
        self.fault = fault

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        if self.now() > MILLISECOND:
            self.fault.at("wait")
        return super().wait(filenos, until)


class FailingPort(Flat):
    def __init__(self, fault: Fault) -> None:
        super().__init__()
        self.fault = fault

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        super().write(address, payload, now)
        if self.fault.place == "flush":
            self.retry_at = now

    def flush(self, _now: Nanoseconds) -> None:
        self.retry_at = NEVER
        self.fault.at("flush")


@pytest.mark.parametrize("failure", FAILURES, ids=lambda it: type(it()).__name__)
@pytest.mark.parametrize("place", PLACES)
def test_whatever_fails_wherever_it_does_the_node_is_stopped(
    place: str, failure: Callable[[], BaseException]
) -> None:
    fault = Fault(place, failure)
    port, clock = FailingPort(fault), FailingClock(fault)
    node = Failing(fault, port)
    if place == "holding":
        assert run(node, {"can": port}, clock).in_order, "who cannot say that it holds something does not"
    else:
        with pytest.raises(type(failure()), match="a mistake") as raised:
            run(node, {"can": port}, clock)
        assert "was stopped in good order" in raised.value.__notes__[0]
    assert port.written[-3:] == STOPS
    assert clock.now() < SECOND


def test_what_fails_on_one_packet_receives_the_next_ones() -> None:
    class Picky(Winding):
        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            if packet.payload == b"bad":
                raise ValueError(packet.payload)
            return super().receive(packet, now)

    class Three(Flat):
        def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
            super().read(now)
            return [(1, b"good"), (2, b"bad"), (3, b"good")]

    node, port = Picky(), Three()
    port.take(b"x")
    with pytest.raises(ValueError, match="bad"):
        run(node, {"can": port}, Clock())
    assert [packet.address for packet in node.received] == [1, 3]


def test_a_file_that_someone_closed_is_a_port_that_is_lost() -> None:
    class Closed(Flat):
        def close(self) -> None:
            self._ends[0].detach()
            super().close()
            raise OSError(9, "Bad file descriptor")

    class Closing(Winding):
        def tick(self, number: int) -> None:
            if number == 2:
                os.close(gone)

    lost, other = Closed(), Flat()
    gone = lost.fileno()
    with pytest.raises(LostPort, match="Bad file descriptor") as raised:
        run(Closing(), {"other": lost, "can": other}, Clock())
    assert raised.value.port is lost
    assert other.written[-3:] == STOPS


def test_a_process_that_was_not_let_run_stops_as_long_as_it_may() -> None:
    """Suspended for an hour while it stops, it still has its time."""

    class Suspended(Clock):
        suspended: Nanoseconds = 0

        def now(self) -> Nanoseconds:
            return super().now() + self.suspended

        def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
            ready = super().wait(filenos, until)
            if node.left == 2 and not self.suspended:
                self.suspended = 3600 * SECOND
            return ready

    node, port, clock = Winding(), Flat(), Suspended()
    ending = run(node, {"can": port}, clock, until=10 * MILLISECOND)
    assert ending.in_order
    assert clock.suspended
    assert port.written[-3:] == STOPS


def test_a_node_that_never_takes_it_is_requested_until_its_time_is_over() -> None:
    class NotReceiving(Winding):
        requested = 0

        def stop(self, now: Nanoseconds) -> Reaction:
            self.requested += 1
            raise ValueError(now)

    node = NotReceiving()
    with pytest.raises(ValueError, match="0"):
        run(node, {}, Clock(), until=MILLISECOND, stop_within=4 * AGAIN)
    assert 2 <= node.requested <= 5


def test_a_node_that_has_not_taken_it_is_not_done_whatever_it_states_to_a_packet() -> None:
    class Idle(Winding):
        requested = 0

        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            super().receive(packet, now)
            return Reaction()

        def stop(self, now: Nanoseconds) -> Reaction:
            self.requested += 1
            if self.requested == 1:
                port.take(b"x")
                raise ValueError(now)
            return super().stop(now)

    node, port = Idle(), Flat()
    with pytest.raises(ValueError, match=r"\d"):
        run(node, {"can": port}, Clock(), until=10 * MILLISECOND)
    assert node.requested == 2
    assert port.written[-3:] == STOPS


def test_a_node_that_is_late_each_time_is_cut_off_all_the_same() -> None:
    """It wants to be woken at once, and takes longer for that than a machine that is not busy."""

    class Slow(Clock):
        took: Nanoseconds = 0

        def now(self) -> Nanoseconds:
            return super().now() + self.took

    class Endless(Winding):
        def wake(self, now: Nanoseconds) -> Reaction:
            clock.took += 20 * MILLISECOND
            return Reaction((), now)

    clock = Slow()
    ending = run(Endless(), {}, clock, until=MILLISECOND, stop_within=SECOND)
    assert not ending.in_order
    assert SECOND <= clock.now() < 2 * SECOND
