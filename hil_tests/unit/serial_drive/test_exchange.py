"""The jobs of one line: one command at a time, the most urgent first, each with exactly one ending."""

from dataclasses import dataclass, field

from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.families.epos2.driver.serial.exchange import PATIENCE, Job, LineExchange, Rank, Result
from firmware_bridge.families.epos2.maxon.frame import Failure, MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import Done, ReadObject, Request, WriteObject
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer
from firmware_bridge.families.epos2.maxon.packets import command, outcome_packet
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds


@dataclass
class Notes:
    """An owner who writes down what became of his jobs."""

    ends: list[tuple[Request, Result]] = field(default_factory=list)

    def ended(self, _job: Job, request: Request, result: Result, _now: Nanoseconds) -> None:
        self.ends.append((request, result))


def write(number: int) -> WriteObject:
    return WriteObject(0x60FF, 0, number, bytes(4))


def done(request: Request, error: int = 0) -> Packet:
    return outcome_packet(command(request).address, MaxonAnswer(encode_answer(request, Done(error))))


def failed(request: Request) -> Packet:
    return outcome_packet(command(request).address, Failure.SILENCE)


def test_the_most_urgent_goes_first_and_equals_in_their_order() -> None:
    notes, exchange = Notes(), LineExchange("line")
    ranks = [Rank.ROTATING, Rank.TASK, Rank.SAMPLE, Rank.SAMPLE, Rank.BEAT, Rank.SET_POINT]
    for number, rank in enumerate(ranks, 1):
        exchange.put(Job(rank, notes, (write(number),)))
    order = []
    sent = exchange.go_on()
    while sent:
        node = sent[0].payload[3]
        order.append(node)
        sent = exchange.receive(done(write(node)), 0)
    assert order == [6, 5, 3, 4, 2, 1]


def test_one_command_is_under_way_at_a_time() -> None:
    notes, exchange = Notes(), LineExchange("line")
    exchange.put(Job(Rank.TASK, notes, (write(1), write(2))))
    assert exchange.go_on() == (command(write(1), "line"),)
    assert exchange.go_on() == ()
    assert exchange.receive(done(write(1)), 5) == (command(write(2), "line"),)


def test_the_rest_of_an_job_follows_only_a_success() -> None:
    """A controlword must not make a target count that the drive did not take."""
    for answer in (done(write(1), 0x0609_0030), failed(write(1))):
        notes, exchange = Notes(), LineExchange("line")
        job = Job(Rank.SET_POINT, notes, (write(1), write(2)))
        exchange.put(job)
        exchange.go_on()
        assert exchange.receive(answer, 0) == ()
        assert job.over
        assert [request for request, _ in notes.ends] == [write(1)]


def test_a_dropped_job_ends_with_the_command_that_is_under_way() -> None:
    notes, exchange = Notes(), LineExchange("line")
    job = Job(Rank.SET_POINT, notes, (write(1), write(2)))
    exchange.put(job)
    exchange.go_on()
    exchange.drop(job)
    assert exchange.receive(done(write(1)), 0) == ()


def test_what_answers_nothing_is_ignored() -> None:
    notes, exchange = Notes(), LineExchange("line")
    assert exchange.receive(done(write(1)), 0) == ()
    exchange.put(Job(Rank.TASK, notes, (ReadObject(0x6041, 0, 1),)))
    exchange.go_on()
    exchange.receive(done(write(1)), 0)
    assert notes.ends == []


def test_a_command_that_no_one_answers_for_ends_at_last() -> None:
    notes, exchange = Notes(), LineExchange("line")
    exchange.put(Job(Rank.TASK, notes, (write(1),)))
    exchange.go_on()
    assert exchange.wake_at == PATIENCE
    exchange.wake(PATIENCE - 1)
    assert notes.ends == []
    exchange.wake(PATIENCE)
    assert notes.ends == [(write(1), Failure.SILENCE)]


def test_on_a_lost_line_everything_fails_and_nothing_leaves_until_it_is_back() -> None:
    notes, exchange = Notes(), LineExchange("line")
    for number in (1, 2):
        exchange.put(Job(Rank.TASK, notes, (write(number),)))
    exchange.go_on()
    assert exchange.receive(Packet("line", LINE_LOST, b""), 7) == ()
    assert notes.ends == [(write(1), Failure.SILENCE), (write(2), Failure.SILENCE)]
    exchange.put(Job(Rank.TASK, notes, (write(3),)))
    assert exchange.go_on() == ()
    assert exchange.wake_at == 0
    exchange.wake(8)
    assert notes.ends[-1] == (write(3), Failure.SILENCE)
    exchange.receive(Packet("line", LINE_BACK, b""), 9)
    exchange.put(Job(Rank.TASK, notes, (write(4),)))
    assert exchange.go_on() == (command(write(4), "line"),)


ANSWERS = {"done": done(write(1)), "refused": done(write(1), 1), "failed": failed(write(1))}
LINE = {
    "lost": Packet("line", LINE_LOST, b""),
    "back": Packet("line", LINE_BACK, b""),
    "garbage": Packet("line", 0x99, b"\xff"),
}
PUTS = st.tuples(st.sampled_from(Rank), st.integers(1, 3))
EVENTS = st.lists(st.one_of(PUTS, st.sampled_from([*ANSWERS, *LINE])), max_size=60)


@given(EVENTS)
def test_whatever_happens_every_job_ends_once_and_one_command_is_on_the_line(
    events: list[tuple[Rank, int] | str],
) -> None:
    notes, exchange = Notes(), LineExchange("line")
    jobs: list[Job] = []
    on_line: list[Packet] = []
    for now, event in enumerate(events):
        if isinstance(event, tuple):
            rank, length = event
            jobs.append(Job(rank, notes, tuple(write(n) for n in range(1, length + 1))))
            exchange.put(jobs[-1])
            on_line += exchange.go_on()
        elif event in LINE or on_line:
            on_line = on_line if event in {"back", "garbage"} else []
            on_line += exchange.receive(LINE.get(event) or ANSWERS[event], now)
        assert len(on_line) <= 1
    exchange.receive(LINE["lost"], len(events))
    exchange.wake(len(events))
    assert all(job.over for job in jobs)
