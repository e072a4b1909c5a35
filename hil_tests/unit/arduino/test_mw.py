"""MWProtocol, both ends: the worked frames whole and byte by byte, damage, third parties."""

import struct
from dataclasses import fields

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.mega.mega import Mega
from emulators.arduino_omni.shield.tb6612 import COAST, BridgeDuty
from emulators.arduino_omni.sketches.mw import MwSketch
from firmware_bridge.families.motor_shield.wire import mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.arduino.hosts import Host

THREE = mw.LIBRARIES[:3]
INFO = (
    "A5 00 00 33 01 11 01 3B 4D 65 67 61 32 35 36 30 3B 00 3B 00 49 32 43 3B 01 53 65 72 76 6F 3B 02 "
    "41 64 61 66 72 75 69 74 2F 4D 6F 74 6F 72 53 68 69 65 6C 64 56 32 2B"
)
# The exchanges worked out from the layout: request, its sequence number, the host's frame, the board's.
EXCHANGES = [
    (messages.GetServerInfo(), 0, "5A 03 00 00 01 FC", INFO),
    (messages.CreateShield(0, 0x60, 1600), 1, "5A 08 00 81 02 00 00 60 40 06 CF", "A5 00 00 02 00 FE"),
    (messages.CreateMotor(0, 0), 2, "5A 06 00 82 02 02 00 00 74", "A5 00 00 02 02 FC"),
    (messages.StartMotor(0, 0, 127, 1), 3, "5A 08 00 83 02 03 00 00 7F 01 F0", "A5 00 00 02 03 FB"),
    (messages.SetMotorSpeed(0, 2, 255, 2), 4, "5A 08 00 84 02 05 00 02 FF 02 6A", "A5 00 00 02 05 F9"),
    (messages.StopMotor(0, 0), 5, "5A 06 00 85 02 04 00 00 6F", "A5 00 00 02 04 FA"),
    (messages.AttachEncoder(0, 2, 3), 6, "5A 07 00 86 03 01 00 02 03 6A", "A5 00 00 02 01 FD"),
    (
        messages.ReadCount(0, 0),
        7,
        "5A 06 00 87 03 04 00 00 6C",
        "A5 00 00 0B 04 D2 04 00 00 88 13 00 00 00 80",
    ),
    (messages.WriteDigital(0, 13, 1), 8, "5A 06 00 08 10 00 0D 01 D4", "A5 00 00 02 10 EE"),
]
ANSWERS = {
    messages.GetServerInfo: messages.ServerInfo(
        17, 1, b"Mega2560", 0, (b"I2C", b"Servo", b"Adafruit/MotorShieldV2")
    ),
    messages.ReadCount: messages.Count(1234, 5000, 0),
}


def host(libraries: tuple[str, ...] = mw.LIBRARIES, encoders: int = 2) -> Host:
    return Host(lambda mega: MwSketch(mega, libraries, encoders), mw.BAUD)


@pytest.mark.parametrize(("request_", "sequence", "requested", "answered"), EXCHANGES)
def test_the_hosts_end_states_and_reads_the_worked_frames(
    request_: mw.Message, sequence: int, requested: str, answered: str
) -> None:
    assert mw.encode_request(request_, sequence) == bytes.fromhex(requested)
    frame = bytes.fromhex(answered)
    whole = list(mw.AnswerReader().receive(frame))
    reader = mw.AnswerReader()
    slowly = [it for byte in frame for it in reader.receive(bytes((byte,)))]
    noisy = list(mw.AnswerReader().receive(b"MWProtocol\xa5\x07" + frame + b"\xa5"))
    assert whole == slowly == noisy
    (only,) = whole
    assert isinstance(only, mw.MwAnswer)
    assert mw.decode_answer(request_, only) == ANSWERS.get(type(request_), messages.Done())


@pytest.mark.parametrize("slowly", [False, True])
def test_the_board_answers_the_worked_frames_in_a_row(*, slowly: bool) -> None:
    it = host()
    assert it.banner == b"MWProtocol"
    it.mega.shafts.edges[0] = 17
    for request, _, requested, answered in EXCHANGES:
        if isinstance(request, messages.GetServerInfo):
            continue  # the worked answer is of a board with three libraries
        if isinstance(request, messages.ReadCount):
            it.mega.shafts.edges[0] += 1234
            # to where it reads the last byte between two of its milliseconds
            until = it.mega.clock.shows(5000, it.now) - (24 * MILLISECOND if slowly else 0)
            it.run(until - it.now)
        stated = (it.ask_slowly if slowly else it.ask)(bytes.fromhex(requested))
        assert stated == bytes.fromhex(answered), request


