"""Trusted frames: signatures, replays, allowed places; and the commands obeyed of all others."""

from __future__ import annotations

import hashlib
import ipaddress
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from firmware_bridge.intent import Arm, EmergencyStop
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.trust import EPOCH, OLDEST, UNIT, Trust, is_signed
from firmware_bridge.units import SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, acks, rars
from hil_tests.unit.teleop.received import texts, types

if TYPE_CHECKING:
    from firmware_bridge.packet import Packet

KEY, OTHER = bytes(range(32)), bytes(range(1, 33))
NOW = EPOCH + 300_000_000 * SECOND
"""Unix time at the bridge's instant 0."""
HERE, THERE = number_of("10.0.0.1", 14550), number_of("192.0.2.7", 14550)
SIGNED_BEAT = bytes.fromhex(
    "FD 09 01 00 00 FF BE 00 00 00 00 00 00 00 06 08 00 04 03 DA B0 01 78 56 34 12 00 00 00 73 89 DC 92 24"
)
"""Made by hand: SHA-256 over key, frame, link 1 and time stamp 0x12345678; its first six bytes."""
BEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
ARM = dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, *(0.0,) * 6)
STOPS = {
    "terminate": dialect.MAVLink_command_long_message(1, 1, 185, 0, 1, *(0.0,) * 6),
    "safe": dialect.MAVLink_command_int_message(1, 1, 0, 5300, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    "kill": dialect.MAVLink_command_long_message(1, 1, 400, 0, 0, 21196, *(0.0,) * 5),
    "button": dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 4),
}


class Signer:
    """A third party's signing: pymavlink's own."""

    def __init__(self, key: bytes | None = KEY, *, system: int = 255, link: int = 1, at: int = 0) -> None:
        self.words: Any = mavlink.MAVLink(None, srcSystem=system, srcComponent=190)
        if key is not None:
            self.words.signing.secret_key, self.words.signing.link_id = key, link
            self.words.signing.sign_outgoing = True
            self.words.signing.timestamp = stamp(at)

    def states(self, message: Any) -> bytes:
        frame: bytes = message.pack(self.words)
        self.words.seq = (self.words.seq + 1) & 0xFF
        return frame


def stamp(now: int) -> int:
    return (NOW + now - EPOCH) // UNIT


def bench_with(trust: Trust) -> RarsBench:
    bench = rars()
    bench.trust = trust
    bench.restart()
    return bench


@pytest.fixture
def keyed() -> RarsBench:
    return bench_with(Trust(key=KEY, started_at=NOW))


def receives(bench: RarsBench, datagram: bytes, source: int = HERE) -> list[Any]:
    sent = bench.operator.receive(datagram, bench.now, bench.decide, source)
    return [message for packet in sent for message in Codec(9, 9).decode(packet.payload)]


def believed(bench: RarsBench, datagram: bytes) -> bool:
    doubted = bench.operator.dropped.doubted
    receives(bench, datagram)
    return bench.operator.dropped.doubted == doubted


def test_a_frame_signed_by_hand_is_made_so_and_believed() -> None:
    assert Codec(255, 190, (KEY, 1)).encode(BEAT, 0x12345678) == SIGNED_BEAT
    assert Signer().states(BEAT)[:-13] == SIGNED_BEAT[:-13]
    bench = bench_with(Trust(key=KEY, started_at=EPOCH + 0x12345678 * UNIT))
    assert believed(bench, SIGNED_BEAT)


def test_what_is_signed_is_obeyed_and_answered_signed(keyed: RarsBench) -> None:
    station = Signer()
    station.words.signing.allow_unsigned_callback = lambda *_: False
    receives(keyed, station.states(BEAT))
    sent = keyed.operator.receive(station.states(ARM), 0, keyed.decide, HERE)
    assert keyed.requested == [Arm()]
    keyed.now += CYCLE
    reported = keyed.operator.report(keyed.snapshot(), (), keyed.now)
    for packet in (*sent, *(one for one in reported if one.address == HERE)):
        station.words.decode(bytearray(packet.payload))  # MAVError where it is not signed as it should be
    assert station.words.signing.goodsig_count > 5


