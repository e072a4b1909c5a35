"""Meaning of each firmware's commands to the guard, and packets that are no command."""

from typing import Final

import pytest

from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.guard.commands import (
    READERS,
    Board,
    Inputs,
    ListedCommand,
    libraries_in,
    no_motion,
)
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.families.motor_shield.wire.motor_shield import Pin
from firmware_bridge.robot_types import find
from hil_tests.safety.test_guard_shield import channel, pwm, way

NOTHING: Final = ListedCommand()
AT_STANDSTILL: Final = ListedCommand(at_standstill=True)
OFF: Final = Inputs(0, in1=False, in2=False)
RELEASED: Final = Inputs(None, in1=False, in2=False)
AHEAD_0: Final = Inputs(0, in1=True, in2=False)


def board(protocol: str, libraries: tuple[str, ...] = mw.LIBRARIES) -> Board:
    return Board(ShieldLink.of_link(over_protocol(find("rome"), protocol), "board"), (1, 2, 3), libraries)


@pytest.mark.parametrize(
    ("data", "means"),
    [
        (b"m 5 0 0\r", ListedCommand({1: Inputs(5, in1=True, in2=False)})),
        (b"m 0 0 0\r", ListedCommand({1: OFF})),
        (b"m 5 1 0\r", None),
        (b"m 0 0 -1\r", None),
        (b"m 5\r", None),
        (b"m 5 0\r", None),
        (b"m 5 0 0 0\r", None),
    ],
)
def test_terminals_without_an_axis_stand_still(data: bytes, means: ListedCommand | None) -> None:
    """One motor on a firmware for three: it takes three words, and two of them are 0."""
    one = board("ros-arduino-bridge")._replace(motors=(1,))
    assert READERS[one.link.protocol](data, one) == means
    assert list(no_motion(1, one)) == [b"m 0 0 0\r"]


def encoder(*data: int) -> bytes:
    return firmata.exclusive(firmata.ENCODER, bytes(data))


def written(low: int, high: int) -> bytes:
    """A write of M1's PWM whose third byte is this, in two times seven bits."""
    whole = firmata.i2c_write(motor_shield.ADDRESS, motor_shield.encode_channel(1, Pin.PWM, 255))
    return whole[:8] + bytes((low, high)) + whole[10:]


