"""Errands over every way to a drive, in virtual time: objects read and written, refusals, silence."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import (
    Ask,
    CommissioningError,
    Do,
    JobClient,
    Script,
)
from firmware_bridge.families.epos2.commissioning.job import (
    BrokenAnswerError,
    JobError,
    Outcome,
    ReadJob,
    RefusedError,
    SilentError,
    WriteJob,
)
from firmware_bridge.families.epos2.commissioning.network_command import GatewayCheck
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, encode_v1, encode_v2
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.commissioning.rig import BUS, FAR, NEAR, OWN_LINE, USB, WAYS, Rig, Way, noting, rig_for

every_way = pytest.mark.parametrize("way", WAYS, ids=str)
LINES = st.sampled_from(Generation)


@every_way
def test_an_object_is_written_and_read_back(way: Way) -> None:
    rig = rig_for(way)
    assert rig.tries(way.link(), WriteJob(od.PROFILE_VELOCITY, b"\x34\x12\0\0")) == b""
    assert rig.value(way.node, od.PROFILE_VELOCITY) == 0x1234
    assert rig.tries(way.link(), ReadJob(od.PROFILE_VELOCITY)) == b"\x34\x12\0\0"


@every_way
@pytest.mark.parametrize(
    ("address", "raw"),
    [
        (od.MODE_DISPLAY, "01"),
        (at.CONTINUOUS_CURRENT_LIMIT, "1027"),
        (od.VENDOR_ID, "fb000000"),
        (od.DEVICE_NAME, b"EPOS2".hex()),
        (od.ERROR_REGISTER, "00"),
    ],
)
def test_objects_of_every_size_are_read_with_their_own_length(way: Way, address: Address, raw: str) -> None:
    assert rig_for(way).tries(way.link(), ReadJob(address)) == bytes.fromhex(raw)


@every_way
def test_eight_bytes_are_read_by_segments(way: Way) -> None:
    rig = rig_for(way)
    raw = rig.tries(way.link(), ReadJob(Address(0x2004)))
    assert isinstance(raw, bytes)
    assert int.from_bytes(raw, "little") == rig.value(way.node, Address(0x2004))


@every_way
@pytest.mark.parametrize(
    ("job", "code"),
    [
        (ReadJob(Address(0x5555)), AbortCode.NO_OBJECT),
        (ReadJob(Address(0x6040, 99)), AbortCode.NO_SUBINDEX),
        (ReadJob(Address(0x60C4, 6)), AbortCode.WRITE_ONLY),
        (WriteJob(od.STATUSWORD, b"\1\0"), AbortCode.READ_ONLY),
        (WriteJob(od.MAX_PROFILE_VELOCITY, (25_001).to_bytes(4, "little")), AbortCode.TOO_HIGH),
        (WriteJob(Address(0x20C4, 3), b"\0\0"), AbortCode.TOO_LOW),
        (WriteJob(Address(0x1010, 1), b"evas"), AbortCode.WRONG_PASSWORD),
    ],
    ids=str,
)
def test_a_refusal_reports_the_drive_s_own_code(way: Way, job: ReadJob | WriteJob, code: AbortCode) -> None:
    outcome = rig_for(way).tries(way.link(), job)
    assert isinstance(outcome, RefusedError)
    assert outcome.code == code
    assert outcome.job == job


def test_a_wrong_size_is_refused_on_can() -> None:
    for raw, code in ((b"\6\0\0\0", AbortCode.TOO_LONG), (b"\6", AbortCode.TOO_SHORT)):
        outcome = Rig().tries(CanAccess(NEAR), WriteJob(od.CONTROLWORD, raw))
        assert isinstance(outcome, RefusedError)
        assert outcome.code in {code, AbortCode.LENGTH}


def test_a_node_that_is_not_there_is_silent_on_can_and_reported_by_the_gateway() -> None:
    rig = Rig(Generation.V1)
    silent = rig.tries(CanAccess(9), ReadJob(od.STATUSWORD))
    assert isinstance(silent, SilentError)
    assert silent.waited == 400_000_000
    reported = rig.tries(SerialAccess(Generation.V1, 9), ReadJob(od.STATUSWORD))
    assert isinstance(reported, RefusedError)
    assert reported.code == AbortCode.TIMEOUT


@pytest.mark.parametrize("way", [OWN_LINE, USB], ids=str)
def test_a_line_at_whose_end_no_one_is_stays_silent(way: Way) -> None:
    link = way.link()
    client = JobClient(link, (Ask(ReadJob(od.STATUSWORD), noting([])),))
    now, reaction = 0, client.wake(0)
    while reaction.wake_at != NEVER:
        assert reaction.wake_at > now
        now = reaction.wake_at
        reaction = client.wake(now)
    assert client.finished
    assert now <= 5 * SECOND


def test_a_client_that_was_killed_in_the_middle_does_not_harm_the_next_one() -> None:
    for generation in Generation:
        rig = Rig(generation)
        frame = Frame(0x10, bytes.fromhex("41600000"))
        raw = encode_v1(frame) if generation is Generation.V1 else encode_v2(frame)
        for cut in range(1, len(raw)):
            rig.drives[NEAR].receive(Packet(SERIAL, 0, raw[:cut]), rig.world.now)
            assert rig.tries(SerialAccess(generation), ReadJob(od.DEVICE_TYPE)) == bytes.fromhex("92010200")


def test_the_drive_on_the_line_must_be_the_one_that_is_named() -> None:
    rig = Rig(Generation.V1)
    link = SerialAccess(Generation.V1, FAR)
    ended: list[Outcome] = []
    rig.does(link, (*GatewayCheck(link, NEAR).script(), Ask(ReadJob(Address(0x2009)), noting(ended))))
    assert ended == [b"\2\0"], "the other drive's switch"
    link = SerialAccess(Generation.V1, FAR)
    write = Ask(WriteJob(od.PROFILE_VELOCITY, b"\1\0\0\0"), noting(ended))
    with pytest.raises(CommissioningError, match="is node 1, not 5; nothing was done"):
        rig.does(link, (*GatewayCheck(link, 5).script(), write))
    assert len(ended) == 1
    assert rig.value(FAR, od.PROFILE_VELOCITY) == 1000


def test_what_was_named_as_the_drive_on_the_line_is_requested_there_and_not_on_the_bus() -> None:
    rig = Rig(Generation.V1)
    link = SerialAccess(Generation.V1, NEAR)
    frames: list[Packet] = []
    rig.bus.observe(lambda _now, _sender, packet: frames.append(packet))
    rig.does(link, (*GatewayCheck(link, NEAR).script(), Ask(ReadJob(od.STATUSWORD), noting([]))))
    assert frames == []
    assert link.node == 0


@every_way
def test_a_client_that_is_stopped_sends_nothing_more(way: Way) -> None:
    def one_more() -> Script:
        return (Ask(ReadJob(od.STATUSWORD), lambda _outcome: one_more()),)

    client = JobClient(way.link(), one_more())
    sent = client.wake(0).sent
    assert sent
    assert client.stop(1).wake_at == NEVER
    for packet in (Packet(CAN, 0x581, bytes.fromhex("4B41600040010000")), Packet(SERIAL, 0, b"OO")):
        assert client.receive(packet, 2).sent == ()
    assert client.wake(10 * SECOND).sent == ()
    assert not client.finished


def test_what_was_sent_leaves_even_if_the_step_behind_it_fails() -> None:
    def fail() -> Script:
        raise CommissioningError("no")

    client = JobClient(CanAccess(NEAR), (Ask(ReadJob(od.STATUSWORD), lambda _outcome: ()), Do(fail)))
    client.wake(0)
    client.receive(Packet(CAN, 0x581, bytes.fromhex("4B41600040010000")), 1)
    assert str(client.failure) == "no"
    assert client.finished


def test_one_job_at_a_time() -> None:
    for link in (CanAccess(1), SerialAccess(Generation.V1)):
        link.begin(ReadJob(od.STATUSWORD), 0)
        with pytest.raises(ValueError, match="while"):
            link.begin(ReadJob(od.CONTROLWORD), 0)


def test_an_answer_that_breaks_the_protocol_is_reported() -> None:
    link = SerialAccess(Generation.V2)
    link.begin(ReadJob(od.STATUSWORD), 0)
    link.receive(Packet(SERIAL, 0, encode_v2(Frame(0, b"\0\0"))), 1)
    assert isinstance(link.take(), BrokenAnswerError)
    link = SerialAccess(Generation.V2)
    link.begin(ReadJob(od.DEVICE_NAME), 0)
    link.receive(Packet(SERIAL, 0, encode_v2(Frame(0, bytes(4)))), 1)
    link.receive(Packet(SERIAL, 0, encode_v2(Frame(0, bytes.fromhex("000000004145")))), 2)
    outcome = link.take()
    assert isinstance(outcome, BrokenAnswerError)
    assert "toggle" in str(outcome)


@settings(max_examples=examples(150), derandomize=True, database=None)
@given(
    generation=LINES,
    address=st.sampled_from([od.STATUSWORD, od.DEVICE_NAME, Address(0x2004)]),
    stated=st.lists(
        st.tuples(st.integers(0, 900_000_000), st.binary(max_size=30) | st.sampled_from([b"O", b"\0", b"F"])),
        max_size=12,
    ),
)
def test_whatever_a_strange_device_states_a_client_ends(
    generation: Generation, address: Address, stated: list[tuple[int, bytes]]
) -> None:
    ended: list[Outcome] = []
    client = JobClient(SerialAccess(generation), (Ask(ReadJob(address), noting(ended)),))
    now, reaction = 0, client.wake(0)
    for wait, chunk in stated:
        while reaction.wake_at <= now + wait:
            now = max(now, reaction.wake_at)
            reaction = client.wake(now)
        now += wait
        reaction = client.receive(Packet(SERIAL, 0, chunk), now)
    for _ in range(1000):
        if client.finished:
            break
        now = reaction.wake_at
        reaction = client.wake(now)
    assert client.finished
    assert len(ended) == 1
    assert isinstance(ended[0], bytes | JobError)


def test_storing_has_the_time_that_it_needs_and_is_requested_once() -> None:
    link = CanAccess(NEAR)
    link.begin(WriteJob(Address(0x1010, 1), b"save"), 0)
    assert link.wake_at == 6 * SECOND
    assert [packet.payload[0] for packet in link.wake(6 * SECOND)] == [0x80], "an abort, and no second try"
    assert isinstance(link.take(), SilentError)


def test_the_other_drive_s_answers_are_not_ours() -> None:
    rig = rig_for(BUS)
    ended: list[Outcome] = []
    client = JobClient(CanAccess(NEAR), (Ask(ReadJob(od.STATUSWORD), noting(ended)),))
    client.wake(0)
    client.receive(Packet(CAN, 0x582, bytes.fromhex("4B41600099990000")), 1)
    client.receive(Packet(SERIAL, 0, bytes.fromhex("4B41600099990000")), 1)
    assert ended == []
    assert rig.tries(CanAccess(NEAR), ReadJob(od.STATUSWORD)) == b"\x40\5"


def test_storing_is_requested_again_where_the_drive_has_surely_done_nothing() -> None:
    link = SerialAccess(Generation.V1)
    assert link.begin(WriteJob(Address(0x1010, 1), b"save"), 0) == (Packet(SERIAL, 0, b"\x11"),)
    again = link.receive(Packet(SERIAL, 0, b"F"), 1)
    assert again == (Packet(SERIAL, 0, b"\x11"),), (
        "the drive took the first one for the rest of another command"
    )
    assert link.receive(Packet(SERIAL, 0, b"F"), 2) == ()
    assert isinstance(link.take(), BrokenAnswerError)


def test_after_silence_rs232_is_left_alone_until_the_drive_has_forgotten() -> None:
    link = SerialAccess(Generation.V1)
    link.begin(ReadJob(od.STATUSWORD), 0)
    late = link.wake_at
    assert link.wake(late) == ()
    assert link.wake_at == late + 500_000_000, "0x2005 by default"
    assert link.wake(link.wake_at) == (Packet(SERIAL, 0, b"\x10"),)