def test_a_board_with_three_libraries_states_so() -> None:
    it = host(THREE)
    assert it.ask(bytes.fromhex("5A 03 00 00 01 FC")) == bytes.fromhex(INFO)
    assert it.mega.pins.read(13) == 1
    assert it.ask(mw.encode_request(messages.ReadCount(0, 0), 0)) == b""


def ready(encoders: int = 2) -> Host:
    it = host(encoders=encoders)
    it.ask(mw.encode_request(messages.CreateShield(0, 0x60, 1600), 1))
    for motor in range(3):
        it.ask(mw.encode_request(messages.CreateMotor(0, motor), 2))
    it.spy.transfers.clear()
    return it


def test_what_is_written_to_the_shield_and_what_the_motors_get() -> None:
    it = ready()
    it.ask(mw.encode_request(messages.StartMotor(0, 0, 127, 1), 3))
    assert it.spy.transfers == ["26 00 00 F0 07", "2A 00 00 00 00", "2E 00 10 00 00"]
    it.ask(mw.encode_request(messages.SetMotorSpeed(0, 2, 255, 2), 4))
    assert it.motors() == (BridgeDuty(cw=2032, brake=2064), COAST, BridgeDuty(ccw=4080, brake=16), COAST)
    it.ask(mw.encode_request(messages.StopMotor(0, 0), 5))
    assert it.motors()[0] == COAST


def test_begin_takes_its_time_and_the_answer_comes_after_it() -> None:
    it = host()
    frame = mw.encode_request(messages.CreateShield(0, 0x60, 1600), 1)
    assert it.ask(frame, 15 * MILLISECOND) == b""
    it.run(5 * MILLISECOND)
    assert it.taken() == bytes.fromhex("A5 00 00 02 00 FE")


def test_what_comes_while_it_is_at_work_is_thrown_away_with_the_answer() -> None:
    it = ready()
    frame = mw.encode_request(messages.StartMotor(0, 0, 1, 1), 0)
    assert it.ask(frame + frame) == bytes.fromhex("A5 00 00 02 03 FB")


def test_a_reset_leaves_the_motors_running_and_forgets_that_they_were_made() -> None:
    it = ready()
    it.ask(mw.encode_request(messages.StartMotor(0, 0, 255, 1), 3))
    it.mega.reset(it.now)
    it.board.wake(it.now)
    it.wake_at = it.now
    it.run(2 * SECOND)
    assert it.taken() == b"MWProtocol"
    runs = BridgeDuty(cw=4080, brake=16)
    assert it.motors()[0] == runs
    assert it.ask(mw.encode_request(messages.StopMotor(0, 0), 0)) == bytes.fromhex("A5 00 00 02 04 FA")
    assert it.motors()[0] == runs
    it.ask(mw.encode_request(messages.CreateShield(0, 0x60, 1600), 0))
    assert it.motors()[0] == COAST


def answer(it: Host, request: mw.Message) -> mw.Message:
    (only,) = mw.AnswerReader().receive(it.ask(mw.encode_request(request, 0)))
    assert isinstance(only, mw.MwAnswer)
    return mw.decode_answer(request, only)


def test_encoders_count_reset_and_are_two_where_the_library_is_stock() -> None:
    for encoders, third in ((2, 0), (3, 7)):
        it = ready(encoders)
        for encoder, (pin_a, pin_b) in enumerate(((2, 3), (19, 18), (10, 11))):
            assert answer(it, messages.AttachEncoder(encoder, pin_a, pin_b)) == messages.Done()
        it.mega.shafts.edges[:] = [70_000, 5, 7]
        counts = [answer(it, messages.ReadCount(encoder, 1)).count for encoder in range(3)]
        assert counts == [70_000, -5, third]
        assert answer(it, messages.ReadCount(0, 0)).count == 0
        answer(it, messages.WriteCount(1, -2))
        assert answer(it, messages.ReadCount(1, 0)).count == -2
        it.send(mw.encode_request(messages.ReadSpeed(b"\x00\x01"), 0))
        it.run(10 * MILLISECOND)
        it.mega.shafts.edges[0] -= 300
        it.run(15 * MILLISECOND)
        assert it.taken() == mw.encode_answer(5, struct.pack("<bhbh", 0, -300, 0, 0))
        answer(it, messages.DetachEncoder(0))
        assert answer(it, messages.ReadCount(0, 0)).count == 0


def test_pins_voltages_and_memory() -> None:
    it = host()
    it.mega.pins.analog[3] = 700
    it.mega.pins.driven[7] = True
    assert answer(it, messages.ReadVoltage(3)) == messages.Voltage(700)
    assert answer(it, messages.ReadDigital(0, 7)) == messages.Level(1)
    answer(it, messages.ConfigureDigital(1, 2, 2))
    assert answer(it, messages.ReadDigital(1, 2)) == messages.Level(1)
    answer(it, messages.WriteDuty(9, 100))
    assert it.mega.pins.duties == {9: 100}
    assert answer(it, messages.GetFreeRam()) == messages.FreeRam(5000)
    answer(it, messages.ResetPins())
    assert it.mega.pins.duties == {}