@pytest.mark.parametrize(
    ("protocol", "data", "means"),
    [
        ("ros-arduino-bridge", b"b\r", NOTHING),
        ("ros-arduino-bridge", b"e\r", NOTHING),
        ("ros-arduino-bridge", b"r\r", AT_STANDSTILL),
        ("ros-arduino-bridge", b"m 0 0 0\r", ListedCommand({1: OFF, 2: OFF, 3: OFF})),
        (
            "ros-arduino-bridge",
            b"m 1 0 -1\r",
            ListedCommand(
                {
                    1: Inputs(1, in1=True, in2=False),
                    2: Inputs(0, in1=True, in2=False),
                    3: Inputs(1, in1=False, in2=True),
                }
            ),
        ),
        ("ros-arduino-bridge", f"m {'9' * (ros.WORD - 1)} 0 0\r".encode(), None),
        (
            # The firmware has room for 15 characters of a number, its sign among them.
            "ros-arduino-bridge",
            b"m -99999999999999 0 0\r",
            ListedCommand({1: Inputs(99_999_999_999_999, in1=False, in2=True), 2: AHEAD_0, 3: AHEAD_0}),
        ),
        ("ros-arduino-bridge", b"b 1\r", None),
        ("ros-arduino-bridge", b"x 1 0 1\r", None),
        ("ros-arduino-bridge", "m \u0661 0 1\r".encode(), None),
        ("arduinoio", b"", None),
        ("arduinoio", b"?", None),
        ("arduinoio", b"C" + way(2, "f")[1:], None),
        ("mw", b"\x01" + mw.encode_request(messages.GetServerInfo(), 1)[1:], None),
        ("firmata", firmata.exclusive(firmata.VERSION), None),
        ("firmata", firmata.exclusive(firmata.FIRMWARE, b"\1"), None),
        ("firmata", firmata.exclusive(firmata.FIRMWARE) * 2, None),
        ("firmata", b"", None),
        ("firmata", encoder(), None),
        ("firmata", firmata.exclusive(0x71, channel(2, Pin.PWM, 255)[2:-1]), None),
        ("firmata", channel(4, Pin.PWM, 9), None),
        ("arduinoio", arduinoio.encode("9", 9), NOTHING),
        ("arduinoio", arduinoio.encode("G", 1), NOTHING),
        ("arduinoio", arduinoio.encode("H", 1), AT_STANDSTILL),
        ("arduinoio", arduinoio.encode("E", 0, 2, 3), AT_STANDSTILL),
        ("arduinoio", arduinoio.encode("E", 0, 2, 3)[:-1] + b"\0", None),
        ("arduinoio", pwm(2, 16), ListedCommand({2: Inputs(16, None, None)})),
        ("arduinoio", way(2, "f"), ListedCommand({2: Inputs(None, in1=True, in2=False)})),
        ("arduinoio", way(2, "b"), ListedCommand({2: Inputs(None, in1=False, in2=True)})),
        ("arduinoio", way(2, "r"), ListedCommand({2: RELEASED})),
        ("arduinoio", way(4, "f"), None),
        ("mw", mw.encode_request(messages.GetServerInfo(), 1), NOTHING),
        ("mw", mw.encode_request(messages.ReadCount(0, 0), 1), NOTHING),
        ("mw", mw.encode_request(messages.ReadCount(0, 1), 1), None),
        ("mw", mw.encode_request(messages.StopMotor(0, 2), 1), ListedCommand({3: RELEASED})),
        ("mw", mw.encode_request(messages.StopMotor(0, 0), 1), ListedCommand({1: RELEASED})),
        ("mw", mw.encode_request(messages.StopMotor(0, 3), 1), None),
        *(
            ("mw", mw.encode_frame(mw.RequestFrame(1, 2, stepper, bytes(4))), None)
            for stepper in (6, 7, 8, 9)
        ),
        ("mw", mw.encode_request(messages.StopMotor(0, 0), 1) + bytes(9), ListedCommand({1: RELEASED})),
        ("mw", mw.encode_request(messages.StopMotor(0, 0), 1) + b"\0\1", None),
        (
            "mw",
            mw.encode_request(messages.SetMotorSpeed(0, 2, 9, 2), 1),
            ListedCommand({3: Inputs(9, in1=False, in2=True)}),
        ),
        ("firmata", firmata.exclusive(firmata.FIRMWARE), NOTHING),
        ("firmata", firmata.exclusive(firmata.I2C_CONFIG, bytes(2)), AT_STANDSTILL),
        ("firmata", encoder(0, 0, 18, 19), AT_STANDSTILL),
        ("firmata", encoder(1, 0), NOTHING),
        ("firmata", encoder(2), NOTHING),
        ("firmata", encoder(3, 0), AT_STANDSTILL),
        ("firmata", encoder(4, 0), None),
        ("firmata", channel(2, Pin.IN1, 1), ListedCommand({2: Inputs(None, in1=True, in2=None)})),
        ("firmata", channel(2, Pin.IN2, 0), ListedCommand({2: Inputs(None, in1=None, in2=False)})),
        ("firmata", channel(2, Pin.PWM, 255), ListedCommand({2: Inputs(255, None, None)})),
        ("firmata", channel(2, Pin.PWM, 9) + b"\xf0", None),
        ("firmata", written(0, 2), None),
    ],
)
def test_a_word_means_what_its_firmware_makes_of_it(
    protocol: str, data: bytes, means: ListedCommand | None
) -> None:
    one = board(protocol)
    assert READERS[one.link.protocol](data, one) == means


def test_a_library_that_the_board_has_not_reported_is_not_listed() -> None:
    one = board("mw", (mw.SHIELD,))
    request = mw.encode_request(messages.ReadCount(0, 0), 1, (mw.SHIELD, mw.ENCODER))
    assert READERS[one.link.protocol](request, one) is None


def test_what_takes_a_motors_speed_is_for_that_motor() -> None:
    (stops,) = no_motion(2, board("mw"))
    assert READERS[board("mw").link.protocol](stops, board("mw")) == ListedCommand({2: RELEASED})


def test_the_version_is_requested_in_a_message_of_its_own() -> None:
    one = board("firmata")
    requests = firmata.encode(firmata.Message(firmata.VERSION))
    assert READERS[one.link.protocol](requests, one) == NOTHING


def test_gains_leave_as_the_file_has_them_and_in_its_order() -> None:
    one = board("ros-arduino-bridge")
    gains = one.link.gains.model_copy(update={"kp": 21, "kd": 12, "ki": 3, "ko": 50})
    other = one._replace(link=one.link.model_copy(update={"gains": gains}))
    for four, means in (((21, 12, 3, 50), AT_STANDSTILL), ((21, 12, 3, 21), None), ((12, 21, 3, 50), None)):
        assert READERS[one.link.protocol](ros.encode("u", four), other) == means


def test_a_board_that_has_not_reported_its_shield_is_reported_nothing() -> None:
    assert list(no_motion(1, board("mw", (mw.ENCODER,)))) == []


def test_libraries_are_those_of_the_answer_that_reports_them() -> None:
    row = mw.row_of(messages.GetServerInfo())
    reported = row.answer.encode(messages.ServerInfo(1, 0, b"board", 0, (b"one", b"two")))
    answers: list[mw.Traced | mw.MwAnswer] = [mw.Traced(b"hello"), mw.MwAnswer(row.code, reported)]
    assert libraries_in(iter(answers)) == ("one", "two")
    assert libraries_in(iter(answers[:1])) is None