def test_our_stamps_rise_with_every_frame_and_follow_the_time(keyed: RarsBench) -> None:
    newest = 0
    receives(keyed, Signer().states(BEAT))
    for _ in range(30):
        keyed.now += CYCLE
        own: list[Packet] = [
            one for one in keyed.operator.report(keyed.snapshot(), (), keyed.now) if one.address == HERE
        ]
        for packet in own:
            at = int.from_bytes(packet.payload[-12:-6], "little")
            assert at > newest
            assert 0 <= at - stamp(keyed.now) < 100
            newest = at


@pytest.mark.parametrize(
    ("signer", "doubt"),
    [(Signer(None), "is not signed"), (Signer(OTHER), "is signed with another key")],
    ids=["unsigned", "another key"],
)
def test_unsigned_and_wrongly_signed_words_are_refused_and_reported(
    keyed: RarsBench, signer: Signer, doubt: str
) -> None:
    assert receives(keyed, signer.states(BEAT) + signer.states(ARM)) == []
    assert keyed.requested == []
    assert keyed.operator.dropped.doubted == 2
    assert keyed.operator.driver is None
    assert keyed.operator.stations.of == {}
    [text] = ["".join(texts(keyed.report()))]
    assert f"HEARTBEAT of 255/190 at 10.0.0.1:14550 refused: it {doubt}" in text
    receives(keyed, signer.states(BEAT))
    assert texts(keyed.report()) == [], "not at the rate at which they come"


def test_mavlink_1_carries_no_signature_and_is_refused(keyed: RarsBench) -> None:
    assert not believed(keyed, BEAT.pack(Signer(None).words, force_mavlink1=True))


@given(st.integers(0, 33 * 8 - 1))
def test_a_frame_with_one_wrong_bit_is_not_believed(bit: int) -> None:
    bench = bench_with(Trust(key=KEY, started_at=EPOCH + 0x12345678 * UNIT))
    frame = bytearray(SIGNED_BEAT)
    frame[1 + bit // 8] ^= 1 << bit % 8
    receives(bench, bytes(frame))
    assert bench.operator.stations.of == {}


def test_a_frame_is_believed_once(keyed: RarsBench) -> None:
    station = Signer()
    first, second = station.states(BEAT), station.states(BEAT)
    assert believed(keyed, second)
    for replayed in (first, second):
        receives(keyed, replayed, THERE)
    assert keyed.operator.dropped.doubted == 2
    assert [sender.source for sender in keyed.operator.stations.of] == [HERE]
    assert believed(keyed, station.states(BEAT))


@pytest.mark.parametrize(("behind", "good"), [(OLDEST, True), (OLDEST + 1, False)])
def test_a_new_stream_may_be_a_minute_behind(keyed: RarsBench, behind: int, *, good: bool) -> None:
    keyed.now = 5 * SECOND
    station = Signer(at=keyed.now)
    station.words.signing.timestamp -= behind
    assert believed(keyed, station.states(BEAT)) is good
    other = Signer(at=keyed.now, link=2)
    assert believed(keyed, other.states(BEAT)), "each link of a station counts for itself"


def test_a_wrong_signature_with_the_largest_stamp_locks_no_one_out(keyed: RarsBench) -> None:
    forged, station = Signer(OTHER), Signer()
    forged.words.signing.timestamp = (1 << 48) - 2
    assert not believed(keyed, forged.states(BEAT))
    assert believed(keyed, station.states(BEAT))


@pytest.mark.parametrize("key", [KEY, None])
def test_a_radio_may_speak_unsigned_and_is_nobodys_sign_of_life(key: bytes | None) -> None:
    bench = bench_with(Trust(key=key, started_at=NOW))
    assert believed(bench, Signer(None).states(dialect.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7)))
    assert bench.operator.stations.of == {}
    bench.now += CYCLE
    assert "".join(texts(bench.report())) == ""


