"""The handshakes of both serial protocols: golden dialogues, fragments, garbage, time-outs, ends joined."""

from collections.abc import Callable

import pytest

from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire.maxon.end import DeviceEnd, HostEnd
from firmware_bridge.wire.maxon.frame import Answered, Failure, Frame, Generation, Outcome, encode_v2
from firmware_bridge.wire.maxon.lines import device_end, host_end
from firmware_bridge.wire.maxon.opcodes import encode_answer, encode_request, row_of
from firmware_bridge.wire.maxon.v1 import ROOM
from hil_tests.wire.maxon_frames import EXCHANGES, Exchange

TIMEOUT: Nanoseconds = 500 * MILLISECOND
BAD_CHECKSUM = 0x0504_0004

Cut = Callable[[bytes], list[bytes]]
CUTS: dict[str, Cut] = {
    "whole": lambda raw: [raw] if raw else [],
    "byte by byte": lambda raw: [raw[i : i + 1] for i in range(len(raw))],
}
both = pytest.mark.parametrize("generation", Generation)
fragmented = pytest.mark.parametrize("cut", CUTS.values(), ids=CUTS)


def device(generation: Generation = Generation.V1) -> DeviceEnd:
    return device_end(generation, lambda: TIMEOUT, BAD_CHECKSUM)


def golden(exchange: Exchange, generation: Generation) -> tuple[bytes, bytes]:
    pair = exchange.v1 if generation is Generation.V1 else exchange.v2
    assert pair is not None
    return bytes.fromhex(pair[0]), bytes.fromhex(pair[1])


def dialogue(exchange: Exchange, generation: Generation) -> list[tuple[str, bytes]]:
    """Write down who says what: H the host, D the device."""
    asked, answered = golden(exchange, generation)
    if generation is Generation.V2:
        return [("H", asked), ("D", answered)]
    said = [("H", asked[:1]), ("D", b"O"), ("H", asked[1:]), ("D", b"O")]
    if answered:
        said += [("D", answered[:1]), ("H", b"O"), ("D", answered[1:]), ("H", b"O")]
    return said


CASES = [
    pytest.param(exchange, generation, id=f"{exchange}-{generation.value}")
    for exchange in EXCHANGES
    for generation, pair in ((Generation.V1, exchange.v1), (Generation.V2, exchange.v2))
    if pair is not None
]
every_exchange = pytest.mark.parametrize(("exchange", "generation"), CASES)


def serve(
    end: DeviceEnd, exchange: Exchange, generation: Generation, chunk: bytes, now: Nanoseconds
) -> bytes:
    """Give the device bytes and answer what comes out; return what it says."""
    frame = end.hear(chunk, now)
    while frame is not None:
        assert frame == encode_request(exchange.request)
        silent = generation not in row_of(exchange.request).answered
        frame = end.answer(None if silent else encode_answer(exchange.request, exchange.answer), now)
    return end.taken()


