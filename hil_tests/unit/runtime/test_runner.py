"""The runner in real time: it carries, keeps time, and ends in good order whatever ends it."""

import signal
import socket
from collections.abc import Iterator, Sequence
from itertools import count

import pytest

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.bell import ENDING
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort, Port, UdpPort, open_can
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of

NUMBERS = count()


class Ticking:
    """Node that sends a frame every 5 ms and notes the time; may do something else at its nth tick."""

    period = 5 * MILLISECOND

    def __init__(self) -> None:
        self.woken: list[Nanoseconds] = []
        self.received: list[Packet] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        self.received.append(packet)
        return Reaction((), self._next())

    def wake(self, now: Nanoseconds) -> Reaction:
        self.woken.append(now)
        self.tick(len(self.woken))
        return Reaction((Packet("can", 0x80, b""),), self._next())

    def tick(self, number: int) -> None:
        del number

    def _next(self) -> Nanoseconds:
        return len(self.woken) * self.period


class Winding(Ticking):
    """Needs three more ticks to come to rest; each sends 0x100."""

    def __init__(self) -> None:
        super().__init__()
        self.stopped_at: Nanoseconds = NEVER
        self.left = 0

    def wake(self, now: Nanoseconds) -> Reaction:
        if self.stopped_at == NEVER:
            return super().wake(now)
        self.left -= 1
        return Reaction((Packet("can", 0x100, b""),), now + self.period if self.left else NEVER)

    def stop(self, now: Nanoseconds) -> Reaction:
        self.stopped_at = now
        self.left = 3
        return Reaction((), now + self.period)


class Flat:
    """A port in memory: frames go into a list; it may be lost at the nth."""

    name = "a bus in memory"

    def __init__(self, lost_at: int = -1) -> None:
        self.retry_at: Nanoseconds = NEVER
        self.written: list[int] = []
        self.closed = 0
        self._lost_at = lost_at
        self._ends = socket.socketpair()
        self._fileno = self._ends[0].fileno()

    def fileno(self) -> int:
        return self._fileno

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        return [(0x181, self._ends[0].recv(8))]

    def write(self, address: int, _payload: bytes, _now: Nanoseconds) -> None:
        if len(self.written) == self._lost_at:
            raise LostPort(self, "unplugged")
        self.written.append(address)

    def flush(self, now: Nanoseconds) -> None:
        del now

    def close(self) -> None:
        self.closed += 1
        for end in self._ends:
            end.close()

    def take(self, content: bytes) -> None:
        self._ends[1].send(content)


class Exact(Clock):
    """A machine that wakes no one late: it is then what it was to be."""

    def __init__(self) -> None:
        super().__init__()
        self._now: Nanoseconds = 0

    def restart(self) -> None:
        self._now = 0

    def now(self) -> Nanoseconds:
        return self._now

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        ready = super().wait(filenos, self._now)
        if not ready:
            self._now = max(self._now, until)
        return ready


@pytest.fixture
def pair() -> Iterator[tuple[Port, Port]]:
    channel = f"test-runner-{next(NUMBERS)}"
    one, two = open_can("virtual", channel), open_can("virtual", channel)
    yield one, two
    one.close()
    two.close()


def test_a_node_is_woken_at_zero_and_then_when_it_is_due() -> None:
    node, port = Ticking(), Flat()
    ending = run(node, {"can": port}, Clock(), until=52 * MILLISECOND)
    assert node.woken[0] == 0
    assert 3 <= len(node.woken) <= 11
    assert all(now >= k * node.period for k, now in enumerate(node.woken))
    assert port.written == [0x80] * len(node.woken)
    assert (ending.reason, ending.in_order) == ("the time is over", True)
    assert port.closed == 1


def test_frames_reach_the_node_by_a_thread_and_datagrams_by_a_socket(pair: tuple[Port, Port]) -> None:
    near, far = pair
    operator = UdpPort("udpin:127.0.0.1:0")
    caller = UdpPort(f"udpout:127.0.0.1:{operator.port}")
    node = Ticking()
    far.write(0x181, b"\1", 0)
    caller.write(0, b"hello", 0)
    place = number_of("127.0.0.1", caller.port)
    run(node, {"can": near, "operator": operator}, Clock(), until=30 * MILLISECOND)
    caller.close()
    by_link = sorted(node.received, key=lambda packet: packet.link)
    assert by_link == [Packet("can", 0x181, b"\1"), Packet("operator", place, b"hello")]
    assert (0x80, b"") in far.read(0)