def test_without_a_key_signed_frames_count_as_unsigned_and_it_is_reported_once() -> None:
    bench = bench_with(Trust())
    for signer in (Signer(), Signer(OTHER), Signer(None)):
        assert believed(bench, signer.states(ARM))
    assert bench.requested == [Arm()] * 3
    text = "".join(texts(bench.report()))
    assert text.count("signatures are not checked: this bridge has no key") == 1
    receives(bench, Signer().states(BEAT))
    bench.now += 10 * SECOND
    assert "signatures" not in "".join(texts(bench.report()))


@pytest.mark.parametrize("trust", [Trust(), Trust(key=KEY, started_at=NOW)])
def test_setup_signing_is_refused_in_words(trust: Trust) -> None:
    bench, station = bench_with(trust), Signer()
    receives(bench, station.states(BEAT))
    reported = receives(bench, station.states(dialect.MAVLink_setup_signing_message(1, 1, list(OTHER), 5)))
    assert "SETUP_SIGNING refused" in "".join(texts(reported))
    assert believed(bench, station.states(BEAT)), "the key is what it was"


@pytest.mark.parametrize("kind", STOPS)
@pytest.mark.parametrize("why", ["unsigned", "wrong key", "not allowed"])
def test_an_emergency_stop_is_obeyed_of_everybody(kind: str, why: str) -> None:
    allowed = (ipaddress.ip_network("10.0.0.0/24"),) if why == "not allowed" else ()
    bench = bench_with(Trust(key=KEY, started_at=NOW, allowed=allowed))
    signer = {"unsigned": Signer(None), "wrong key": Signer(OTHER), "not allowed": Signer()}[why]
    answers = []
    for _ in range(40):
        answers += acks(receives(bench, signer.states(STOPS[kind]), THERE))
        bench.report()
        assert bench.facts.emergency_stopped
    assert bench.requested == [EmergencyStop()]
    assert len(answers) == (0 if kind == "button" else 2), "once a second, in two seconds"
    assert "emergency stop by 255/190 at 192.0.2.7:14550" in "".join(texts(bench.received))


def test_other_words_beside_a_stop_are_not_obeyed(keyed: RarsBench) -> None:
    foreign_node = Signer(None)
    stick = dialect.MAVLink_manual_control_message(1, 1000, 0, 0, 0, 4 + 1)
    before = keyed.operator.intent
    receives(
        keyed, foreign_node.states(STOPS["kill"]) + foreign_node.states(stick) + foreign_node.states(ARM)
    )
    assert keyed.requested == [EmergencyStop(), EmergencyStop()]
    after = keyed.operator.intent
    assert (after.command, after.received_at) == (before.command, before.received_at)


@pytest.mark.parametrize(
    ("host", "allowed"),
    [
        ("10.0.0.1", True),
        ("10.0.0.255", True),
        ("10.0.1.0", False),
        ("192.0.2.7", True),
        ("192.0.2.8", False),
        ("::ffff:10.0.0.9", True),
        ("::ffff:10.0.1.9", False),
        ("fd00::5", True),
        ("fd01::5", False),
    ],
)
def test_who_is_on_the_list_may_speak(host: str, *, allowed: bool) -> None:
    networks = tuple(map(ipaddress.ip_network, ("10.0.0.0/24", "192.0.2.7", "fd00::/16")))
    bench = bench_with(Trust(allowed=networks))
    answers = types(
        receives(bench, Signer(None).states(BEAT) + Signer(None).states(ARM), number_of(host, 5000))
    )
    assert (answers == ["COMMAND_ACK"]) is allowed
    assert (bench.requested == [Arm()]) is allowed
    bench.requested.clear()
    assert bench.send(Signer(None).states(ARM)), "the other end of a link that has one was chosen here"


def test_a_key_has_32_bytes() -> None:
    with pytest.raises(ValueError, match="32 bytes, not 31"):
        Trust(key=bytes(31))


