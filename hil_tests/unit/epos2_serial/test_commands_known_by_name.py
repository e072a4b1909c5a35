"""Commands of which only the names are known are refused as unknown ones are, and disturb nothing."""

import pytest

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.families.epos2.maxon.frame import ANSWER, Frame, Generation, encode_v1, encode_v2
from firmware_bridge.families.epos2.maxon.messages import ObjectRead, ReadObject
from hil_tests.unit.epos2_serial.serial_desk import SerialDesk


@pytest.mark.opcode(0x16, 0x22)
@pytest.mark.parametrize("opcode", [0x16, 0x22])
@pytest.mark.parametrize("generation", Generation)
def test_a_command_known_by_name_only_is_refused(generation: Generation, opcode: int) -> None:
    desk = SerialDesk(generation)
    frame = Frame(opcode, bytes(4))
    if generation is Generation.V1:
        assert desk.sends(encode_v1(frame)[:1]) == b"F"
    else:
        reported = int(AbortCode.ILLEGAL_COMMAND).to_bytes(4, "little")
        assert desk.sends(encode_v2(frame)) == encode_v2(Frame(ANSWER, reported))
    assert desk.requests(ReadObject(0x1000, 0, 0)) == ObjectRead(0, bytes.fromhex("92010200"))
