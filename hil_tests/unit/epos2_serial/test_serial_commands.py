"""Each serial command, on the drive itself and through it, on both protocols: what comes, what happens."""

import pytest

from emulators.epos2.memory import SAVE
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND
from firmware_bridge.wire.abort import AbortCode
from firmware_bridge.wire.canopen import NmtState
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.maxon.frame import Answered, Failure, Generation
from firmware_bridge.wire.maxon.messages import (
    Done,
    FrameRead,
    InitiateSegmentedRead,
    InitiateSegmentedWrite,
    ObjectRead,
    ReadLssFrame,
    ReadObject,
    Request,
    RequestCanFrame,
    SegmentOut,
    SegmentRead,
    SegmentTaken,
    SegmentWrite,
    SendCanFrame,
    SendLssFrame,
    SendNmtService,
    WriteObject,
    control,
)
from hil_tests.unit.epos2_serial.serial_desk import FAR, NEAR, SerialDesk, with_profile

DOMAIN = 0x201B
NOBODY = 99
both = pytest.mark.parametrize("generation", Generation)
nodes = pytest.mark.parametrize("node", [0, NEAR, FAR], ids=["zero", "own", "gateway"])


def u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


@pytest.mark.opcode(0x10, 0x11)
@nodes
@both
def test_an_object_is_written_and_read_back(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation)
    for index, value in ((0x6081, 2500), (0x607A, 0xFFFF_FFFE), (0x6060, 0xFD)):
        assert desk.asks(WriteObject(index, 0, node, u32(value))) == Done(0)
        assert desk.asks(ReadObject(index, 0, node)) == ObjectRead(0, u32(value))
    store = desk.far.store if node == FAR else desk.drive.store
    assert (store.get(at.MODE), store.get(at.TARGET_POSITION)) == (-3, -2)
    assert bool(desk.frames) is (node == FAR)


REFUSALS: tuple[tuple[str, Request, int], ...] = (
    ("no object", ReadObject(0x5555, 0, NEAR), 0x0602_0000),
    ("no sub-index", ReadObject(0x6040, 99, NEAR), 0x0609_0011),
    ("write-only", ReadObject(0x2025, 0, NEAR), 0x0601_0001),
    ("read-only", WriteObject(0x6041, 0, NEAR, u32(1)), 0x0601_0002),
    ("too high", WriteObject(0x2002, 0, NEAR, u32(6)), 0x0609_0031),
    ("too long to read at once", ReadObject(0x1008, 0, NEAR), 0x0607_0010),
    ("too short to write at once", WriteObject(0x20C1, 0, NEAR, u32(1)), 0x0607_0013),
    ("wrong password", WriteObject(0x1010, 1, NEAR, u32(SAVE + 1)), 0x0F00_FFBE),
    ("no object to begin with", InitiateSegmentedRead(0x5555, 0, NEAR), 0x0602_0000),
    ("nothing to write there", InitiateSegmentedWrite(0x1008, 0, NEAR, 5), 0x0601_0002),
    ("too much to write there", InitiateSegmentedWrite(0x6040, 0, NEAR, 3), 0x0607_0012),
)


@pytest.mark.parametrize("node", [NEAR, FAR], ids=["own", "gateway"])
@pytest.mark.parametrize(
    ("request_", "code"), [row[1:] for row in REFUSALS], ids=[row[0] for row in REFUSALS]
)
def test_a_refusal_is_the_same_on_the_line_and_through_the_gateway(
    request_: Request, code: int, node: int
) -> None:
    desk = SerialDesk(Generation.V1)
    assert isinstance(request_, ReadObject | WriteObject | InitiateSegmentedRead | InitiateSegmentedWrite)
    fields = {name: getattr(request_, name) for name in request_.__dataclass_fields__} | {"node": node}
    answer = desk.asks(type(request_)(**fields))
    assert answer is not None
    # An SDO server that is not told the size takes what it has; only its own length check differs.
    told = answer.error
    if node == FAR and code == 0x0607_0013:
        assert told in {0x0607_0010, 0x0607_0012, 0x0607_0013}
    else:
        assert told == code
    wanted = 8 if isinstance(request_, ReadObject) else 4
    assert isinstance(desk.host.outcome, Answered)
    assert len(desk.host.outcome.body) == wanted
    assert not any(desk.host.outcome.body[4:])


