"""Objects read and written by segments: how many commands they take, and what ends a transfer."""

import pytest

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    InitiateSegmentedRead,
    InitiateSegmentedWrite,
    SegmentOut,
    SegmentRead,
    SegmentTaken,
    SegmentWrite,
    SendNmtService,
    control,
)
from hil_tests.unit.epos2_serial.serial_desk import (
    DOMAIN,
    FAR,
    NEAR,
    SerialDesk,
    both,
    nodes,
    u32,
    with_profile,
)


def read_whole(desk: SerialDesk, index: int, subindex: int, node: int) -> list[bytes]:
    assert desk.requests(InitiateSegmentedRead(index, subindex, node)) == Done(0)
    chunks, toggle = [], False
    while True:
        answer = desk.requests(SegmentRead(control(0, toggle=toggle)))
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
    assert desk.requests(InitiateSegmentedWrite(index, 0, node, len(raw))) == Done(0)
    toggle, commands = False, 1
    for begin in range(0, len(raw), size):
        chunk = raw[begin : begin + size]
        head = control(len(chunk), toggle=toggle)
        assert desk.requests(SegmentWrite(head, chunk)) == SegmentTaken(0, head)
        toggle, commands = not toggle, commands + 1
    return commands


@pytest.mark.long(keeps=["direct-v1", "direct-v2", "gateway-v1"])
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
    desk.requests(InitiateSegmentedRead(0x1008, 0, node))
    assert desk.requests(SegmentRead(control(0, toggle=True))) == SegmentOut(AbortCode.TOGGLE, 0, b"\0")
    assert desk.requests(SegmentRead(0)) == SegmentOut(AbortCode.UNKNOWN_COMMAND, 0, b"\0")
    desk.requests(InitiateSegmentedWrite(DOMAIN, 0, node, 20))
    head = control(7, toggle=True)
    assert desk.requests(SegmentWrite(head, bytes(7))) == SegmentTaken(AbortCode.TOGGLE, 0)
    assert desk.requests(SegmentWrite(control(7, toggle=False), bytes(7))) == SegmentTaken(
        AbortCode.UNKNOWN_COMMAND, 0
    )
    assert write_whole(desk, DOMAIN, node, b"afterwards", 7) == 3


@nodes
@both
def test_more_bytes_than_announced_are_refused(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation)
    desk.requests(InitiateSegmentedWrite(DOMAIN, 0, node, 3))
    answer = desk.requests(SegmentWrite(control(5, toggle=False), bytes(5)))
    assert answer == SegmentTaken(AbortCode.TOO_LONG, 0)
    assert (desk.far if node == FAR else desk.drive).store.read(Address(DOMAIN)) == b""


RECORD = 0x20C1
RECORDS = tuple(bytes(range(8 * place, 8 * place + 8)) for place in range(3))


@both
def test_a_record_of_eight_bytes_passes_the_gateway_in_two_frames(generation: Generation) -> None:
    desk = SerialDesk(generation)
    for raw in RECORDS:
        desk.frames.clear()
        assert write_whole(desk, RECORD, FAR, raw, 8) == 2
        assert desk.far.store.get(Address(RECORD)) == int.from_bytes(raw, "little")
        sent = [frame.split("#")[1] for frame in desk.frames if frame.startswith("near")]
        assert sent[1:] == ["00" + raw[:7].hex().upper(), "1D" + raw[7:].hex().upper() + "00" * 6]


def test_each_segment_of_eight_is_divided_and_the_toggle_bits_of_host_and_bus_go_their_own_ways() -> None:
    desk = SerialDesk(Generation.V2)
    assert write_whole(desk, DOMAIN, FAR, b"".join(RECORDS), 8) == 4
    assert desk.far.store.read(Address(DOMAIN)) == b"".join(RECORDS)
    heads = [frame.split("#")[1][:2] for frame in desk.frames if frame.startswith("near")]
    assert heads == ["21", "00", "1C", "00", "1C", "00", "1D"]
    assert b"".join(read_whole(desk, DOMAIN, 0, FAR)) == b"".join(RECORDS)


@pytest.mark.parametrize(("longest", "size"), [(8, 9), (7, 8)])
def test_a_longer_segment_does_not_pass_the_gateway(longest: int, size: int) -> None:
    desk = SerialDesk(Generation.V2, with_profile(gateway_segment=longest))
    desk.requests(InitiateSegmentedWrite(DOMAIN, 0, FAR, size))
    answer = desk.requests(SegmentWrite(control(size, toggle=False), bytes(size)))
    assert answer == SegmentTaken(AbortCode.TOO_LONG, 0)


def test_a_drive_that_has_forgotten_the_transfer_states_so_to_the_host() -> None:
    desk = SerialDesk(Generation.V2)
    desk.requests(InitiateSegmentedWrite(DOMAIN, 0, FAR, 16))
    first = control(8, toggle=False)
    assert desk.requests(SegmentWrite(first, RECORDS[0])) == SegmentTaken(0, first)
    for command in (2, 128):  # stopped and back: the other drive knows of no transfer any more
        desk.requests(SendNmtService(FAR, command))
    answer = desk.requests(SegmentWrite(control(8, toggle=True), RECORDS[1]))
    assert answer == SegmentTaken(AbortCode.UNKNOWN_COMMAND, 0)
    assert write_whole(desk, DOMAIN, FAR, RECORDS[2], 8) == 2


@both
def test_a_segment_that_reports_more_than_it_has_is_refused(generation: Generation) -> None:
    desk = SerialDesk(generation)
    desk.requests(InitiateSegmentedWrite(DOMAIN, 0, NEAR, 8))
    answer = desk.requests(SegmentWrite(control(8, toggle=False), b"abc"))
    assert answer == SegmentTaken(AbortCode.TOO_SHORT, 0)