@fragmented
@every_exchange
def test_the_device_says_its_part(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    end = device(generation)
    for _ in range(2):  # the second time shows that the first has left nothing behind
        said = dialogue(exchange, generation)
        while said:
            asked = b"".join(raw for who, raw in _turn(said, "H"))
            expected = b"".join(raw for who, raw in _turn(said, "D"))
            heard = b"".join(serve(end, exchange, generation, chunk, 0) for chunk in cut(asked))
            assert heard == expected
        assert end.due == NEVER


@fragmented
@every_exchange
def test_the_host_says_its_part(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    end = host_end(generation, TIMEOUT)
    answered = generation in row_of(exchange.request).answered
    for _ in range(2):
        end.ask(encode_request(exchange.request), 0, answered=answered)
        said, outcome = dialogue(exchange, generation), None
        while said:
            assert end.taken() == b"".join(raw for _, raw in _turn(said, "H"))
            for chunk in cut(b"".join(raw for _, raw in _turn(said, "D"))):
                assert outcome is None
                outcome = end.hear(chunk, 0)
        assert end.taken() == b""
        body = encode_answer(exchange.request, exchange.answer) if answered else b""
        assert outcome == Answered(body)
        assert not end.busy
        assert (end.due, end.ready_at) == (NEVER, 0)


def _turn(said: list[tuple[str, bytes]], who: str) -> list[tuple[str, bytes]]:
    turn = []
    while said and said[0][0] == who:
        turn.append(said.pop(0))
    return turn


GARBAGE = {
    # Bytes that are no command; on RS232 each one is refused with an F.
    Generation.V1: bytes.fromhex("00FF4F46909055AA"),
    # Half a frame, single DLEs, a DLE before the frame itself.
    Generation.V2: bytes.fromhex("0211900290904F9002100290"),
}


@fragmented
@every_exchange
def test_garbage_before_and_between_commands(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    end, now = device(generation), 0
    for _ in range(3):
        for chunk in cut(GARBAGE[generation]):
            said = serve(end, exchange, generation, chunk, now)
            assert said in {b"", b"F" * len(chunk)}
        now += TIMEOUT
        for chunk in cut(golden(exchange, generation)[0]):
            said = serve(end, exchange, generation, chunk, now)
        assert said[:1] == (b"O" if generation is Generation.V1 else said[:1])
        assert said
        answered = generation in row_of(exchange.request).answered
        if generation is Generation.V1 and answered:
            said = serve(end, exchange, generation, b"O", now)
            assert said == golden(exchange, generation)[1][1:]
            assert serve(end, exchange, generation, b"O", now) == b""


def join(
    host: HostEnd, drive: DeviceEnd, body: bytes | None, spoil: Callable[[bytes], bytes] = lambda raw: raw
) -> Outcome | None:
    """Carry bytes between the two ends until nobody says anything."""
    outcome = None
    for _ in range(1000):
        asked = host.taken()
        frame = drive.hear(asked, 0) if asked else None
        if frame is not None:
            drive.answer(body, 0)
        said = spoil(drive.taken())
        if not asked and not said:
            return outcome
        if said:
            outcome = host.hear(said, 0) or outcome
    raise AssertionError("they never stop")


@every_exchange
def test_both_ends_understand_each_other(exchange: Exchange, generation: Generation) -> None:
    host, drive = host_end(generation, TIMEOUT), device(generation)
    answered = generation in row_of(exchange.request).answered
    body = encode_answer(exchange.request, exchange.answer) if answered else None
    for _ in range(3):
        host.ask(encode_request(exchange.request), 0, answered=answered)
        assert join(host, drive, body) == Answered(body or b"")


READ = Frame(0x10, bytes.fromhex("41600001"))
ASKED_V1 = bytes.fromhex("1001 41600001 ABF0")
ASKED_V2 = bytes.fromhex("9002 1002 41600001 64CF")


def test_v1_a_wrong_check_sum_is_refused_and_the_next_command_taken() -> None:
    end = device()
    assert end.hear(ASKED_V1[:-1] + b"\xf1", 0) is None
    assert end.taken() == b"OF"
    assert end.hear(ASKED_V1, 0) == READ
    assert end.taken() == b"OO"


@pytest.mark.parametrize("opcode", [0x00, 0x16, 0x22, 0x4F, 0x46, 0x60, 0x90, 0xFF])
def test_v1_an_unknown_opcode_is_refused(opcode: int) -> None:
    end = device()
    assert end.hear(bytes((opcode,)), 0) is None
    assert end.taken() == b"F"
    assert end.due == NEVER


@pytest.mark.parametrize("taken", range(1, len(ASKED_V1)))
def test_v1_half_a_command_is_forgotten_after_the_time_out_and_not_before(taken: int) -> None:
    end = device()
    end.hear(ASKED_V1[:taken], 7)
    end.taken()
    assert end.due == 7 + TIMEOUT
    end.wake(7 + TIMEOUT - 1)
    assert end.hear(ASKED_V1[taken:], 7 + TIMEOUT - 1) == READ
    end = device()
    end.hear(ASKED_V1[:taken], 7)
    end.taken()
    assert end.hear(ASKED_V1, 7 + TIMEOUT) == READ
    assert end.taken() == b"OO"


def test_v1_a_host_that_does_not_want_the_answer_loses_it() -> None:
    for reply in (b"F", b"x", b"\x10"):
        end = device()
        end.hear(ASKED_V1, 0)
        end.answer(bytes(8), 0)
        assert end.taken() == b"OO\0"
        assert end.due == TIMEOUT
        assert end.hear(reply, 0) is None
        assert (end.taken(), end.due) == (b"", NEVER)
        assert end.hear(ASKED_V1, 0) == READ


@pytest.mark.parametrize("agreed", [b"", b"O"])
def test_v1_a_host_that_goes_away_is_forgotten(agreed: bytes) -> None:
    end = device()
    end.hear(ASKED_V1, 0)
    end.answer(bytes(8), 0)
    end.hear(agreed, 100)
    end.taken()
    assert end.due == (100 if agreed else 0) + TIMEOUT
    end.wake(end.due)
    assert end.due == NEVER
    assert end.hear(ASKED_V1, 2 * TIMEOUT) == READ


def test_v1_a_failed_last_answer_is_not_said_again() -> None:
    end = device()
    end.hear(ASKED_V1, 0)
    end.answer(bytes(8), 0)
    end.hear(b"O", 0)
    end.taken()
    assert end.hear(b"F", 0) is None
    assert (end.taken(), end.due) == (b"", NEVER)


@both
def test_work_has_no_time_out_and_what_comes_meanwhile_waits(generation: Generation) -> None:
    end = device(generation)
    asked = ASKED_V1 if generation is Generation.V1 else ASKED_V2
    assert end.hear(asked, 0) == READ
    assert end.due == NEVER
    end.taken()
    rest = b"OO" + asked if generation is Generation.V1 else asked
    assert end.hear(rest, TIMEOUT * 9) is None
    assert end.taken() == b""
    assert end.answer(bytes(8), TIMEOUT * 10) == READ
    end.answer(bytes(8), TIMEOUT * 10)
    assert len(end.taken()) > 12


@both
def test_what_waits_is_bounded_and_what_arrives_at_once_is_not(generation: Generation) -> None:
    end = device(generation)
    asked = ASKED_V1 if generation is Generation.V1 else ASKED_V2
    assert end.hear(b"\xff" * 10 * ROOM + asked, 0) == READ
    end.hear(b"\xff" * 2 * ROOM, 0)
    end.hear(asked, 0)
    assert end.answer(None, 0) is None  # the command came when there was no room


def test_v2_a_wrong_check_sum_is_answered_with_an_error() -> None:
    end = device(Generation.V2)
    assert end.hear(ASKED_V2[:-1] + b"\xce", 0) is None
    assert end.taken() == encode_v2(Frame(0, BAD_CHECKSUM.to_bytes(4, "little")))
    assert end.hear(ASKED_V2, 0) == READ


@pytest.mark.parametrize("taken", range(2, len(ASKED_V2)))
def test_v2_the_next_frame_ends_a_half_one_at_any_point(taken: int) -> None:
    end = device(Generation.V2)
    assert end.hear(ASKED_V2[:taken] + ASKED_V2, 0) == READ
    assert end.taken() == b""


@pytest.mark.parametrize("taken", range(2, len(ASKED_V2)))
def test_v2_half_a_frame_is_forgotten_after_the_time_out_and_not_before(taken: int) -> None:
    for late, found in ((TIMEOUT - 1, READ), (TIMEOUT, None)):
        end = device(Generation.V2)
        end.hear(ASKED_V2[:taken], 7)
        assert end.due == 7 + TIMEOUT
        assert end.hear(ASKED_V2[taken:], 7 + late) == found


def test_v2_a_frame_cut_off_behind_a_dle_swallows_the_next_one_until_the_time_out() -> None:
    end = device(Generation.V2)
    assert end.hear(bytes.fromhex("9002 1002 90") + ASKED_V2, 0) is None
    end.taken()
    assert end.hear(ASKED_V2, TIMEOUT) == READ


@pytest.mark.parametrize("noise", ["90", "9090", "909090", "02", "9003", "900210FF", "90021002416090FF"])
def test_v2_noise_hides_no_frame(noise: str) -> None:
    assert device(Generation.V2).hear(bytes.fromhex(noise) + ASKED_V2, 0) == READ


def test_v1_the_host_says_which_step_failed() -> None:
    for said, outcome in (
        (b"F", Failure.REFUSED),
        (b"OF", Failure.DAMAGED),
        (bytes.fromhex("4F4F 00 03 0000000040010000 5D47"), Failure.GARBLED),
    ):
        host = host_end(Generation.V1, TIMEOUT)
        host.ask(READ, 0)
        assert host.hear(said, 5) is outcome
        assert not host.busy
        assert host.ready_at == (5 + TIMEOUT if outcome is Failure.GARBLED else 5)
    assert host.taken() == ASKED_V1 + b"OF"


@pytest.mark.parametrize("said", ["", "4F", "4F4F", "4F4F00", "4F4F000300"])
def test_v1_the_host_gives_up_a_step_that_takes_too_long(said: str) -> None:
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(READ, 0)
    assert host.hear(bytes.fromhex(said), 9) is None
    since = 9 if said else 0
    assert host.due == since + TIMEOUT
    assert host.wake(host.due - 1) is None
    assert host.wake(since + TIMEOUT) is Failure.SILENCE
    assert (host.due, host.ready_at) == (NEVER, since + 2 * TIMEOUT)


def test_v1_the_host_hears_the_handshake_through_noise() -> None:
    host = host_end(Generation.V1, TIMEOUT)
    host.ask(READ, 0)
    assert host.hear(bytes.fromhex("01FF4F 02FF4F FF0100 030000000040010000 5D46 77"), 0) == Answered(
        bytes.fromhex("0000000040010000")
    )


def test_v2_the_host_hears_its_answer_through_noise_and_tells_a_garbled_one() -> None:
    host = host_end(Generation.V2, TIMEOUT)
    host.ask(READ, 0)
    answer = bytes.fromhex("9002 0004 0000000040010000 2CC6")
    assert host.hear(b"\x90\x02\x10" + ASKED_V2 + answer, 0) == Answered(answer[4:-2])
    host.ask(READ, 0)
    assert host.hear(answer[:-1] + b"\xc7", 0) is Failure.GARBLED
    host.ask(READ, 3)
    assert host.wake(3 + TIMEOUT) is Failure.SILENCE
    assert host.hear(answer, 4 + TIMEOUT) is None  # too late: nobody waits


@both
def test_one_command_at_a_time(generation: Generation) -> None:
    host = host_end(generation, TIMEOUT)
    host.ask(READ, 0)
    with pytest.raises(RuntimeError, match="one command at a time"):
        host.ask(READ, 0)


@both
def test_a_restarted_device_has_forgotten_everything(generation: Generation) -> None:
    end = device(generation)
    asked = ASKED_V1 if generation is Generation.V1 else ASKED_V2
    end.hear(asked + asked, 0)
    end.reset()
    assert end.answer(bytes(8), 0) is None
    assert (end.taken(), end.due) == (b"", NEVER)
    assert end.hear(asked, 0) == READ