def test_a_clock_before_2015_stamps_from_0() -> None:
    assert Trust(key=KEY, started_at=0).stamp(5 * SECOND) == 0


def test_whether_a_frame_is_signed() -> None:
    assert is_signed(SIGNED_BEAT)
    assert not is_signed(Signer(None).states(BEAT))
    assert not is_signed(BEAT.pack(Signer(None).words, force_mavlink1=True))


def test_a_signature_is_the_first_six_bytes_of_a_hash_with_the_key_before_all() -> None:
    assert hashlib.sha256(KEY + SIGNED_BEAT[:-6]).digest()[:6] == SIGNED_BEAT[-6:]


def restarted(bench: RarsBench, *, started_at: int = NOW) -> RarsBench:
    """A bridge that begins again with what the one before has kept."""
    return bench_with(Trust(key=KEY, started_at=started_at, kept=bench.operator.stamps(bench.now)))


def test_what_was_recorded_is_not_believed_after_a_restart(keyed: RarsBench) -> None:
    station = Signer()
    recorded = [station.states(BEAT), station.states(ARM)]
    assert all(believed(keyed, frame) for frame in recorded)
    keyed.now = 5 * SECOND
    again = restarted(keyed, started_at=NOW + 6 * SECOND)
    for frame in recorded:
        assert not believed(again, frame)
    assert again.requested == []
    assert believed(again, station.states(BEAT)), "the station goes on"
    forgetful = bench_with(Trust(key=KEY, started_at=NOW + 6 * SECOND))
    assert believed(forgetful, recorded[1]), "this is what it would be without"


def test_a_clock_that_was_set_back_lets_no_old_stream_in_and_uses_no_stamp_twice(keyed: RarsBench) -> None:
    """A machine without a clock of its own begins where it ended, or in 1970."""
    keyed.now = 100 * SECOND
    old = Signer(system=77, at=0).states(ARM)
    last = stamp(keyed.now)
    again = restarted(keyed, started_at=0)
    assert not believed(again, old), "never received here, and more than a minute old"
    again.now = CYCLE
    receives(again, Signer(at=keyed.now).states(BEAT))
    own = [one for one in again.operator.report(again.snapshot(), (), again.now) if one.address == HERE]
    assert own
    assert all(int.from_bytes(one.payload[-12:-6], "little") > last for one in own)


def test_a_station_whose_clock_is_ahead_raises_our_stamps_and_locks_no_one_out(keyed: RarsBench) -> None:
    """So that it receives us; the age limit of another stream is a matter of our own clock."""
    keyed.now = 100 * SECOND
    ahead = Signer(at=500 * SECOND)
    assert believed(keyed, ahead.states(BEAT))
    assert believed(keyed, Signer(system=254, at=keyed.now).states(BEAT)), (
        "a new stream, 400 s behind that one"
    )
    assert not believed(keyed, Signer(system=253, at=keyed.now - 61 * SECOND).states(BEAT)), "too old by ours"
    own = [one for one in keyed.operator.report(keyed.snapshot(), (), keyed.now) if one.address == HERE]
    assert own
    assert all(int.from_bytes(one.payload[-12:-6], "little") >= stamp(500 * SECOND) for one in own)
    again = restarted(keyed, started_at=NOW + keyed.now)
    assert believed(again, Signer(system=252, at=keyed.now).states(BEAT)), "after a restart neither"


def test_who_is_not_believed_is_named_for_the_console_once(keyed: RarsBench) -> None:
    """On the link only trusted stations receive the report, and there may be none."""
    for _ in range(3):
        for signer in (Signer(None), Signer(OTHER, system=254)):
            receives(keyed, signer.states(BEAT))
    assert keyed.operator.take_new_stations() == [
        "255/190 at 10.0.0.1:14550 is not obeyed: it is not signed",
        "254/190 at 10.0.0.1:14550 is not obeyed: it is signed with another key",
    ]
    receives(keyed, Signer(None).states(BEAT))
    receives(keyed, Signer(at=SECOND).states(BEAT))
    assert keyed.operator.take_new_stations() == []
