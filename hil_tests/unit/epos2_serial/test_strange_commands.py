"""Commands that are unknown, damaged, late or many at once: the answers, and a host that can go on."""

import pytest

from firmware_bridge.families.epos2.maxon.frame import Failure, Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    ObjectRead,
    ReadObject,
    Request,
    RequestCanFrame,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.epos2_serial.serial_desk import NEAR, NO_NODE, SerialDesk, both, u32


def test_unknown_commands() -> None:
    v1 = SerialDesk(Generation.V1)
    assert v1.sends(b"\x22") == b"F"
    assert v1.sends(b"\x60") == b"F"
    v2 = SerialDesk(Generation.V2)
    # Opcode 60, EPOS4's ReadObject (EPOS4 Communication Guide, p. 2-17): 0F00FFBF.
    received = v2.sends(bytes.fromhex("9002600201B030002E62"))
    assert received[:8] == bytes.fromhex("90020002BFFF000F")


def test_a_damaged_usb_frame_is_answered_with_an_error_and_a_damaged_rs232_frame_with_f() -> None:
    v1, v2 = SerialDesk(Generation.V1), SerialDesk(Generation.V2)
    assert v1.sends(bytes.fromhex("10014160000 1ABF1".replace(" ", ""))) == b"OF"
    assert v2.sends(bytes.fromhex("90021002416000 0164CE".replace(" ", "")))[:8] == bytes.fromhex(
        "9002000204000405"
    )


@both
def test_a_host_that_waits_too_briefly_is_informed_and_recovers(generation: Generation) -> None:
    desk = SerialDesk(generation, timeout=100 * MILLISECOND)
    assert desk.tries(ReadObject(0x1000, 0, NO_NODE)) is Failure.SILENCE
    desk.waits(SECOND)  # the gateway gives up after 500 ms, and the line 500 ms later
    assert desk.requests(ReadObject(0x1000, 0, NEAR)) == ObjectRead(0, u32(0x0002_0192))


@pytest.mark.parametrize("request_", [ReadObject(0x1000, 0, 0), RequestCanFrame(0x180 + NEAR, 2)])
@both
def test_a_thousand_commands_at_once_are_answered_one_after_the_other(
    generation: Generation, request_: Request
) -> None:
    desk = SerialDesk(generation)
    for subindex, value in ((2, 253), (1, 0x180 + NEAR)):
        assert desk.requests(WriteObject(0x1800, subindex, 0, u32(value))) == Done(0)
    desk.requests(SendNmtService(0, 1))
    wanted = desk.requests(request_)
    assert wanted is not None
    assert wanted.error == 0
    # A pseudo-terminal may hand over all of it in one piece, as no line with byte times does.
    piece = desk.host.sent if generation is Generation.V2 else desk.host.sent[:-2] + b"OO"
    answers = desk.drive.receive(Packet(SERIAL, 0, piece * 1000), desk.world.now).sent
    sent = b"".join(packet.payload for packet in answers if packet.link == SERIAL)
    assert sent == desk.host.received * 1000
