"""Firmata, both ends: the worked messages, queries, I2C down to a turning motor, third parties."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.jobs import OnBus
from emulators.arduino_omni.shield.tb6612 import BridgeDuty
from emulators.arduino_omni.sketches.firmata import FirmataSketch
from firmware_bridge.families.motor_shield.wire import firmata as words
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.arduino.hosts import Host

NAME = words.pairs(b"StandardFirmata.ino")
CONFIG = bytes.fromhex("F0 78 00 00 F7")


def host(*, encoders: bool = False) -> Host:
    return Host(lambda mega: FirmataSketch(mega, encoders=encoders), words.BAUD, ready=4 * SECOND)


def test_it_blinks_for_two_seconds_and_states_who_is_there() -> None:
    it = Host(FirmataSketch, words.BAUD, ready=3_200 * MILLISECOND)
    assert it.banner == b""
    it.run(20 * MILLISECOND)
    assert it.taken() == b"\xf9\x02\x05\xf0\x79\x02\x05" + NAME + b"\xf7"
    assert NAME[:4].hex(" ") == "53 00 74 00"


EXCHANGES = [
    (words.Message(words.VERSION), "F9", "F9 02 05"),
    (words.Message(words.FIRMWARE, exclusive=True), "F0 79 F7", "F0 79 02 05" + NAME.hex() + "F7"),
    (words.Message(words.PIN_STATE_QUERY, b"\x0d", exclusive=True), "F0 6D 0D F7", "F0 6E 0D 01 00 F7"),
    (words.Message(words.PIN_STATE_QUERY, b"\x7e", exclusive=True), "F0 6D 7E F7", "F0 6E 7E F7"),
    (words.Message(words.REPORT_ANALOG, b"\x01", 3), "C3 01", "E3 3C 05"),
    (words.Message(words.SAMPLING, b"\x64\x00", exclusive=True), "F0 7A 64 00 F7", ""),
    (words.Message(0x71, b"\x41\x00", exclusive=True), "F0 71 41 00 F7", ""),
]


@pytest.mark.parametrize("slowly", [False, True])
@pytest.mark.parametrize(("message", "requested", "answered"), EXCHANGES)
def test_both_ends_say_and_read_the_messages(
    message: words.Message, requested: str, answered: str, *, slowly: bool
) -> None:
    data = bytes.fromhex(requested)
    assert words.encode(message) == data
    assert list(words.Parser().receive(data)) == [message]
    it = host()
    it.mega.pins.analog[3] = 700
    wait = 10 * MILLISECOND if message.code == words.REPORT_ANALOG else SECOND
    stated = (it.ask_slowly if slowly else it.ask)(data, wait)
    assert stated == bytes.fromhex(answered)
    assert b"".join(map(words.encode, words.Parser(from_board=True).receive(stated))) == stated


def test_the_worked_i2c_messages() -> None:
    assert words.i2c_write(0x60, b"\0\xa1") == bytes.fromhex("F0 76 60 00 00 00 21 01 F7")
    channel = bytes.fromhex("26 00 00 00 08")
    assert words.i2c_write(0x60, channel) == bytes.fromhex("F0 76 60 00 26 00 00 00 00 00 00 00 08 00 F7")
    assert words.i2c_read(0x60, 0, 1) == bytes.fromhex("F0 76 60 08 00 00 01 00 F7")
    reply = bytes.fromhex("F0 77 60 00 00 00 21 00 F7")
    (message,) = words.Parser(from_board=True).receive(reply)
    assert words.decode_i2c(message) == words.I2cRead(0x60, 0, b"\x21")


@pytest.mark.parametrize("slowly", [False, True])
def test_the_shield_is_set_up_and_driven_over_raw_i2c(*, slowly: bool) -> None:
    it = host()
    ask = it.ask_slowly if slowly else it.ask
    assert ask(words.i2c_write(0x60, b"\0\0")) == b""
    assert it.spy.transfers == []  # not configured
    ask(CONFIG)
    port = library.motor(1)
    assert port is not None
    for job in (*library.begin(0x60), *library.drive(0x60, port, 128, 1)):
        if isinstance(job, OnBus) and not job.transfer.segments[0].to_read:
            ask(words.i2c_write(0x60, job.transfer.segments[0].written), 10 * MILLISECOND)
    assert it.spy.transfers[-3:] == ["26 00 00 00 08", "2A 00 00 00 00", "2E 00 10 00 00"]
    assert it.motors()[0] == BridgeDuty(cw=2048, brake=2048)


def test_a_register_is_read_once_or_again_and_again() -> None:
    it = host()
    it.ask(CONFIG)
    it.ask(words.i2c_write(0x60, b"\0\xa1"))
    assert it.ask(words.i2c_read(0x60, 0, 1)) == bytes.fromhex("F0 77 60 00 00 00 21 00 F7")
    continuous = bytes.fromhex("F0 76 60 10 01 00 01 00 F7")
    stated = it.ask(continuous, 205 * MILLISECOND)
    one = bytes.fromhex("F0 77 60 00 01 00 04 00 F7")
    assert stated == one * (len(stated) // len(one))
    assert len(stated) // len(one) in {9, 10, 11}
    it.ask(bytes.fromhex("F0 76 60 18 F7"))
    assert it.ask(b"", SECOND) == b""


def test_who_is_not_there_or_requested_in_ten_bits_is_reported_in_words() -> None:
    it = host()
    it.ask(CONFIG)
    few = words.exclusive(words.STRING, words.pairs(b"I2C: Too few bytes received"))
    assert it.ask(words.i2c_read(0x33, 0, 2)) == few + bytes.fromhex("F0 77 33 00 00 00 F7")
    ten = words.exclusive(words.STRING, words.pairs(b"10-bit addressing not supported"))
    assert it.ask(bytes.fromhex("F0 76 60 28 00 00 01 00 F7")) == ten
    stated = b"".join(it.ask(bytes.fromhex("F0 76 60 10 01 00 01 00 F7"), MILLISECOND * 5) for _ in range(9))
    assert words.exclusive(words.STRING, words.pairs(b"too many queries")) in stated + it.run(SECOND).taken()


def answer(it: Host, code: int) -> bytes:
    (message,) = words.Parser(from_board=True).receive(it.ask(words.exclusive(code), SECOND))
    return message.data


def test_the_mapping_and_what_pins_can_be() -> None:
    it = host()
    stated = it.ask(words.exclusive(words.MAPPING_QUERY))
    assert stated == b"\xf0\x6a" + b"\x7f" * 54 + bytes(range(16)) + b"\xf7"
    pins = answer(it, words.CAPABILITY_QUERY).split(b"\x7f")
    assert len(pins) == 71
    assert (pins[0], pins[1], pins[-1]) == (b"", b"", b"")
    assert pins[2] == bytes.fromhex("00 01 0B 01 01 01 03 08 04 0E")
    assert pins[20] == bytes.fromhex("00 01 0B 01 01 01 04 0E 06 01")
    assert pins[54] == bytes.fromhex("00 01 0B 01 01 01 02 0A")


def test_pins_are_set_reported_and_reset() -> None:
    it = host()
    it.ask(bytes.fromhex("F4 0D 01 F5 0D 01 F4 09 03 E9 64 00 F4 07 00"))
    assert it.mega.pins.read(13) == 1
    assert it.mega.pins.duties == {9: 100}
    assert it.ask(bytes.fromhex("D0 01")) == bytes.fromhex("90 00 00")
    it.mega.pins.driven[7] = True
    assert it.ask(b"") == bytes.fromhex("90 00 01")
    it.ask(bytes.fromhex("91 00 00"))
    assert it.mega.pins.read(13) == 0
    assert it.ask(b"\xff") == b""
    it.mega.pins.driven[7] = False
    assert it.ask(b"", SECOND) == b""
    assert it.mega.pins.duties == {}


def test_analog_inputs_are_reported_every_19_ms_until_they_are_not() -> None:
    it = host()
    stated = it.ask(bytes.fromhex("C0 01"), SECOND)
    assert len(stated) // 3 in {49, 50, 51}
    it.ask(bytes.fromhex("C0 00"))
    assert it.ask(b"", SECOND) == b""


def test_encoders_are_configurable_firmatas() -> None:
    assert host().ask(bytes.fromhex("F0 61 00 00 02 03 F7 F0 61 01 00 F7")) == b""
    it = host(encoders=True)
    assert words.pairs(b"ConfigurableFirmata.ino") in it.banner
    it.ask(bytes.fromhex("F0 61 00 00 02 03 F7 F0 61 00 01 12 13 F7"))
    it.mega.shafts.edges[:2] = [300, -1]
    assert it.ask(bytes.fromhex("F0 61 01 00 F7")) == bytes.fromhex("F0 61 00 2C 02 00 00 F7")
    assert it.ask(bytes.fromhex("F0 61 02 F7")) == bytes.fromhex("F0 61 00 2C 02 00 00 41 01 00 00 00 F7")
    it.ask(bytes.fromhex("F0 61 03 00 F7"))
    assert it.ask(bytes.fromhex("F0 61 01 00 F7")) == bytes.fromhex("F0 61 00 00 00 00 00 F7")
    stated = it.ask(bytes.fromhex("F0 61 05 00 F7 F0 61 04 01 F7"), 50 * MILLISECOND)
    assert stated == bytes.fromhex("F0 61 41 01 00 00 00 F7") * (len(stated) // 8) != b""


COMMANDS = st.builds(
    lambda row, channel, data: bytes((row.code | channel if row.code < 0xF0 else row.code,)) + data,
    st.sampled_from(words.ROWS),
    st.integers(0, 15),
    st.binary(max_size=3),
)
EXCLUSIVES = st.builds(
    lambda code, data: words.exclusive(code, bytes(it & 0x7F for it in data)),
    st.integers(0x60, 0x7B),
    st.binary(max_size=70),
)


@settings(max_examples=examples(60))
@given(st.lists(st.one_of(COMMANDS, EXCLUSIVES, st.binary(max_size=20)), max_size=8), st.booleans())
def test_whatever_a_foreign_node_sends_good_messages_or_silence(chunks: list[bytes], encoders: bool) -> None:  # noqa: FBT001
    it = host(encoders=encoders)
    it.ask(CONFIG)
    for chunk in chunks:
        it.send(chunk)
        it.run(30 * MILLISECOND)
    it.send(b"\xf7\xff")  # ends whatever was begun
    it.run(3 * SECOND)
    stated = it.taken()
    starts = stated.count(b"\xf0")
    assert (
        starts
        == stated.count(b"\xf7")
        == sum(one.exclusive for one in words.Parser(from_board=True).receive(stated))
    )
    assert it.ask(b"\xf9", SECOND) == b"\xf9\x02\x05"


@given(st.binary(max_size=200), st.booleans())
def test_whatever_is_stated_either_end_goes_on(noise: bytes, from_board: bool) -> None:  # noqa: FBT001
    split = words.Parser(from_board=from_board)
    found = list(words.Parser(from_board=from_board).receive(noise))
    assert [it for byte in noise for it in split.receive(bytes((byte,)))] == found
    for message in found:
        words.decode_i2c(message)


@given(st.lists(st.integers(0, 0x3FFF), max_size=20))
def test_pairs_read_what_they_write(numbers: list[int]) -> None:
    assert list(words.unpaired(words.pairs(numbers))) == numbers
