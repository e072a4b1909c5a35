"""Serial commands that reach the bus: network management, frames of the host's own, layer setting."""

import pytest

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    FrameRead,
    ObjectRead,
    ReadLssFrame,
    ReadObject,
    Request,
    RequestCanFrame,
    SendCanFrame,
    SendLssFrame,
    SendNmtService,
    WriteObject,
)
from hil_tests.unit.epos2_serial.serial_desk import FAR, NEAR, SerialDesk, both, u32


@pytest.mark.opcode(0x0E)
@pytest.mark.parametrize(
    ("command", "state"),
    [(1, NmtState.OPERATIONAL), (2, NmtState.STOPPED), (128, NmtState.PRE_OPERATIONAL)],
)
@pytest.mark.parametrize("node", [0, NEAR, FAR])
@both
def test_network_commands(generation: Generation, node: int, command: int, state: NmtState) -> None:
    desk = SerialDesk(generation)
    desk.requests(SendNmtService(node, command))
    before = NmtState.PRE_OPERATIONAL
    assert desk.drive.nmt_state is (before if node == FAR else state)
    assert desk.far.nmt_state is (before if node == NEAR else state)


@both
@pytest.mark.parametrize("command", [129, 130])
def test_the_port_lives_on_through_resets_by_its_own_command(generation: Generation, command: int) -> None:
    desk = SerialDesk(generation)
    answer = desk.requests(SendNmtService(NEAR, command))
    assert answer is None, "no end acknowledge (maxon's library for PCs)"
    assert "near 701#00" in desk.frames
    assert desk.requests(ReadObject(0x1001, 0, 0)) == ObjectRead(0, bytes(4))


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (SendNmtService(128, 1), AbortCode.WRONG_NODE),
        (SendNmtService(0, 3), AbortCode.RANGE),
        (SendCanFrame(0x800, 0, bytes(8)), AbortCode.WRONG_NODE),
        (SendCanFrame(0x201, 9, bytes(8)), AbortCode.LENGTH),
    ],
)
def test_what_cannot_be_sent(request_: Request, code: int) -> None:
    desk = SerialDesk(Generation.V2)
    assert desk.requests(request_) == Done(code)
    assert desk.frames == []
    desk = SerialDesk(Generation.V1)
    assert desk.requests(request_) is None
    assert desk.frames == []


@pytest.mark.opcode(0x20)
@both
def test_a_frame_of_the_host_s_own_goes_onto_the_bus(generation: Generation) -> None:
    desk = SerialDesk(generation)
    answer = desk.requests(SendCanFrame(0x602, 6, bytes.fromhex("2B40600006000000")))
    assert answer == (None if generation is Generation.V1 else Done(0))
    assert desk.frames == ["near 602#2B4060000600", "far 582#6040600000000000"]
    assert desk.host.received == (b"OO" if generation is Generation.V1 else desk.host.received)


@pytest.mark.opcode(0x21)
@both
def test_a_frame_is_requested_from_another_drive_and_from_this_one(generation: Generation) -> None:
    desk = SerialDesk(generation)
    for node in (NEAR, FAR):
        for payload in ((0x1800, 2, 253), (0x1800, 1, 0x180 + node)):
            index, subindex, value = payload
            assert desk.requests(WriteObject(index, subindex, node, u32(value))) == Done(0)
    desk.requests(SendNmtService(0, 1))
    for node in (NEAR, FAR):
        answer = desk.requests(RequestCanFrame(0x180 + node, 2))
        assert answer == FrameRead(0, bytes.fromhex("4007000000000000"))
    assert desk.requests(RequestCanFrame(0x183, 2)) == FrameRead(AbortCode.TIMEOUT, bytes(8))
    assert desk.requests(RequestCanFrame(0x800, 2)) == FrameRead(AbortCode.WRONG_NODE, bytes(8))
    assert desk.requests(RequestCanFrame(0x183, 9)) == FrameRead(AbortCode.LENGTH, bytes(8))


def lss(text: str) -> bytes:
    return bytes.fromhex(text).ljust(8, b"\0")


@pytest.mark.opcode(0x30, 0x31)
@both
@pytest.mark.parametrize("node", [NEAR, FAR], ids=["own", "other"])
def test_layer_setting_reaches_the_drive_on_the_line_and_the_others(
    generation: Generation, node: int
) -> None:
    desk = SerialDesk(generation)
    desk.requests(SendNmtService(node, 2))  # the services live in Stopped
    assert desk.requests(SendLssFrame(lss("0401"))) == Done(0)
    assert desk.requests(ReadLssFrame(20)) == FrameRead(AbortCode.TIMEOUT, bytes(8))
    assert desk.requests(SendLssFrame(lss("5A"))) == Done(0)
    assert desk.requests(ReadLssFrame(500)) == FrameRead(0, lss("5AFB"))
    assert desk.requests(SendLssFrame(lss("5E"))) == Done(0)
    assert desk.requests(ReadLssFrame(500)) == FrameRead(0, lss(f"5E{node:02X}"))
    assert desk.requests(ReadLssFrame(20)) == FrameRead(AbortCode.TIMEOUT, bytes(8))
