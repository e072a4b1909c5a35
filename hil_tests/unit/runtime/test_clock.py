"""The clock of emulated devices stands still while the machine does not let the process run."""

import time
from collections.abc import Callable

import pytest

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.clock import STALL, Clock, LivedClock
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.unit.runtime.test_runner import Exact, Flat, Ticking

Suspend = Callable[[Nanoseconds], None]


@pytest.fixture
def suspend(monkeypatch: pytest.MonkeyPatch) -> Suspend:
    """Return what stops the process: the machine's time goes on, and nothing is done."""
    gone = 0
    real = time.monotonic_ns

    def stopped(duration: Nanoseconds) -> None:
        nonlocal gone
        gone += duration

    monkeypatch.setattr(time, "monotonic_ns", lambda: real() + gone)
    return stopped


def test_a_stop_between_two_looks_is_not_lived(suspend: Suspend) -> None:
    clock, real = LivedClock(), Clock()
    before = clock.now()
    suspend(700 * MILLISECOND)
    assert clock.now() == before
    assert real.now() >= 700 * MILLISECOND
    assert (clock.stalls, clock.stalled // MILLISECOND) == (1, 700)
    clock.restart()
    assert (clock.stalls, clock.stalled) == (0, 0)


def test_a_busy_machine_is_no_stop(suspend: Suspend) -> None:
    clock = LivedClock()
    before = clock.now()
    suspend(STALL // 2)
    assert clock.now() >= before + STALL // 2
    assert clock.stalls == 0


def test_what_was_waited_for_is_lived_and_what_came_on_top_is_not(
    suspend: Suspend, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = LivedClock()
    requested: list[float] = []

    def select(*arguments: float) -> tuple[list[int], list[int], list[int]]:
        requested.append(arguments[-1])
        suspend(3 * SECOND + 700 * MILLISECOND)
        return [], [], []

    monkeypatch.setattr("select.select", select)
    until = clock.now() + 3 * SECOND
    clock.wait([], until)
    assert requested[0] == pytest.approx(3.0, abs=0.05)
    assert until <= clock.now() <= until + STALL
    assert (clock.stalls, clock.stalled // SECOND) == (1, 0)


class Patient:
    """Device that answers a command, and gives its host 500 ms for the next, as a drive on RS232 does."""

    def __init__(self) -> None:
        self.did: list[str] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.did.append(packet.payload.decode())
        if len(self.did) == 1:
            return Reaction((Packet("can", 0x80, b""),), now + 500 * MILLISECOND)
        return Reaction((), NEVER)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now:
            self.did.append("given up")
        return Reaction((), NEVER)


@pytest.mark.parametrize(("kind", "then"), [(LivedClock, "answer"), (Clock, "given up")])
def test_a_device_that_was_stopped_while_it_spoke_gives_its_host_all_of_its_time(
    suspend: Suspend, kind: type[Clock], then: str
) -> None:
    class Stopped(Flat):
        """The process is stopped as it writes; its host answers once it has read that."""

        def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
            super().write(address, payload, now)
            suspend(700 * MILLISECOND)
            self.retry_at = now + 20 * MILLISECOND

        def flush(self, now: Nanoseconds) -> None:
            del now
            self.retry_at = NEVER
            self.take(b"answer")

    node, port = Patient(), Stopped()
    port.take(b"command")
    run(node, {"can": port}, kind(), until=200 * MILLISECOND)
    assert node.did[:2] == ["command", then]


def test_who_wants_to_be_woken_at_once_is_not_late_for_an_instant_long_gone() -> None:
    class AtOnce(Ticking):
        def _next(self) -> Nanoseconds:
            return super()._next() if len(self.woken) % 3 else 0

    node = AtOnce()
    ending = run(node, {"can": Flat()}, Exact(), until=100 * MILLISECOND)
    assert ending.latest_wake == 0
    assert len(node.woken) > 10