@both
@pytest.mark.parametrize(
    ("node", "code"),
    [(NOBODY, AbortCode.TIMEOUT), (128, AbortCode.WRONG_NODE), (255, AbortCode.WRONG_NODE)],
)
def test_a_node_that_does_not_answer(generation: Generation, node: int, code: int) -> None:
    desk = SerialDesk(generation)
    assert desk.asks(ReadObject(0x1000, 0, node)) == ObjectRead(code, bytes(4))
    waited = desk.host.ended_at - desk.host.begun_at
    assert (waited > 500 * MILLISECOND) is (code == AbortCode.TIMEOUT)
    assert desk.asks(ReadObject(0x1000, 0, FAR)) == ObjectRead(0, u32(0x0002_0192))


@both
def test_a_node_in_stopped_answers_nothing_but_the_line_still_does(generation: Generation) -> None:
    desk = SerialDesk(generation)
    desk.asks(SendNmtService(0, 2))
    assert (desk.drive.nmt_state, desk.far.nmt_state) == (NmtState.STOPPED, NmtState.STOPPED)
    assert desk.asks(ReadObject(0x1000, 0, FAR)) == ObjectRead(AbortCode.TIMEOUT, bytes(4))
    assert desk.asks(ReadObject(0x1000, 0, NEAR)) == ObjectRead(0, u32(0x0002_0192))


def read_whole(desk: SerialDesk, index: int, subindex: int, node: int) -> list[bytes]:
    assert desk.asks(InitiateSegmentedRead(index, subindex, node)) == Done(0)
    chunks, toggle = [], False
    while True:
        answer = desk.asks(SegmentRead(control(0, toggle=toggle)))
        assert isinstance(answer, SegmentOut)
        length = answer.control & 0x3F
        assert answer.error == 0
        assert bool(answer.control & 0x40) is toggle
        assert len(answer.raw) in {length, length + 1}
        assert (4 + 1 + len(answer.raw)) % 2 == 0
        chunks.append(answer.raw[:length])
        toggle = not toggle
        if not answer.control & 0x80:
            return chunks


def write_whole(desk: SerialDesk, index: int, node: int, raw: bytes, size: int) -> int:
    assert desk.asks(InitiateSegmentedWrite(index, 0, node, len(raw))) == Done(0)
    toggle, commands = False, 1
    for begin in range(0, len(raw), size):
        chunk = raw[begin : begin + size]
        head = control(len(chunk), toggle=toggle)
        assert desk.asks(SegmentWrite(head, chunk)) == SegmentTaken(0, head)
        toggle, commands = not toggle, commands + 1
    return commands


