"""The serial line in time: byte times, the rate from 0x2002, the converter's latency, time-outs, hosts."""

import pytest

from emulators.canopen.saved_parameters import SAVE
from emulators.epos2.objects.device_profile import BAUDS
from emulators.wires.serial import received_as
from firmware_bridge.families.epos2.maxon.frame import Failure, Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    InitiateSegmentedRead,
    ObjectRead,
    ReadObject,
    SegmentRead,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, SECOND, Nanoseconds
from hil_tests.unit.epos2_serial.serial_desk import FAR, NEAR, SerialDesk, with_profile

DEVICE_TYPE = ReadObject(0x1000, 0, 0)
REPORTED = ObjectRead(0, bytes.fromhex("92010200"))


def took(desk: SerialDesk) -> Nanoseconds:
    return desk.host.ended_at - desk.host.begun_at


def test_rs232_takes_the_time_of_each_byte_of_the_dialogue() -> None:
    desk = SerialDesk(Generation.V1)
    assert desk.requests(DEVICE_TYPE) == REPORTED
    # 1 + O + 7 + O + 00 + O + 11; the host's last O is no part of the wait.
    assert took(desk) == pytest.approx((1 + 1 + 7 + 1 + 1 + 1 + 11) * 10 * SECOND / 115_200, abs=30)


def test_the_gateway_costs_130_microseconds_beside_its_frames() -> None:
    """Application notes, p. 11-168: 10.125 ms instead of 9.995 ms."""
    times = []
    for profile in (with_profile(gateway_latency=0), with_profile()):
        desk = SerialDesk(Generation.V1, profile)
        desk.requests(ReadObject(0x1000, 0, FAR))
        times.append(took(desk))
    assert times[1] - times[0] == 130 * MICROSECOND


def test_the_latency_of_the_port_is_the_profile_s() -> None:
    times = []
    for profile in (with_profile(), with_profile(serial_latency=MILLISECOND)):
        desk = SerialDesk(Generation.V1, profile)
        desk.requests(ReadObject(0x1000, 0, NEAR))
        times.append(took(desk))
    # Meanwhile the handshake's byte is on the line, which would have held up the answer's first one.
    assert times[1] - times[0] == pytest.approx(MILLISECOND - 10 * SECOND / 115_200, abs=2)


def test_usb_waits_for_the_converter_s_next_millisecond() -> None:
    desk = SerialDesk(Generation.V2)
    for wait in (0, 137, 501, 990):
        desk.waits(wait * MICROSECOND)
        assert desk.requests(DEVICE_TYPE) == REPORTED
        line_time = (10 + 14) * 10 * SECOND // 1_000_000
        assert line_time < took(desk) <= line_time + MILLISECOND
        assert desk.host.ended_at % MILLISECOND == 0


def test_every_rate_works_and_takes_effect_with_save_and_reset() -> None:
    for code, baud in enumerate(BAUDS):
        desk = SerialDesk(Generation.V1)
        desk.requests(WriteObject(0x2002, 0, 0, code.to_bytes(4, "little")))
        assert desk.requests(DEVICE_TYPE) == REPORTED  # not yet
        desk.requests(WriteObject(0x1010, 1, 0, SAVE.to_bytes(4, "little")))
        assert desk.requests(DEVICE_TYPE) == REPORTED  # not yet
        desk.requests(SendNmtService(1, 0x81))
        assert desk.drive.baud == baud
        if code != 5:
            assert desk.tries(DEVICE_TYPE) in {Failure.SILENCE, Failure.REFUSED}
        desk.host.baud = baud
        desk.waits(SECOND)
        assert desk.requests(DEVICE_TYPE) == REPORTED
        assert took(desk) == pytest.approx(23 * 10 * SECOND / baud, abs=30)


def test_a_rate_that_is_not_saved_is_gone_with_the_reset() -> None:
    desk = SerialDesk(Generation.V1)
    assert desk.requests(WriteObject(0x2002, 0, 0, bytes(4))) == Done(0)
    desk.requests(SendNmtService(1, 0x81))
    assert desk.drive.baud == 115_200
    assert desk.requests(ReadObject(0x2002, 0, 0)) == ObjectRead(0, b"\5\0\0\0")


def test_the_rate_of_usb_is_the_converter_s() -> None:
    desk = SerialDesk(Generation.V2)
    desk.requests(WriteObject(0x2002, 0, 0, bytes(4)))
    desk.requests(WriteObject(0x1010, 1, 0, SAVE.to_bytes(4, "little")))
    desk.requests(SendNmtService(1, 0x81))
    assert desk.drive.baud == 1_000_000
    assert desk.requests(DEVICE_TYPE) == REPORTED


@pytest.mark.parametrize(
    ("byte", "sent_at", "received_at", "received"),
    [
        (0x5A, 9600, 9600, 0x5A),
        (0x5A, 115_200, 113_000, 0x5A),  # 2 % off is still right
        (0x5A, 115_200, 117_500, 0x5A),
        (0xFF, 9600, 19_200, 0xFE),  # start bit twice as long, then ones
        (0x00, 9600, 19_200, None),  # still low where the stop bit should be
        (0xAA, 19_200, 9600, 0xF8),
        (0x00, 115_200, 9600, 0xFF),  # over before the first bit is looked at
    ],
)
def test_a_byte_at_the_wrong_rate_is_another_byte_or_none(
    byte: int, sent_at: int, received_at: int, received: int | None
) -> None:
    assert received_as(byte, sent_at, received_at) == received


