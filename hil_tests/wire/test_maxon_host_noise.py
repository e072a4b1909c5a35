"""Every golden exchange as the host meets it on a bad line: garbage before it, and between its parts."""

from collections.abc import Callable
from itertools import groupby

import pytest

from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.maxon.frame import Answered, Generation
from firmware_bridge.wire.maxon.lines import host_end
from firmware_bridge.wire.maxon.opcodes import encode_answer, encode_request, row_of
from hil_tests.wire.maxon_frames import EXCHANGES, Exchange

Cut = Callable[[bytes], list[bytes]]
CUTS: dict[str, Cut] = {
    "whole": lambda raw: [raw] if raw else [],
    "byte by byte": lambda raw: [raw[i : i + 1] for i in range(len(raw))],
}
NOISE = {
    # On RS232 whatever is not the byte that is waited for: neither O, nor F, nor the answer's 0.
    Generation.V1: bytes.fromhex("01FF9055AA"),
    # On USB half an answer, single DLEs, another command's frame, a DLE before the frame itself.
    Generation.V2: bytes.fromhex("90020004000000 904F 02 90021002416000 0164CF 90"),
}
CASES = [
    pytest.param(exchange, generation, id=f"{exchange}-{generation.value}")
    for exchange in EXCHANGES
    for generation, pair in ((Generation.V1, exchange.v1), (Generation.V2, exchange.v2))
    if pair is not None
]


def parts(exchange: Exchange, generation: Generation) -> list[tuple[str, bytes]]:
    """Write down who says what: H the host, D the device; the device's bytes apart where noise fits."""
    pair = exchange.v1 if generation is Generation.V1 else exchange.v2
    assert pair is not None
    asked, answered = map(bytes.fromhex, pair)
    if generation is Generation.V2:
        return [("H", asked), ("D", answered)]
    said = [("H", asked[:1]), ("D", b"O"), ("H", asked[1:]), ("D", b"O")]
    if answered:
        said += [("D", answered[:1]), ("H", b"O"), ("D", answered[1:]), ("H", b"O")]
    return said


@pytest.mark.parametrize("cut", CUTS.values(), ids=CUTS)
@pytest.mark.parametrize(("exchange", "generation"), CASES)
def test_the_host_says_its_part_through_noise(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    host = host_end(generation, 500 * MILLISECOND)
    answered = generation in row_of(exchange.request).answered
    for _ in range(2):
        for chunk in cut(NOISE[generation]):
            assert host.hear(chunk, 0) is None, "nobody has asked"
        host.ask(encode_request(exchange.request), 0, answered=answered)
        outcome, in_frame = None, False
        for who, turn in groupby(parts(exchange, generation), key=lambda part: part[0]):
            for _, raw in turn:
                if who == "H":
                    assert host.taken().endswith(raw)
                    in_frame = generation is Generation.V1 and raw == b"O"
                    continue
                # Inside V1's answer every byte counts; before each other part there may be noise.
                noisy = raw if in_frame else NOISE[generation] + raw
                for chunk in cut(noisy):
                    assert outcome is None
                    outcome = host.hear(chunk, 0)
        assert outcome == Answered(encode_answer(exchange.request, exchange.answer) if answered else b"")
        assert not host.busy
