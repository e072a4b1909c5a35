"""The handshakes of both serial protocols: golden dialogues, fragments and garbage, and both ends joined."""

from collections.abc import Callable

from firmware_bridge.families.epos2.maxon.end import DeviceEnd, HostEnd
from firmware_bridge.families.epos2.maxon.frame import Generation, MaxonAnswer, Outcome
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer, encode_request, row_of
from firmware_bridge.units import NEVER, Nanoseconds
from hil_tests.wire.maxon_dialogues import Cut, dialogue, every_exchange, fragmented, golden
from hil_tests.wire.maxon_ends import TIMEOUT, device
from hil_tests.wire.maxon_frames import Exchange


def serve(
    end: DeviceEnd, exchange: Exchange, generation: Generation, chunk: bytes, now: Nanoseconds
) -> bytes:
    """Give the device bytes and answer its requests; return its bytes."""
    frame = end.receive(chunk, now)
    while frame is not None:
        assert frame == encode_request(exchange.request)
        silent = generation not in row_of(exchange.request).answered
        frame = end.answer(None if silent else encode_answer(exchange.request, exchange.answer), now)
    return end.taken()


@fragmented
@every_exchange
def test_the_device_states_its_part(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    end = device(generation)
    for _ in range(2):  # the second time shows that the first has left nothing behind
        stated = dialogue(exchange, generation)
        while stated:
            requested = b"".join(raw for who, raw in _turn(stated, "H"))
            expected = b"".join(raw for who, raw in _turn(stated, "D"))
            received = b"".join(serve(end, exchange, generation, chunk, 0) for chunk in cut(requested))
            assert received == expected
        assert end.due == NEVER


@fragmented
@every_exchange
def test_the_host_states_its_part(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    end = host_end(generation, TIMEOUT)
    answered = generation in row_of(exchange.request).answered
    for _ in range(2):
        end.ask(encode_request(exchange.request), 0, answered=answered)
        stated, outcome = dialogue(exchange, generation), None
        while stated:
            assert end.taken() == b"".join(raw for _, raw in _turn(stated, "H"))
            for chunk in cut(b"".join(raw for _, raw in _turn(stated, "D"))):
                assert outcome is None
                outcome = end.receive(chunk, 0)
        assert end.taken() == b""
        body = encode_answer(exchange.request, exchange.answer) if answered else b""
        assert outcome == MaxonAnswer(body)
        assert not end.busy
        assert (end.due, end.ready_at) == (NEVER, 0)


def _turn(stated: list[tuple[str, bytes]], who: str) -> list[tuple[str, bytes]]:
    turn = []
    while stated and stated[0][0] == who:
        turn.append(stated.pop(0))
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
            stated = serve(end, exchange, generation, chunk, now)
            assert stated in {b"", b"F" * len(chunk)}
        now += TIMEOUT
        end.wake(now)
        for chunk in cut(golden(exchange, generation)[0]):
            stated = serve(end, exchange, generation, chunk, now)
        assert stated[:1] == (b"O" if generation is Generation.V1 else stated[:1])
        assert stated
        answered = generation in row_of(exchange.request).answered
        if generation is Generation.V1 and answered:
            stated = serve(end, exchange, generation, b"O", now)
            assert stated == golden(exchange, generation)[1][1:]
            assert serve(end, exchange, generation, b"O", now) == b""


def join(
    host: HostEnd, drive: DeviceEnd, body: bytes | None, spoil: Callable[[bytes], bytes] = lambda raw: raw
) -> Outcome | None:
    """Carry bytes between the two ends until neither sends any more."""
    outcome = None
    for _ in range(1000):
        requested = host.taken()
        frame = drive.receive(requested, 0) if requested else None
        if frame is not None:
            drive.answer(body, 0)
        stated = spoil(drive.taken())
        if not requested and not stated:
            return outcome
        if stated:
            outcome = host.receive(stated, 0) or outcome
    raise AssertionError("they never stop")


@every_exchange
def test_both_ends_understand_each_other(exchange: Exchange, generation: Generation) -> None:
    host, drive = host_end(generation, TIMEOUT), device(generation)
    answered = generation in row_of(exchange.request).answered
    body = encode_answer(exchange.request, exchange.answer) if answered else None
    for _ in range(3):
        host.ask(encode_request(exchange.request), 0, answered=answered)
        assert join(host, drive, body) == MaxonAnswer(body or b"")