@pytest.mark.parametrize(("generation", "index"), [(Generation.V1, 0x2005), (Generation.V2, 0x2006)])
@pytest.mark.parametrize(("written", "counts"), [(50, 50), (500, 500), (0, 500)])
def test_half_a_command_counts_until_the_time_out_of_the_object(
    generation: Generation, index: int, written: int, counts: int
) -> None:
    desk = SerialDesk(generation)
    requested = _requested(generation)
    assert desk.requests(WriteObject(index, 0, 0, written.to_bytes(4, "little"))) == Done(0)
    for wait, received in ((counts - 25, True), (counts + 5, False)):
        desk.waits(2 * SECOND)
        desk.sends(requested[:5])  # waits 20 ms and a little for the rest
        desk.waits((wait - 21) * MILLISECOND)
        answer = desk.sends(requested[5:])
        assert (len(answer) in {2, 14}) is received, answer
    desk.waits(2 * SECOND)
    assert desk.requests(DEVICE_TYPE) == REPORTED


def _requested(generation: Generation) -> bytes:
    desk = SerialDesk(generation)
    desk.requests(DEVICE_TYPE)
    return desk.host.sent[:8] if generation is Generation.V1 else desk.host.sent


@pytest.mark.long(keeps=["v1"])
@pytest.mark.parametrize("generation", Generation)
def test_a_host_that_goes_away_at_any_byte_is_forgotten(generation: Generation) -> None:
    requested = _requested(generation)
    for taken in range(1, len(requested) + 1):
        desk = SerialDesk(generation)
        desk.host.raw = requested[:taken]
        desk.world.stop("host")
        desk.waits(MILLISECOND)
        desk.world.detach("host")
        desk.waits(SECOND)
        after = SerialDesk(generation).host
        desk.host = after
        desk.world.attach("host", after, {"serial": desk.line})
        assert desk.requests(DEVICE_TYPE) == REPORTED


def test_two_clients_of_one_drive_see_each_other_and_lose_nothing() -> None:
    """One on CAN by SDO, one on the serial line; each writes an object of its own and reads both."""
    for generation in Generation:
        client, before = CanClient(), 0
        desk = SerialDesk(generation, others=[("client", client)])
        for value in range(1, 40):
            mine = value.to_bytes(4, "little")
            assert desk.requests(WriteObject(0x200C, 1, 0, mine)) == Done(0)
            assert desk.requests(ReadObject(0x200C, 1, 0)) == ObjectRead(0, mine)
            theirs = desk.requests(ReadObject(0x200C, 2, 0))
            assert isinstance(theirs, ObjectRead)
            found = int.from_bytes(theirs.raw, "little")
            assert before < found <= client.written
            before = found
        assert client.written > 100
        assert client.mixed == []
        assert client.seen[-1] == 39 == max(client.seen)
        assert client.seen == sorted(client.seen)


@pytest.mark.parametrize("generation", Generation)
def test_two_masters_of_a_drive_behind_the_gateway_get_no_answer_of_the_other(generation: Generation) -> None:
    """Both use the one SDO server; the gateway recognizes its own answers by the object's address."""
    client = CanClient(FAR)
    desk = SerialDesk(generation, others=[("client", client)])
    for value in range(1, 40):
        mine = value.to_bytes(4, "little")
        assert desk.requests(WriteObject(0x200C, 3, FAR, mine)) == Done(0)
        assert desk.requests(ReadObject(0x200C, 3, FAR)) == ObjectRead(0, mine)
    assert client.written > 100
    assert client.mixed == []


@pytest.mark.parametrize("generation", Generation)
def test_a_transfer_that_was_put_back_goes_on_as_it_went(generation: Generation) -> None:
    desk = SerialDesk(generation)
    for node in (0, FAR):
        desk.requests(InitiateSegmentedRead(0x2004, 0, node))
        kept = desk.world.snapshot()
        answer, trace = desk.requests(SegmentRead(0)), desk.world.trace_sha256
        desk.world.restore(kept)
        assert desk.requests(SegmentRead(0)) == answer
        assert desk.world.trace_sha256 == trace


class CanClient:
    """Client that writes 0x200C:2 and reads it and 0x200C:1 back by SDO, as fast as it is answered."""

    def __init__(self, node: int = NEAR) -> None:
        self._node = node
        self.written = 0
        self.seen: list[int] = []
        self.mixed: list[bytes] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        if packet.address != 0x580 + self._node or packet.payload[3] == 3:
            return Reaction((), NEVER if self.written else MILLISECOND)
        command, place = packet.payload[0], packet.payload[3]
        value = int.from_bytes(packet.payload[4:], "little")
        if command == 0x60 and place == 2:
            return self._sends("400C200200000000")
        if command == 0x43 and place == 2:
            if value != self.written:
                self.mixed.append(packet.payload)
            return self._sends("400C200100000000")
        if command == 0x43 and place == 1:
            self.seen.append(value)
            return self._writes()
        self.mixed.append(packet.payload)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        return self._writes() if now else Reaction((), MILLISECOND)

    def _writes(self) -> Reaction:
        self.written += 1
        return self._sends("230C2002" + self.written.to_bytes(4, "little").hex())

    def _sends(self, text: str) -> Reaction:
        return Reaction((Packet("can", 0x600 + self._node, bytes.fromhex(text)),))