GOOD = bytes.fromhex("5A 06 00 08 10 00 0D 01 D4")
STATED = bytes.fromhex("A5 00 00 02 10 EE")


@pytest.mark.parametrize("place", range(1, len(GOOD)))
def test_a_damaged_frame_has_no_answer_and_the_board_lives_on(place: int) -> None:
    damaged = bytearray(GOOD)
    damaged[place] ^= 0x20
    it = host()
    assert it.ask(bytes(damaged), 2 * SECOND) == b""
    assert it.ask(GOOD) == STATED


@pytest.mark.parametrize(
    "frame",
    ["5A 00 00", "5A 01 00 FF", "5A 02 00 00 FE", "5A 03 00 80 01 7C", "5A 21 03", "5A 03 00 00 7F 7E"],
)
def test_frames_that_say_nothing_have_no_answer(frame: str) -> None:
    it = host()
    assert it.ask(bytes.fromhex(frame)) == b""
    it.run(2 * SECOND)
    assert it.ask(GOOD) == STATED


@pytest.mark.parametrize("taken", range(1, len(GOOD)))
def test_half_a_frame_is_forgotten_a_second_after_its_last_byte(taken: int) -> None:
    it = host()
    it.ask(GOOD[:taken], 990 * MILLISECOND)
    assert it.ask(GOOD[taken:]) == STATED
    it = host()
    it.ask(GOOD[:taken], 1010 * MILLISECOND)
    assert it.ask(GOOD) == STATED


def values(shape: mw.Shape) -> st.SearchStrategy[mw.Message]:
    if shape.open_ended:
        return st.builds(shape.message, st.binary(max_size=60))
    return st.binary(min_size=shape.layout.size, max_size=shape.layout.size).map(shape.decode)


SHAPES = [row.request for row in mw.ROWS if row.request] + [row.answer for row in mw.ROWS[1:]]


@given(st.sampled_from(SHAPES).flatmap(lambda shape: st.tuples(st.just(shape), values(shape))))
def test_each_row_reads_what_it_writes(case: tuple[mw.Shape, mw.Message]) -> None:
    shape, message = case
    assert shape.decode(shape.encode(message)) == message


@given(st.binary(max_size=200))
def test_whatever_a_board_states_the_hosts_end_goes_on(noise: bytes) -> None:
    reader = mw.AnswerReader()
    for found in reader.receive(noise):
        if isinstance(found, mw.MwAnswer):
            mw.decode_answer(messages.GetServerInfo(), found)
    reader.receive(bytes(mw.LARGEST + 4))
    split = mw.AnswerReader()
    assert [it for byte in noise for it in split.receive(bytes((byte,)))] == list(
        mw.AnswerReader().receive(noise)
    )


FRAMES = st.builds(
    lambda library, code, data: mw.encode_frame(mw.RequestFrame(0, library, code, data)),
    st.one_of(st.none(), st.integers(0, 5)),
    st.integers(0, 0x40),
    st.binary(max_size=12),
)


@settings(max_examples=examples(60))
@given(st.lists(st.one_of(FRAMES, st.binary(max_size=20)), max_size=8))
def test_whatever_a_foreign_node_sends_silence_or_a_good_answer(chunks: list[bytes]) -> None:
    it = host()
    stated = b"".join(it.ask(chunk) for chunk in chunks)
    reader = mw.AnswerReader()
    answers = list(reader.receive(stated))
    assert reader.damaged == 0
    assert b"".join(mw.encode_answer(a.code, a.data) for a in answers if isinstance(a, mw.MwAnswer)) == stated
    it.run(2 * SECOND)
    assert it.ask(GOOD) == STATED


def test_every_command_has_a_number_of_its_own_and_what_is_not_emulated_states_so() -> None:
    assert len(mw.COMMANDS) == len(mw.ROWS)
    assert all(row.assumed for row in mw.ROWS if row.request is None)
    for row in mw.ROWS:
        if row.request is not None and not row.request.open_ended:
            assert len(row.request.layout.unpack(bytes(row.request.layout.size))) == len(
                fields(row.request.message)
            )


def test_a_library_that_the_board_lacks_is_named() -> None:
    with pytest.raises(ValueError, match="no library 'RotaryEncoder'; it has: I2C, Servo"):
        mw.encode_request(messages.ReadCount(0, 0), 0, THREE)


def test_the_sketch_is_one() -> None:
    assert isinstance(host().mega.sketch, MwSketch)
    assert Mega(MwSketch, mw.BAUD).sketch is None
