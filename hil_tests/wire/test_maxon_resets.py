"""A drive that is reset, or whose communication is, sends no end: the host takes the silence for success.

Source: comments in maxon's own library for PCs, for both protocols.
"""

import pytest

from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.families.epos2.maxon.frame import (
    Failure,
    Frame,
    Generation,
    MaxonAnswer,
    Outcome,
    encode_v1,
    encode_v2,
)
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.messages import Done, SendNmtService
from firmware_bridge.families.epos2.maxon.opcodes import RESETS_WITHIN, encode_answer, encode_request
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.wire.maxon_ends import TIMEOUT, device

RESETS = (NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION)
OTHERS = tuple(command for command in NmtCommand if command not in RESETS)


def nmt(command: int, node: int = 1) -> Frame:
    return encode_request(SendNmtService(node, command))


@pytest.mark.parametrize("node", [0, 1, 2])
@pytest.mark.parametrize(
    ("commands", "end"), [(RESETS, b""), (OTHERS, b"O")], ids=["resets", "other commands"]
)
def test_on_rs232_a_reset_has_no_end_acknowledge(
    commands: tuple[NmtCommand, ...], end: bytes, node: int
) -> None:
    for command in commands:
        drive, frame = device(Generation.V1), nmt(command, node)
        raw = encode_v1(frame)
        assert drive.receive(raw[:1], 0) is None
        assert drive.taken() == b"O"
        assert drive.receive(raw[1:], 0) == frame
        assert drive.taken() == end
        assert drive.answer(None, 0) is None
        assert (drive.taken(), drive.due, drive.idle) == (b"", NEVER, True)


def test_a_damaged_reset_is_refused_on_rs232() -> None:
    drive, raw = device(Generation.V1), encode_v1(nmt(NmtCommand.RESET_NODE))
    assert drive.receive(raw[:-1] + bytes((raw[-1] ^ 1,)), 0) is None
    assert drive.taken() == b"OF"


def requested(generation: Generation, command: int) -> tuple[Outcome | None, int]:
    """Request of a host a command without an end; return the outcome, and its time."""
    host = host_end(generation, TIMEOUT)
    host.ask(nmt(command), 0, answered=generation is Generation.V2)
    if generation is Generation.V1:
        assert host.receive(b"O", 0) is None
    due = host.due
    assert host.wake(due - 1) is None
    return host.wake(due), due


@pytest.mark.parametrize("generation", Generation)
def test_the_host_takes_silence_for_success_of_a_reset_alone(generation: Generation) -> None:
    assert [requested(generation, command) for command in RESETS] == [(MaxonAnswer(b""), RESETS_WITHIN)] * 2
    assert {requested(generation, command) for command in OTHERS} == {(Failure.SILENCE, TIMEOUT)}


@pytest.mark.parametrize("generation", Generation)
def test_a_device_that_ends_a_reset_all_the_same_is_understood(generation: Generation) -> None:
    host, body = host_end(generation, TIMEOUT), encode_answer(SendNmtService(1, 129), Done(0))
    host.ask(nmt(NmtCommand.RESET_NODE), 0, answered=generation is Generation.V2)
    end = b"OO" if generation is Generation.V1 else encode_v2(Frame(0, body))
    assert host.receive(end, MILLISECOND) == MaxonAnswer(b"" if generation is Generation.V1 else body)
    assert (host.busy, host.ready_at, host.due) == (False, MILLISECOND, NEVER)


def test_a_reset_that_no_one_begins_to_take_has_failed() -> None:
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(nmt(NmtCommand.RESET_NODE), 0, answered=False)
    assert host.wake(host.due) is Failure.SILENCE
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(nmt(NmtCommand.RESET_NODE), 0, answered=False)
    assert host.receive(b"OF", 0) is Failure.DAMAGED
