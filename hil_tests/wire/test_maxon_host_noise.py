"""Every golden exchange as the host meets it on a bad line: garbage before it, and between its parts."""

from itertools import groupby

from firmware_bridge.families.epos2.maxon.frame import Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer, encode_request, row_of
from firmware_bridge.units import MILLISECOND
from hil_tests.wire.maxon_dialogues import Cut, dialogue, every_exchange, fragmented
from hil_tests.wire.maxon_frames import Exchange

NOISE = {
    # On RS232 whatever is not the byte that is waited for: neither O, nor F, nor the answer's 0.
    Generation.V1: bytes.fromhex("01FF9055AA"),
    # On USB half an answer, single DLEs, another command's frame, a DLE before the frame itself.
    Generation.V2: bytes.fromhex("90020004000000 904F 02 90021002416000 0164CF 90"),
}


@fragmented
@every_exchange
def test_the_host_states_its_part_through_noise(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    host = host_end(generation, 500 * MILLISECOND)
    answered = generation in row_of(exchange.request).answered
    for _ in range(2):
        for chunk in cut(NOISE[generation]):
            assert host.receive(chunk, 0) is None, "no request was sent"
        host.ask(encode_request(exchange.request), 0, answered=answered)
        outcome, in_frame = None, False
        for who, turn in groupby(dialogue(exchange, generation), key=lambda part: part[0]):
            for _, raw in turn:
                if who == "H":
                    assert host.taken().endswith(raw)
                    in_frame = generation is Generation.V1 and raw == b"O"
                    continue
                # Inside V1's answer every byte counts; before each other part there may be noise.
                noisy = raw if in_frame else NOISE[generation] + raw
                for chunk in cut(noisy):
                    assert outcome is None
                    outcome = host.receive(chunk, 0)
        assert outcome == MaxonAnswer(encode_answer(exchange.request, exchange.answer) if answered else b"")
        assert not host.busy
