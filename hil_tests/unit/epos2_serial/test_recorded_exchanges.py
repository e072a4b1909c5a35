"""Recorded and computed exchanges of the serial protocols, byte for byte, with the emulated drive."""

from dataclasses import replace

from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.wires import SerialWire
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.opcodes import row_of
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.can import REMOTE
from hil_tests.rows import every
from hil_tests.unit.epos2_serial.serial_desk import SerialDesk
from hil_tests.wire.maxon_frames import EXCHANGES, Exchange

CASES = [
    (exchange, generation)
    for exchange in EXCHANGES
    for generation, pair in ((Generation.V1, exchange.v1), (Generation.V2, exchange.v2))
    if pair is not None
]
GARBAGE = {
    Generation.V1: bytes.fromhex("00FF4F46909055AA"),
    Generation.V2: bytes.fromhex("0211900290904F9002100290"),
}


class Neighbor:
    """Node that answers a remote request and a slave's selection, as drives elsewhere on the bus would."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        if packet.address == 0x181 | REMOTE:
            return Reaction((Packet("can", 0x181, bytes.fromhex("4007")),))
        if packet.address == 0x7E5 and packet.payload[0] == 0x43:
            return Reaction((Packet("can", 0x7E4, bytes.fromhex("4400000000000000")),))
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction()


def desk_for(exchange: Exchange, generation: Generation) -> SerialDesk:
    """Put the drive into the state in which it gives the recorded answer."""
    request, profile = exchange.request, EPOS2_70_10
    if exchange.name.startswith("version of node 2"):
        # The bytes beyond the object are the version beside it in the recorded device's memory.
        profile = replace(profile, beyond_size=bytes.fromhex("00001062"))
    near = 5 if isinstance(request, messages.RequestCanFrame) else 1
    desk = SerialDesk(generation, profile, near=near, others=[("neighbor", Neighbor())])
    desk.far.store.set(Address(0x2003, 1), 0x2010)
    desk.drive.store.set(od.STATUSWORD, 0x0140)
    desk.drive.store.set(od.POSITION_ACTUAL, 0x9090)
    if isinstance(request, messages.SegmentRead):
        desk.requests(messages.InitiateSegmentedRead(0x1008, 0, 1))
    if isinstance(request, messages.ReadLssFrame):
        desk.requests(messages.SendLssFrame(bytes.fromhex("4300000000000000")))
    return desk


@every(("exchange", "generation"), CASES)
def test_the_drive_answers_as_it_was_recorded(exchange: Exchange, generation: Generation) -> None:
    desk = desk_for(exchange, generation)
    answered = generation in row_of(exchange.request).answered
    assert desk.requests(exchange.request) == (exchange.answer if answered else None)
    assert (desk.host.sent, desk.host.received) == wanted(exchange, generation)


def wanted(exchange: Exchange, generation: Generation) -> tuple[bytes, bytes]:
    """Return all bytes of the host and all of the drive, handshakes included."""
    pair = exchange.v1 if generation is Generation.V1 else exchange.v2
    assert pair is not None
    requested, answered = map(bytes.fromhex, pair)
    if generation is Generation.V2:
        return requested, answered
    if not answered:
        return requested, b"OO"
    return requested + b"OO", b"OO" + answered


@every(("exchange", "generation"), CASES)
def test_garbage_before_and_between_changes_nothing(exchange: Exchange, generation: Generation) -> None:
    desk = desk_for(exchange, generation)
    repeatable = not isinstance(exchange.request, messages.SegmentRead | messages.ReadLssFrame)
    for _ in range(1 + repeatable):
        assert set(desk.sends(GARBAGE[generation])) <= {0x46}
        desk.waits(500 * MILLISECOND)  # 0x2005 and 0x2006: then the drive is idle again
        assert desk.requests(exchange.request) in {None, exchange.answer}
        assert desk.host.received == wanted(exchange, generation)[1]


def test_the_gateway_s_frames_on_the_bus_application_notes_p_164() -> None:
    desk = SerialDesk(Generation.V2)
    desk.requests(messages.ReadObject(0x1000, 0, 2))
    assert desk.frames == ["near 602#4000100000000000", "far 582#4300100092010200"]


def test_a_command_to_all_nodes_starts_both_drives() -> None:
    for generation in Generation:
        desk = SerialDesk(generation)
        desk.requests(messages.SendNmtService(0, 1))
        assert (desk.drive.nmt_state, desk.far.nmt_state) == (NmtState.OPERATIONAL, NmtState.OPERATIONAL)
        assert "near 000#0100" in desk.frames


def test_bytes_come_one_by_one_on_rs232() -> None:
    desk = SerialDesk(Generation.V1)
    chunks: list[bytes] = []
    assert isinstance(desk.line, SerialWire)
    desk.line.observe(lambda _now, _sender, packet: chunks.append(packet.payload))
    desk.requests(messages.ReadObject(0x6041, 0, 1))
    assert {len(chunk) for chunk in chunks} == {1}