def test_a_node_that_is_late_and_cannot_stop_is_not_woken_after_a_signal() -> None:
    class Late(Ticking):
        period = 0

        def tick(self, tick: int) -> None:
            if tick == 3:
                signal.raise_signal(signal.SIGINT)

    node, port = Late(), Flat()
    ending = run(node, {"can": port}, Clock(), until=SECOND)
    assert (ending.reason, ending.in_order) == ("SIGINT", True)
    assert len(node.woken) == 3


@pytest.fixture
def hang_ups_end() -> Iterator[None]:
    """Restore the default of SIGHUP, which the test runner may have set to be ignored."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("hang_ups_end")
@pytest.mark.parametrize("number", [signal.Signals[name] for name in ENDING], ids=str)
def test_a_signal_lets_the_node_come_to_rest(number: signal.Signals) -> None:
    class Interrupted(Winding):
        def tick(self, tick: int) -> None:
            if tick == 3:
                signal.raise_signal(number)

    before = signal.getsignal(number)
    node, port = Interrupted(), Flat()
    ending = run(node, {"can": port}, Clock(), until=SECOND)
    assert (ending.reason, ending.in_order) == (number.name, True)
    assert port.written == [0x80, 0x80, 0x80, 0x100, 0x100, 0x100]
    assert port.closed == 1
    assert signal.getsignal(number) is before


def test_a_second_signal_ends_at_once() -> None:
    class Impatient(Winding):
        def tick(self, tick: int) -> None:
            if tick == 2:
                signal.raise_signal(signal.SIGINT)
                signal.raise_signal(signal.SIGINT)

    node, port = Impatient(), Flat()
    ending = run(node, {"can": port}, Clock(), until=SECOND)
    assert not ending.in_order
    assert 0x100 not in port.written


class Gripping(Winding):
    """Node that, at the end request by a signal at its 2nd tick, holds something until a second request."""

    holding = False
    requested = 0
    held = 0
    ticks_before_second = 12

    def wake(self, now: Nanoseconds) -> Reaction:
        if not self.holding:
            return super().wake(now)
        self.held += 1
        if self.held == self.ticks_before_second:
            signal.raise_signal(signal.SIGINT)
        return Reaction((Packet("can", 0x200, b""),), now + self.period)

    def tick(self, number: int) -> None:
        if number == 2:
            signal.raise_signal(signal.SIGINT)

    def stop(self, now: Nanoseconds) -> Reaction:
        self.requested += 1
        self.holding = self.requested == 1
        return Reaction((), now + self.period) if self.holding else super().stop(now)


def test_a_node_that_holds_something_is_not_cut_off_and_is_requested_again_by_a_second_signal() -> None:
    node, port = Gripping(), Flat()
    ending = run(node, {"can": port}, Exact(), stop_within=20 * MILLISECOND)
    assert ending.in_order
    assert node.requested == 2
    assert port.written.count(0x200) == node.ticks_before_second, "60 ms, and the limit is 20 ms"
    assert port.written[-3:] == [0x100, 0x100, 0x100]


def test_over_a_lost_port_nothing_is_held() -> None:
    node, port = Gripping(), Flat(lost_at=5)
    clock = Exact()
    with pytest.raises(LostPort):
        run(node, {"can": port}, clock, stop_within=20 * MILLISECOND)
    assert clock.now() < SECOND
    assert node.held < node.ticks_before_second


def test_a_node_that_never_comes_to_rest_is_cut_off() -> None:
    class Endless(Winding):
        def stop(self, now: Nanoseconds) -> Reaction:
            super().stop(now)
            self.left = 10**9
            return Reaction((), now)

    clock = Clock()
    ending = run(Endless(), {}, clock, until=10 * MILLISECOND, stop_within=20 * MILLISECOND)
    assert not ending.in_order
    assert clock.now() < SECOND


def test_an_exception_in_the_node_is_raised_when_the_node_has_stopped() -> None:
    class Failing(Winding):
        def tick(self, tick: int) -> None:
            if tick == 2:
                raise ZeroDivisionError("a mistake")

    port = Flat()
    with pytest.raises(ZeroDivisionError, match="a mistake") as raised:
        run(Failing(), {"can": port}, Clock(), until=SECOND)
    assert port.written == [0x80, 0x100, 0x100, 0x100]
    assert port.closed == 1
    assert "in good order" in raised.value.__notes__[0]


def test_a_node_that_fails_again_while_it_stops_is_cut_off() -> None:
    class Hopeless(Winding):
        def tick(self, tick: int) -> None:
            raise ZeroDivisionError(tick)

        def stop(self, now: Nanoseconds) -> Reaction:
            raise ValueError(now)

    port = Flat()
    with pytest.raises(ZeroDivisionError) as raised:
        run(Hopeless(), {"can": port}, Clock(), until=SECOND, stop_within=20 * MILLISECOND)
    assert port.closed == 1
    assert "did not stop in good order" in raised.value.__notes__[0]


def test_a_lost_bus_is_raised_when_the_node_has_stopped_and_other_ports_still_work() -> None:
    class Telling(Winding):
        def wake(self, now: Nanoseconds) -> Reaction:
            reaction = super().wake(now)
            return Reaction((*reaction.sent, Packet("operator", 0, b"")), reaction.wake_at)

    bus, operator = Flat(lost_at=2), Flat()
    with pytest.raises(LostPort, match="lost a bus in memory: unplugged"):
        run(Telling(), {"can": bus, "operator": operator}, Clock(), until=SECOND)
    assert bus.written == [0x80, 0x80]
    assert len(operator.written) == 3 + 3, "what goes to others beside what the bus does not take leaves"
    assert (bus.closed, operator.closed) == (1, 1)


def test_a_bus_that_is_lost_while_nothing_is_sent_is_noticed_by_reading() -> None:
    class Silent(Ticking):
        def wake(self, now: Nanoseconds) -> Reaction:
            super().wake(now)
            if len(self.woken) == 2:
                port.take(b"x")
            return Reaction((), self._next())

    class Broken(Flat):
        def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
            raise LostPort(self, "the interface was taken down")

    port = Broken()
    clock = Clock()
    with pytest.raises(LostPort, match="taken down"):
        run(Silent(), {"can": port}, clock, until=SECOND)
    assert clock.now() < 500 * MILLISECOND


def test_what_waits_to_be_sent_is_sent_before_the_end() -> None:
    class Slow(Flat):
        def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
            if address == 0x80:
                self.retry_at = now + 10 * MILLISECOND
            else:
                super().write(address, payload, now)

        def flush(self, now: Nanoseconds) -> None:
            self.retry_at = NEVER
            super().write(0x80, b"", now)

    class Once(Ticking):
        def stop(self, now: Nanoseconds) -> Reaction:
            del now
            return Reaction((Packet("can", 0x80, b""),))

        def wake(self, now: Nanoseconds) -> Reaction:
            self.woken.append(now)
            return Reaction()

    port = Slow()
    ending = run(Once(), {"can": port}, Clock(), until=MILLISECOND)
    assert port.written == [0x80]
    assert ending.in_order


class Suspended(Clock):
    """Time goes on for 0.7 s, and a datagram comes, between a look at the ports and one at the clock."""

    def __init__(self, sender: socket.socket, address: tuple[str, int]) -> None:
        super().__init__()
        self._sender, self._address = sender, address
        self._gone: Nanoseconds = 0

    def now(self) -> Nanoseconds:
        return super().now() + self._gone

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        if self._gone:
            return super().wait(filenos, until)
        self._sender.sendto(b"in time", self._address)
        self._gone = 700 * MILLISECOND
        return []


def test_what_came_while_the_machine_was_busy_is_received_before_what_is_due_by_then() -> None:
    class Noting(Ticking):
        def __init__(self) -> None:
            super().__init__()
            self.did: list[str] = []

        def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
            self.did.append(packet.payload.decode())
            return super().receive(packet, now)

        def tick(self, number: int) -> None:
            self.did.append(f"tick {number}")

    node, port = Noting(), UdpPort("udpin:127.0.0.1:0")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        run(node, {"can": port}, Suspended(sender, ("127.0.0.1", port.port)), until=705 * MILLISECOND)
    assert node.did[:3] == ["tick 1", "in time", "tick 2"]
