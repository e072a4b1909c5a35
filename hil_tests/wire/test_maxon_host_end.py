"""The host's end of a serial line: refusals, time-outs, noise."""

import pytest

from firmware_bridge.families.epos2.maxon.frame import Failure, Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.units import NEVER
from hil_tests.wire.maxon_ends import READ, REQUESTED_V1, REQUESTED_V2, TIMEOUT, both


def test_v1_the_host_states_which_step_failed() -> None:
    for stated, outcome in (
        (b"F", Failure.REFUSED),
        (b"OF", Failure.DAMAGED),
        (bytes.fromhex("4F4F 00 03 0000000040010000 5D47"), Failure.GARBLED),
    ):
        host = host_end(Generation.V1, TIMEOUT)
        host.ask(READ, 0)
        assert host.receive(stated, 5) is outcome
        assert not host.busy
        assert host.ready_at == (5 + TIMEOUT if outcome is Failure.GARBLED else 5)
    assert host.taken() == REQUESTED_V1 + b"OF"


@pytest.mark.parametrize("stated", ["", "4F", "4F4F", "4F4F00", "4F4F000300"])
def test_v1_the_host_gives_up_a_step_that_takes_too_long(stated: str) -> None:
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(READ, 0)
    assert host.receive(bytes.fromhex(stated), 9) is None
    since = 9 if stated else 0
    assert host.due == since + TIMEOUT
    assert host.wake(host.due - 1) is None
    assert host.wake(since + TIMEOUT) is Failure.SILENCE
    assert (host.due, host.ready_at) == (NEVER, since + 2 * TIMEOUT)


def test_v1_the_host_receives_the_handshake_through_noise() -> None:
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(READ, 0)
    assert host.receive(bytes.fromhex("01FF4F 02FF4F FF0100 030000000040010000 5D46 77"), 0) == MaxonAnswer(
        bytes.fromhex("0000000040010000")
    )


def test_v2_the_host_receives_its_answer_through_noise_and_reports_a_garbled_one() -> None:
    host = host_end(Generation.V2, TIMEOUT)
    host.ask(READ, 0)
    answer = bytes.fromhex("9002 0004 0000000040010000 2CC6")
    assert host.receive(b"\x90\x02\x10" + REQUESTED_V2 + answer, 0) == MaxonAnswer(answer[4:-2])
    host.ask(READ, 0)
    assert host.receive(answer[:-1] + b"\xc7", 0) is Failure.GARBLED
    host.ask(READ, 3)
    assert host.wake(3 + TIMEOUT) is Failure.SILENCE
    assert host.receive(answer, 4 + TIMEOUT) is None  # too late: no one waits


@both
def test_one_command_at_a_time(generation: Generation) -> None:
    host = host_end(generation, TIMEOUT)
    host.ask(READ, 0)
    with pytest.raises(RuntimeError, match="one command at a time"):
        host.ask(READ, 0)
