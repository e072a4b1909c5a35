"""ros_arduino_bridge with three motors, both ends: its lines, the loop's integers, the auto-stop."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.shield.tb6612 import COAST, BridgeDuty
from emulators.arduino_omni.sketches.motor_pid import Gains, MotorPid
from emulators.arduino_omni.sketches.ros_arduino_bridge import RosSketch
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.node import DTR_UP
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.lines import LONGEST_LINE, LineReader
from hil_tests.lanes import examples
from hil_tests.unit.arduino.hosts import Host


def host(motors: int = 3, auto_stop: int = 2000) -> Host:
    return Host(lambda mega: RosSketch(mega, motors, auto_stop), ros.BAUD)


def sketch(it: Host) -> RosSketch:
    assert isinstance(it.mega.sketch, RosSketch)
    return it.mega.sketch


EXCHANGES = [
    (2, "m", (10, -5), b"m 10 -5\r", b"OK\r\n", ()),
    (2, "e", (), b"e\r", b"1234 -567\r\n", (1234, -567)),
    (2, "u", (20, 12, 0, 50), b"u 20:12:0:50\r", b"OK\r\n", ()),
    (3, "e", (), b"e\r", b"1234 -567 8\r\n", (1234, -567, 8)),
    (3, "b", (), b"b\r", b"57600\r\n", (57_600,)),
    (3, "m", (1, 2, 3), b"m 1 2 3\r", b"OK\r\n", ()),
    (3, "o", (1, -2, 3), b"o 1 -2 3\r", b"OK\r\n", ()),
    (3, "r", (), b"r\r", b"OK\r\n", ()),
    (3, "a", (2,), b"a 2\r", b"517\r\n", (517,)),
    (3, "c", (13, 1), b"c 13 1\r", b"OK\r\n", ()),
    (3, "w", (13, 1), b"w 13 1\r", b"OK\r\n", ()),
    (3, "x", (9, 100), b"x 9 100\r", b"OK\r\n", ()),
    (3, "d", (7,), b"d 7\r", b"1\r\n", (1,)),
]


@pytest.mark.parametrize("slowly", [False, True])
@pytest.mark.parametrize(("motors", "letter", "numbers", "requested", "answered", "meant"), EXCHANGES)
def test_both_ends_say_and_read_the_lines(
    motors: int,
    letter: str,
    numbers: tuple[int, ...],
    requested: bytes,
    *,
    answered: bytes,
    meant: tuple[int, ...],
    slowly: bool,
) -> None:
    assert ros.encode(letter, numbers, motors) == requested
    it = host(motors)
    assert it.banner == b""
    it.mega.shafts.edges[:] = [1234, -567, 8]
    it.mega.pins.analog[2] = 517
    it.mega.pins.driven[7] = True
    stated = (it.ask_slowly if slowly else it.ask)(requested)
    assert stated == answered
    (line,) = LineReader().receive(stated)
    assert ros.decode(letter, line, motors) == meant


@pytest.mark.parametrize("line", [b"\r", b"z\r", b" 1 2\r", b"s 1 90\r", b"t 1\r", b"\xff\r", b"E\r"])
def test_what_is_not_compiled_is_invalid(line: bytes) -> None:
    it = host()
    assert it.ask(line) == b"Invalid Command\r\n"
    assert ros.decode("e", b"Invalid Command") is None
    assert it.ask(b"b\r") == b"57600\r\n"


def test_a_line_feed_before_a_command_does_no_harm() -> None:
    assert host().ask(b"b\r\n") == b"57600\r\n"
    assert host().ask(b"\nb\r") == b"57600\r\n"


def test_words_are_as_long_as_the_sketchs_room_and_surplus_is_lost() -> None:
    it = host()
    it.mega.pins.analog[2] = 9
    assert it.ask(b"a 0000000000000024\r") == b"9\r\n"  # the 4 has no room
    assert it.ask(b"a 2 3 4 5 6 7\r") == b"9\r\n"
    assert it.ask(b"ab 2\r") == b"57600\r\n"  # the last letter counts


# Frames worked by hand from the loop's line of integers: counts that came, and the PWM that follows.
KP_KD = [(0, 4), (3, 6), (5, 7), (13, 4), (10, 4)]
WITH_KI = [(0, 4), (3, 7), (5, 10), (13, 10), (10, 12)]


@pytest.mark.parametrize(("ki", "frames"), [(0, KP_KD), (5, WITH_KI)])
def test_the_loop_is_the_sketchs_in_its_integers(ki: int, frames: list[tuple[int, int]]) -> None:
    pid = MotorPid(Gains(ki=ki))
    pid.reset(1000)
    pid.target = 10
    at = 1000
    for moved, pwm in frames:
        at += moved
        assert pid.update(at) == pwm


def test_the_loop_is_odd_as_division_goes_towards_zero() -> None:
    ahead, back = MotorPid(Gains()), MotorPid(Gains())
    ahead.target, back.target = 10, -10
    at = 0
    for moved, pwm in KP_KD:
        at += moved
        assert (ahead.update(at), back.update(-at)) == (pwm, -pwm)


def test_the_integral_rests_while_the_output_is_at_its_end() -> None:
    pid = MotorPid(Gains(ki=1000))
    pid.target = 1000
    assert [pid.update(0) for _ in range(3)] == [255, 255, 255]
    pid.target = 0
    assert pid.update(0) == 255  # error 0, no integral: the output stays
    pid.target = -10
    assert pid.update(0) == 251  # -200 / 50
    assert pid.update(0) == 47  # (-200 - 10 x 1000) / 50


@given(
    st.integers(-32768, 32767),
    st.lists(st.integers(-(2**31), 2**31 - 1), max_size=20),
    st.lists(st.integers(-32768, 32767), min_size=4, max_size=4),
)
def test_whatever_the_gains_the_output_has_its_bounds(
    target: int, counts: list[int], gains: list[int]
) -> None:
    pid = MotorPid(Gains(*gains))
    pid.target = target
    assert all(-255 <= pid.update(count) <= 255 for count in counts)


def test_the_loop_runs_every_33_of_the_boards_milliseconds() -> None:
    it = host()
    it.ask(b"m 10 -20 0\r", 40 * MILLISECOND)
    seen = []
    outputs = sketch(it).pids[0]
    for _ in range(330):
        it.run(MILLISECOND)
        seen.append(outputs.output)
    changes = [n for n, (before, after) in enumerate(pairwise(seen)) if before != after]
    assert len(changes) == 10
    assert all(b - a in {32, 33, 34} for a, b in pairwise(changes))
    assert outputs.output == 4 * (seen[0] // 4 + 10)


def test_what_a_frame_writes_to_the_shield() -> None:
    it = host()
    it.send(b"m 10 -20 0\r")
    it.run(40 * MILLISECOND)
    assert it.spy.transfers[:8] == [
        *("26 00 00 40 00", "2A 00 00 00 00", "2E 00 10 00 00"),
        *("3A 00 00 80 00", "32 00 00 00 00", "36 00 10 00 00"),
        *("0E 00 00 00 00", "16 00 00 00 00"),
    ]
    assert it.motors()[:2] == (BridgeDuty(cw=64, brake=4032), BridgeDuty(ccw=128, brake=3968))


def test_raw_pwm_has_no_loop() -> None:
    it = host()
    it.ask(b"o 255 -300 0\r", SECOND)
    full = BridgeDuty(cw=4080, brake=16)
    assert it.motors() == (full, BridgeDuty(ccw=4080, brake=16), COAST, COAST)
    assert sketch(it).pids[0].output == 0


@pytest.mark.parametrize("command", [b"m 10 0 0\r", b"o 100 0 0\r"])
@pytest.mark.parametrize("auto_stop", [500, 2000])
def test_no_one_speaks_and_it_stops_by_itself(command: bytes, auto_stop: int) -> None:
    it = host(auto_stop=auto_stop)
    it.send(command)
    it.run(auto_stop * MILLISECOND)
    assert it.motors()[0] != COAST
    it.run(
        15 * MILLISECOND
    )  # two milliseconds of its clock, the byte times, and a frame that was being written
    assert it.motors() == (COAST,) * 4
    written = len(it.spy.transfers)
    it.run(5 * SECOND)
    assert len(it.spy.transfers) == written


@pytest.mark.parametrize("flood", [b"p 30\r", b"r\r", b"x"])
def test_who_floods_it_does_not_hold_up_the_auto_stop(flood: bytes) -> None:
    it = host(auto_stop=500)
    it.ask(b"o 100 0 0\r", 20 * MILLISECOND)
    it.send(flood * 2_000)
    it.run(1_700 * MILLISECOND)  # a ping takes a second
    assert it.motors() == (COAST,) * 4


def test_wheels_that_were_pushed_do_not_jump_when_the_loop_begins() -> None:
    it = host()
    it.mega.shafts.edges[0] += 5_000
    it.send(b"m 10 0 0\r")
    it.run(40 * MILLISECOND)
    assert it.motors()[0] == BridgeDuty(cw=64, brake=4032)


def test_who_speaks_again_in_time_goes_on() -> None:
    it = host()
    for _ in range(10):
        assert it.ask(b"m 10 0 0\r", 1900 * MILLISECOND) == b"OK\r\n"
        assert it.motors()[0] != COAST


def test_zero_speeds_stop_at_once_and_reset_the_loop() -> None:
    it = host()
    it.ask(b"m 10 10 10\r", SECOND)
    it.ask(b"m 0 0 0\r", 15 * MILLISECOND)
    assert it.motors() == (COAST,) * 4
    it.run(SECOND)
    assert it.motors() == (COAST,) * 4
    assert [pid.output for pid in sketch(it).pids] == [0, 0, 0]


def test_a_reset_of_the_board_ends_in_a_stand_when_setup_has_run() -> None:
    it = host()
    it.ask(b"m 10 10 10\r", SECOND)
    before = it.motors()
    it.send(b"", DTR_UP)
    it.run(1100 * MILLISECOND)
    assert it.motors() == before
    it.spy.transfers.clear()
    it.run(MILLISECOND)
    assert it.spy.transfers[0] == "FD 10"  # before the shield is set up, which would let it drive once more
    for _ in range(20):
        assert it.motors() == (COAST,) * 4
        it.run(MILLISECOND)
    assert it.ask(b"b\r") == b"57600\r\n"


def test_encoders_and_gains_are_set() -> None:
    it = host()
    it.mega.shafts.edges[:] = [10, 20, -30]
    assert it.ask(b"e\r") == b"10 20 -30\r\n"
    it.ask(b"r\r")
    assert it.ask(b"e\r") == b"0 0 0\r\n"
    it.ask(b"u 1:2:3\r")
    assert sketch(it)._gains == Gains(1, 2, 3, 50)  # noqa: SLF001 - they are not reported


# What the sketch's binary does, too, in simavr.
PINS_REPORTED = [
    (b"c 2 1\rw 2 0\rd 2\r", b"1"),  # an encoder's pin, pulled up: passed over
    (b"x 21 0\rd 21\r", b"1"),
    (b"c 22 1\rw 22 1\rd 22\r", b"1"),
    (b"x 22 127\rd 22\r", b"0"),  # no PWM there
    (b"x 22 128\rd 22\r", b"1"),
    (b"x 44 200\rd 44\r", b"0"),
    (b"w 30 1\rd 30\rp 30\rd 30\r", b"0"),  # the pull-up goes with a ping
    (b"w 99 1\rd 99\r", b"0"),
]


@pytest.mark.parametrize(("lines", "level"), PINS_REPORTED)
def test_pins_do_what_the_core_makes_of_them(lines: bytes, level: bytes) -> None:
    assert host().ask(lines, 2 * SECOND).splitlines()[-1] == level


def test_gains_end_at_a_zero_byte() -> None:
    it = host()
    it.ask(b"u 7\x008:9\r")
    assert sketch(it)._gains == Gains(7, 12, 0, 50)  # noqa: SLF001 - they are not reported


def test_a_ping_without_a_sensor_keeps_the_board_for_a_second() -> None:
    it = host()
    assert it.ask(b"p 5\r", 990 * MILLISECOND) == b""
    it.run(20 * MILLISECOND)
    assert it.taken() == b"0\r\n"


@settings(max_examples=examples(60))
@given(
    st.lists(
        st.one_of(
            st.binary(max_size=30), st.text("abcdemoprstuwx 0123456789-:\r\n", max_size=40).map(str.encode)
        ),
        max_size=8,
    )
)
def test_whatever_a_foreign_node_sends_lines_come_back_and_it_lives_on(chunks: list[bytes]) -> None:
    it = host()
    stated = b"".join(it.ask(chunk, 200 * MILLISECOND) for chunk in chunks)
    it.run(70 * SECOND)  # a full ring of pings
    stated += it.taken()
    assert stated == b"" or stated.endswith(b"\r\n")
    lines = stated.split(b"\r\n")[:-1]
    ended = sum(chunk.count(b"\r") for chunk in chunks)
    assert ended - it.mega.serial.lost <= len(lines) <= ended
    it.ask(b"\r", 2 * SECOND)  # ends whatever was begun
    assert it.ask(b"b\r") == b"57600\r\n"


@given(st.binary(max_size=200), st.sampled_from(sorted(ros.COMMANDS)))
def test_whatever_a_board_states_the_hosts_end_goes_on(noise: bytes, letter: str) -> None:
    lines = list(LineReader().receive(noise))
    split = LineReader()
    assert [it for byte in noise for it in split.receive(bytes((byte,)))] == lines
    for line in lines:
        ros.decode(letter, line)


@pytest.mark.parametrize(("length", "whole"), [(LONGEST_LINE, True), (LONGEST_LINE + 1, False)])
def test_a_line_is_as_long_as_it_may_be(length: int, *, whole: bool) -> None:
    reader, line = LineReader(), b"7" * length
    assert list(reader.receive(line + ros.LINE_END + b"OK" + ros.LINE_END)) == [line] * whole + [b"OK"]


def test_a_line_that_never_ends_takes_no_memory_and_the_next_one_is_whole() -> None:
    reader = LineReader()
    for _ in range(100):
        assert list(reader.receive(b"7" * 1000)) == []
        assert len(reader.waiting) <= LONGEST_LINE + len(ros.LINE_END)
    assert list(reader.receive(ros.LINE_END + b"OK" + ros.LINE_END)) == [b"OK"]


@pytest.mark.parametrize(
    ("letter", "numbers", "why"), [("q", (), "no command 'q'"), ("m", (1,), "takes 3 numbers, and got 1")]
)
def test_the_hosts_end_refuses_what_is_no_command(letter: str, numbers: tuple[int, ...], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        ros.encode(letter, numbers)