@pytest.mark.opcode(0x12, 0x13, 0x14, 0x15)
@both
@pytest.mark.parametrize(
    ("node", "size", "commands"), [(NEAR, 63, 17), (FAR, 7, 147)], ids=["direct", "gateway"]
)
def test_a_kilobyte_takes_17_commands_or_147_through_the_gateway(
    generation: Generation, node: int, size: int, commands: int
) -> None:
    """Application notes, p. 11-168: 1 kB by segments of 63 and of 7 bytes; ours has 1000 bytes."""
    desk = SerialDesk(generation)
    raw = bytes(range(250)) * 4
    assert -(-1024 // size) == commands
    assert write_whole(desk, DOMAIN, node, raw, size) == -(-1000 // size) + 1
    store = desk.far.store if node == FAR else desk.drive.store
    assert store.read(Address(DOMAIN)) == raw
    chunks = read_whole(desk, DOMAIN, 0, node)
    assert b"".join(chunks) == raw
    assert [len(chunk) for chunk in chunks[:-1]] == [size] * (len(chunks) - 1)


@pytest.mark.opcode(0x12, 0x14)
@nodes
@pytest.mark.parametrize(
    ("index", "subindex", "raw"),
    [(0x1008, 0, b"EPOS2"), (0x2004, 0, bytes.fromhex("5459018020660000")), (0x1000, 0, u32(0x0002_0192))],
)
def test_objects_of_any_length_can_be_read_by_segments(
    index: int, subindex: int, raw: bytes, node: int
) -> None:
    assert b"".join(read_whole(SerialDesk(Generation.V1), index, subindex, node)) == raw


@pytest.mark.opcode(0x13, 0x15)
@nodes
def test_a_number_can_be_written_by_segments(node: int) -> None:
    desk = SerialDesk(Generation.V2)
    write_whole(desk, 0x6040, node, b"\x06\x00", 7)
    (drive,) = [each for each in (desk.drive, desk.far) if (each is desk.far) is (node == FAR)]
    assert getattr(drive.motion, "written") == [6]  # noqa: B009 - the test's own motion has it


@pytest.mark.opcode(0x14, 0x15)
@nodes
@both
def test_a_wrong_toggle_bit_ends_the_transfer(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation)
    desk.asks(InitiateSegmentedRead(0x1008, 0, node))
    assert desk.asks(SegmentRead(control(0, toggle=True))) == SegmentOut(AbortCode.TOGGLE, 0, b"\0")
    assert desk.asks(SegmentRead(0)) == SegmentOut(AbortCode.UNKNOWN_COMMAND, 0, b"\0")
    desk.asks(InitiateSegmentedWrite(DOMAIN, 0, node, 20))
    head = control(7, toggle=True)
    assert desk.asks(SegmentWrite(head, bytes(7))) == SegmentTaken(AbortCode.TOGGLE, 0)
    assert desk.asks(SegmentWrite(control(7, toggle=False), bytes(7))) == SegmentTaken(
        AbortCode.UNKNOWN_COMMAND, 0
    )
    assert write_whole(desk, DOMAIN, node, b"afterwards", 7) == 3


@nodes
@both
def test_more_bytes_than_announced_are_refused(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation)
    desk.asks(InitiateSegmentedWrite(DOMAIN, 0, node, 3))
    answer = desk.asks(SegmentWrite(control(5, toggle=False), bytes(5)))
    assert answer == SegmentTaken(AbortCode.TOO_LONG, 0)
    assert (desk.far if node == FAR else desk.drive).store.read(Address(DOMAIN)) == b""


def test_a_segment_of_more_than_seven_bytes_does_not_pass_the_gateway() -> None:
    desk = SerialDesk(Generation.V2)
    desk.asks(InitiateSegmentedWrite(DOMAIN, 0, FAR, 8))
    answer = desk.asks(SegmentWrite(control(8, toggle=False), bytes(8)))
    assert answer == SegmentTaken(AbortCode.TOO_LONG, 0)


@both
def test_a_segment_that_tells_more_than_it_has_is_refused(generation: Generation) -> None:
    desk = SerialDesk(generation)
    desk.asks(InitiateSegmentedWrite(DOMAIN, 0, NEAR, 8))
    answer = desk.asks(SegmentWrite(control(8, toggle=False), b"abc"))
    assert answer == SegmentTaken(AbortCode.TOO_SHORT, 0)


def test_bytes_beyond_the_object_s_size_are_the_profile_s() -> None:
    """Recorded: 10 62 behind a version of 16 bits; another device had 0x8090 there."""
    desk = SerialDesk(Generation.V1, with_profile(beyond_size=b"\x11\x22\x90\x80"))
    assert desk.asks(ReadObject(0x2003, 1, 0)) == ObjectRead(0, bytes.fromhex("26219080"))
    assert desk.asks(ReadObject(0x6061, 0, 0)) == ObjectRead(0, bytes.fromhex("01229080"))
    assert desk.asks(ReadObject(0x1000, 0, 0)) == ObjectRead(0, bytes.fromhex("92010200"))
    assert desk.asks(ReadObject(0x5555, 0, 0)) == ObjectRead(AbortCode.NO_OBJECT, bytes(4))


@pytest.mark.opcode(0x0E)
@pytest.mark.parametrize(
    ("command", "state"),
    [(1, NmtState.OPERATIONAL), (2, NmtState.STOPPED), (128, NmtState.PRE_OPERATIONAL)],
)
@pytest.mark.parametrize("node", [0, NEAR, FAR])
@both
def test_network_commands(generation: Generation, node: int, command: int, state: NmtState) -> None:
    desk = SerialDesk(generation)
    desk.asks(SendNmtService(node, command))
    before = NmtState.PRE_OPERATIONAL
    assert desk.drive.nmt_state is (before if node == FAR else state)
    assert desk.far.nmt_state is (before if node == NEAR else state)


@both
@pytest.mark.parametrize("command", [129, 130])
def test_the_port_lives_on_through_resets_by_its_own_command(generation: Generation, command: int) -> None:
    desk = SerialDesk(generation)
    answer = desk.asks(SendNmtService(NEAR, command))
    assert answer == (None if generation is Generation.V1 else Done(0))
    assert "near 701#00" in desk.frames
    assert desk.asks(ReadObject(0x1001, 0, 0)) == ObjectRead(0, bytes(4))


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
    assert desk.asks(request_) == Done(code)
    assert desk.frames == []
    desk = SerialDesk(Generation.V1)
    assert desk.asks(request_) is None
    assert desk.frames == []


@pytest.mark.opcode(0x20)
@both
def test_a_frame_of_the_host_s_own_goes_onto_the_bus(generation: Generation) -> None:
    desk = SerialDesk(generation)
    answer = desk.asks(SendCanFrame(0x602, 6, bytes.fromhex("2B40600006000000")))
    assert answer == (None if generation is Generation.V1 else Done(0))
    assert desk.frames == ["near 602#2B4060000600", "far 582#6040600000000000"]
    assert desk.host.heard == (b"OO" if generation is Generation.V1 else desk.host.heard)


@pytest.mark.opcode(0x21)
@both
def test_a_frame_is_requested_from_another_drive_and_from_this_one(generation: Generation) -> None:
    desk = SerialDesk(generation)
    for node in (NEAR, FAR):
        for payload in ((0x1800, 2, 253), (0x1800, 1, 0x180 + node)):
            index, subindex, value = payload
            assert desk.asks(WriteObject(index, subindex, node, u32(value))) == Done(0)
    desk.asks(SendNmtService(0, 1))
    for node in (NEAR, FAR):
        answer = desk.asks(RequestCanFrame(0x180 + node, 2))
        assert answer == FrameRead(0, bytes.fromhex("4007000000000000"))
    assert desk.asks(RequestCanFrame(0x183, 2)) == FrameRead(AbortCode.TIMEOUT, bytes(8))
    assert desk.asks(RequestCanFrame(0x800, 2)) == FrameRead(AbortCode.WRONG_NODE, bytes(8))
    assert desk.asks(RequestCanFrame(0x183, 9)) == FrameRead(AbortCode.LENGTH, bytes(8))


def lss(text: str) -> bytes:
    return bytes.fromhex(text).ljust(8, b"\0")


@pytest.mark.opcode(0x30, 0x31)
@both
@pytest.mark.parametrize("node", [NEAR, FAR], ids=["own", "other"])
def test_layer_setting_reaches_the_drive_on_the_line_and_the_others(
    generation: Generation, node: int
) -> None:
    desk = SerialDesk(generation)
    desk.asks(SendNmtService(node, 2))  # the services live in Stopped
    assert desk.asks(SendLssFrame(lss("0401"))) == Done(0)
    assert desk.asks(ReadLssFrame(20)) == FrameRead(AbortCode.TIMEOUT, bytes(8))
    assert desk.asks(SendLssFrame(lss("5A"))) == Done(0)
    assert desk.asks(ReadLssFrame(500)) == FrameRead(0, lss("5AFB"))
    assert desk.asks(SendLssFrame(lss("5E"))) == Done(0)
    assert desk.asks(ReadLssFrame(500)) == FrameRead(0, lss(f"5E{node:02X}"))
    assert desk.asks(ReadLssFrame(20)) == FrameRead(AbortCode.TIMEOUT, bytes(8))


def test_the_gateway_costs_130_microseconds_beside_its_frames() -> None:
    """Application notes, p. 11-168: 10.125 ms instead of 9.995 ms."""
    took = []
    for profile in (with_profile(gateway_latency=0), with_profile()):
        desk = SerialDesk(Generation.V1, profile)
        desk.asks(ReadObject(0x1000, 0, FAR))
        took.append(desk.host.ended_at - desk.host.begun_at)
    assert took[1] - took[0] == 130 * MICROSECOND


def test_the_latency_of_the_port_is_the_profile_s() -> None:
    took = []
    for profile in (with_profile(), with_profile(serial_latency=MILLISECOND)):
        desk = SerialDesk(Generation.V1, profile)
        desk.asks(ReadObject(0x1000, 0, NEAR))
        took.append(desk.host.ended_at - desk.host.begun_at)
    # Meanwhile the handshake's byte is on the line, which would have held up the answer's first one.
    assert took[1] - took[0] == pytest.approx(MILLISECOND - 10 * SECOND / 115_200, abs=2)


def test_unknown_commands() -> None:
    v1 = SerialDesk(Generation.V1)
    assert v1.sends(b"\x22") == b"F"
    assert v1.sends(b"\x60") == b"F"
    v2 = SerialDesk(Generation.V2)
    # Opcode 60, EPOS4's ReadObject (EPOS4 Communication Guide, p. 2-17): 0F00FFBF.
    heard = v2.sends(bytes.fromhex("9002600201B030002E62"))
    assert heard[:8] == bytes.fromhex("90020002BFFF000F")


def test_a_damaged_usb_frame_is_answered_with_an_error_and_a_damaged_rs232_frame_with_f() -> None:
    v1, v2 = SerialDesk(Generation.V1), SerialDesk(Generation.V2)
    assert v1.sends(bytes.fromhex("10014160000 1ABF1".replace(" ", ""))) == b"OF"
    assert v2.sends(bytes.fromhex("90021002416000 0164CE".replace(" ", "")))[:8] == bytes.fromhex(
        "9002000204000405"
    )


@both
def test_a_host_that_waits_too_briefly_is_told_so_and_recovers(generation: Generation) -> None:
    desk = SerialDesk(generation, timeout=100 * MILLISECOND)
    assert desk.tries(ReadObject(0x1000, 0, NOBODY)) is Failure.SILENCE
    desk.waits(SECOND)  # the gateway gives up after 500 ms, and the line 500 ms later
    assert desk.asks(ReadObject(0x1000, 0, NEAR)) == ObjectRead(0, u32(0x0002_0192))


@pytest.mark.parametrize("request_", [ReadObject(0x1000, 0, 0), RequestCanFrame(0x180 + NEAR, 2)])
@both
def test_a_thousand_commands_at_once_are_answered_one_after_the_other(
    generation: Generation, request_: Request
) -> None:
    desk = SerialDesk(generation)
    for subindex, value in ((2, 253), (1, 0x180 + NEAR)):
        assert desk.asks(WriteObject(0x1800, subindex, 0, u32(value))) == Done(0)
    desk.asks(SendNmtService(0, 1))
    wanted = desk.asks(request_)
    assert wanted is not None
    assert wanted.error == 0
    # A pseudo-terminal may hand over all of it in one piece, as no line with byte times does.
    piece = desk.host.said if generation is Generation.V2 else desk.host.said[:-2] + b"OO"
    answers = desk.drive.receive(Packet(SERIAL, 0, piece * 1000), desk.world.now).sent
    said = b"".join(packet.payload for packet in answers if packet.link == SERIAL)
    assert said == desk.host.heard * 1000
