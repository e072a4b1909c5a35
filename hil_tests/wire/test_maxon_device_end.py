"""The device's end of a serial line: damage, half commands, hosts that go away, what waits meanwhile."""

import pytest

from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, encode_v2
from firmware_bridge.families.epos2.maxon.v1 import ROOM
from firmware_bridge.units import NEVER
from hil_tests.wire.maxon_ends import (
    BAD_CHECKSUM,
    READ,
    REQUESTED,
    REQUESTED_V1,
    REQUESTED_V2,
    TIMEOUT,
    both,
    device,
)


def test_v1_a_wrong_check_sum_is_refused_and_the_next_command_taken() -> None:
    end = device()
    assert end.receive(REQUESTED_V1[:-1] + b"\xf1", 0) is None
    assert end.taken() == b"OF"
    assert end.receive(REQUESTED_V1, 0) == READ
    assert end.taken() == b"OO"


@pytest.mark.parametrize("opcode", [0x00, 0x16, 0x22, 0x4F, 0x46, 0x60, 0x90, 0xFF])
def test_v1_an_unknown_opcode_is_refused(opcode: int) -> None:
    end = device()
    assert end.receive(bytes((opcode,)), 0) is None
    assert end.taken() == b"F"
    assert end.due == NEVER


@pytest.mark.parametrize("taken", range(1, len(REQUESTED_V1)))
def test_v1_half_a_command_is_forgotten_after_the_time_out_and_not_before(taken: int) -> None:
    end = device()
    end.receive(REQUESTED_V1[:taken], 7)
    end.taken()
    assert end.due == 7 + TIMEOUT
    end.wake(7 + TIMEOUT - 1)
    assert end.receive(REQUESTED_V1[taken:], 7 + TIMEOUT - 1) == READ
    end = device()
    end.receive(REQUESTED_V1[:taken], 7)
    end.taken()
    end.wake(7 + TIMEOUT)
    assert end.receive(REQUESTED_V1, 7 + TIMEOUT) == READ
    assert end.taken() == b"OO"


def test_v1_a_host_that_does_not_want_the_answer_loses_it() -> None:
    for reply in (b"F", b"x", b"\x10"):
        end = device()
        end.receive(REQUESTED_V1, 0)
        end.answer(bytes(8), 0)
        assert end.taken() == b"OO\0"
        assert end.due == TIMEOUT
        assert end.receive(reply, 0) is None
        assert (end.taken(), end.due) == (b"", NEVER)
        assert end.receive(REQUESTED_V1, 0) == READ


@pytest.mark.parametrize("agreed", [b"", b"O"])
def test_v1_a_host_that_goes_away_is_forgotten(agreed: bytes) -> None:
    end = device()
    end.receive(REQUESTED_V1, 0)
    end.answer(bytes(8), 0)
    end.receive(agreed, 100)
    end.taken()
    assert end.due == (100 if agreed else 0) + TIMEOUT
    end.wake(end.due)
    assert end.due == NEVER
    assert end.receive(REQUESTED_V1, 2 * TIMEOUT) == READ


def test_v1_a_failed_last_answer_is_not_stated_again() -> None:
    end = device()
    end.receive(REQUESTED_V1, 0)
    end.answer(bytes(8), 0)
    end.receive(b"O", 0)
    end.taken()
    assert end.receive(b"F", 0) is None
    assert (end.taken(), end.due) == (b"", NEVER)


@both
def test_work_has_no_time_out_and_what_comes_meanwhile_waits(generation: Generation) -> None:
    end = device(generation)
    requested = REQUESTED[generation]
    assert end.receive(requested, 0) == READ
    assert end.due == NEVER
    end.taken()
    rest = b"OO" + requested if generation is Generation.V1 else requested
    assert end.receive(rest, TIMEOUT * 9) is None
    assert end.taken() == b""
    assert end.answer(bytes(8), TIMEOUT * 10) == READ
    end.answer(bytes(8), TIMEOUT * 10)
    assert len(end.taken()) > 12


@both
def test_what_waits_is_bounded_and_what_arrives_at_once_is_not(generation: Generation) -> None:
    end = device(generation)
    requested = REQUESTED[generation]
    assert end.receive(b"\xff" * 10 * ROOM + requested, 0) == READ
    end.receive(b"\xff" * 2 * ROOM, 0)
    end.receive(requested, 0)
    assert end.answer(None, 0) is None  # the command came when there was no room


def test_v2_a_wrong_check_sum_is_answered_with_an_error() -> None:
    end = device(Generation.V2)
    assert end.receive(REQUESTED_V2[:-1] + b"\xce", 0) is None
    assert end.taken() == encode_v2(Frame(0, BAD_CHECKSUM.to_bytes(4, "little")))
    assert end.receive(REQUESTED_V2, 0) == READ


@pytest.mark.parametrize("taken", range(2, len(REQUESTED_V2)))
def test_v2_the_next_frame_ends_a_half_one_at_any_point(taken: int) -> None:
    end = device(Generation.V2)
    assert end.receive(REQUESTED_V2[:taken] + REQUESTED_V2, 0) == READ
    assert end.taken() == b""


@pytest.mark.parametrize("taken", range(2, len(REQUESTED_V2)))
def test_v2_half_a_frame_is_forgotten_after_the_time_out_and_not_before(taken: int) -> None:
    for late, found in ((TIMEOUT - 1, READ), (TIMEOUT, None)):
        end = device(Generation.V2)
        end.receive(REQUESTED_V2[:taken], 7)
        assert end.due == 7 + TIMEOUT
        end.wake(7 + late)
        assert end.receive(REQUESTED_V2[taken:], 7 + late) == found


@pytest.mark.parametrize("generation", Generation)
def test_what_a_busy_machine_hands_over_late_has_arrived_in_time(generation: Generation) -> None:
    requested = REQUESTED_V1 if generation is Generation.V1 else REQUESTED_V2
    end = device(generation)
    end.receive(requested[:3], 7)
    assert end.receive(requested[3:], 7 + 2 * TIMEOUT) == READ


def test_v2_a_frame_cut_off_behind_a_dle_swallows_the_next_one_until_the_time_out() -> None:
    end = device(Generation.V2)
    assert end.receive(bytes.fromhex("9002 1002 90") + REQUESTED_V2, 0) is None
    end.taken()
    assert end.receive(REQUESTED_V2, TIMEOUT) == READ


@pytest.mark.parametrize("noise", ["90", "9090", "909090", "02", "9003", "900210FF", "90021002416090FF"])
def test_v2_noise_hides_no_frame(noise: str) -> None:
    assert device(Generation.V2).receive(bytes.fromhex(noise) + REQUESTED_V2, 0) == READ


@both
def test_a_restarted_device_has_forgotten_everything(generation: Generation) -> None:
    end = device(generation)
    requested = REQUESTED[generation]
    end.receive(requested + requested, 0)
    end.reset()
    assert end.answer(bytes(8), 0) is None
    assert (end.taken(), end.due) == (b"", NEVER)
    assert end.receive(requested, 0) == READ
