"""The arm's board against what is published of it: joints, moves in steps and time, answers, the GUI."""

import pytest

from emulators.arduino_omni.ar2.axes import AXES, JOINTS
from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.ar2.firmwares import FIRMWARES
from emulators.arduino_omni.ar2.gravity import weight
from emulators.arduino_omni.ar2.joints import Joints
from emulators.arduino_omni.ar2.moves import TURN_US, waited
from emulators.arduino_omni.ar2.strings import substring
from firmware_bridge.families.ar2 import wire
from firmware_bridge.node import DTR_UP, SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.rows import every
from hil_tests.unit.arduino.ar2_bench import Bench, weightless

ONE = b"MJA0500S25G10H10I10K10\n"
SEVERAL = b"MJA1500B0200C11000D00E00F00T00S25G15H10I20K5\n"


# Axes


@every(
    ("name", "per_step", "gear"),
    [
        ("J1", 0.0223684, 40.2),
        ("J2", 0.0180822, 49.8),
        ("J3", 0.0178344, 50.5),
        ("J4", 0.0217105, 41.5),
        ("J5", 0.0459016, 19.6),
        ("J6", 0.0467925, 19.2),
        ("track", 403.0 / 10_100, 22.6),
    ],
)
def test_joints_have_the_published_steps_and_the_gears_that_follow(
    name: str, per_step: float, gear: float
) -> None:
    axis = next(it for it in AXES if it.name == name)
    assert axis.per_step_deg == pytest.approx(per_step, rel=3e-6)
    assert axis.gear == pytest.approx(gear, abs=0.05)
    assert axis.angle(axis.steps) == axis.most_deg


# Moves


def test_one_joint_takes_the_time_of_the_worked_example() -> None:
    bench = Bench()
    assert bench.ask(ONE) == b"command recieved"
    assert bench.moved() == [-500, 0, 0, 0, 0, 0, 0]
    bench.ask(b"MJA11000S25G10H10I10K10\n")
    assert len(bench.kept) == 1_000
    # 101 steps from 8800 us down, 799 of 800 us, 100 of 800 us and more; whole us are cut in the last part.
    slower = sum(int(800 + 32 * k / 3) for k in range(100))
    whole = 484_800 + 799 * 800 + slower
    assert whole == pytest.approx(1_256_800, abs=100)
    assert bench.span_us() == pytest.approx(whole - 8_800 + 999 * TURN_US, abs=40)


def test_several_joints_go_in_the_turns_of_the_longest() -> None:
    bench = Bench()
    assert bench.ask(SEVERAL) == b"command recieved"
    assert bench.moved() == [500, -200, 1000, 0, 0, 0, 0]
    assert bench.joints.angles[0] == pytest.approx(500 * 340 / 15_200)
    before = {axis: [at for it, _, at in bench.kept if it == axis] for axis in range(3)}
    assert [len(it) for it in before.values()] == [500, 200, 1000]
    # 200 of 1000: every fifth turn; 500: every second; each pulse waits for the one before it.
    turns = [sum(at < one for at in before[2]) for one in before[1]]
    assert turns == [5 * n + 4 for n in range(200)]


def test_it_answers_before_it_moves_and_receives_nothing_while_it_does() -> None:
    bench = Bench()
    assert bench.ask(ONE, 5 * MILLISECOND) == b"command recieved"
    assert bench.kept == []
    assert bench.ask(b"TMone\nTM" + 90 * b"x" + b"\n", 100 * MILLISECOND) == b""
    assert bench.mega.serial.lost == 99 - 63
    assert bench.run(10 * SECOND) == b"one\n\r\n"
    # The rest of the second line, without its end, is in front of what comes next.
    assert bench.ask(b"\nTMtwo\n") == b"TM"[2:] + 55 * b"x" + b"\n\r\n" + b"two\n\r\n"


@every(
    ("line", "stated", "moved"),
    [
        (b"MJA0-500S25G10H10I10K10\n", b"command recieved", 0),
        (b"MJA165586S25G10H10I10K10\n", b"command recieved", 50),  # 16 bits
        (b"MJA140000S25G10H10I10K10\n", b"command recieved", 0),  # -25536
        (b"MJA150S25G0H100I0K100\n", b"command recieved", 50),
        (b"MJA150S1e2G0H100I0K100\n", b"command recieved", 50),
        (b"MJA150\n", b"command recieved", 50),  # no speed: no pause but the loop's own
        (b"MJS25A150G10H10I10K10\n", b"command recieved", 50),
        (b"MJB00A150S25G10H10I10K10\n", b"command recieved", 0),  # "B00A1" is between A's digit and `B`
        (b"MJA2050S25G0H100I0K100\n", b"command recieved", -50),
        (b"MJ\n", b"command recieved", 0),
        (b"mjA150S25G10H10I10K10\n", b"", 0),
        (b"GP\n", b"", 0),
        (b"\n", b"", 0),
    ],
)
def test_fields_are_found_by_their_letters_in_the_whole_line(line: bytes, stated: bytes, moved: int) -> None:
    bench = Bench()
    assert bench.ask(line) == stated
    assert bench.moved() == [moved, 0, 0, 0, 0, 0, 0]


@every(
    ("requested", "takes"),
    [(0, 0), (3, 3), (16_383, 16_383), (16_384, 16_384), (16_385, 1), (20_000, 3_616), (-1, 16_383)],
)
def test_a_long_delay_loses_its_upper_bits(requested: int, takes: int) -> None:
    assert waited(requested) == takes


@every(
    ("left", "right", "found"),
    [
        (1, 3, b"bc"),
        (3, 1, b"bc"),
        (0, -1, b"abcd"),
        (-1, 2, b"cd"),
        (4, -1, b""),
        (4, 6, b""),
        (2, 99, b"cd"),
    ],
)
def test_a_part_of_a_string_is_as_the_core_cuts_it(left: int, right: int, found: bytes) -> None:
    assert substring(b"abcd", left, right) == found
    assert substring(b"abcd\0e", left, right) == found.partition(b"\0")[0]


# Answers


@every(
    ("line", "stated", "after_ms"),
    [
        (b"TMhello\n", b"hello\n\r\n", 0),
        (b"SV3P90\n", b"Servo Done", 0),
        (b"SV9P90\n", b"Servo Done", 0),
        (b"WTS0.25\n", b"Done", 250),
        (b"WTS33\n", b"", None),  # -32536 ms, taken for 4,294,934,760
        (b"JFX22T1\n", b"F\r", 0),
        (b"JFX38T1\n", b"T\r", 0),
        (b"ONX50\n", b"Done", 0),
        (b"OFX38\n", b"Done", 0),
        (b"WON22\n", b"Done", 0),
        (b"WIN22\n", b"", None),
    ],
)
def test_each_command_states_what_is_published(line: bytes, stated: bytes, after_ms: int | None) -> None:
    bench = Bench()
    begun = bench.begun
    assert bench.ask(line, 3_600 * SECOND) == stated
    assert bench.busy == (after_ms is None)
    if after_ms is not None:
        assert bench.now - begun == after_ms * MILLISECOND


def test_an_input_that_is_waited_for_is_looked_at_ten_times_a_second() -> None:
    bench = Bench()
    begun = bench.begun
    assert bench.ask(b"WIN30\n", 3_050 * MILLISECOND) == b""
    bench.mega.pins.driven[30] = True
    assert bench.run(SECOND) == b"Done"
    assert bench.now - begun == 3_100 * MILLISECOND


def test_outputs_and_servos_do_what_they_are_reported() -> None:
    bench = Bench()
    levels = [bench.mega.pins.read(pin) for pin in range(38, 54)]
    assert levels == [1] * 8 + [0] * 8
    bench.ask(b"OFX38\nONX53\nSV0P0\nSV1P90\nSV2P200\nSV3P-5\nSV4P600\nSV5P9999\nSV8P1\n")
    assert [bench.mega.pins.read(pin) for pin in (38, 53)] == [0, 1]
    assert bench.sketch.servos == {0: 544, 1: 1_472, 2: 2_400, 3: 544, 4: 600, 5: 2_400}


def test_an_output_that_is_a_step_pin_makes_a_step() -> None:
    bench = Bench()
    bench.ask(b"ONX2\nONX2\nOFX2\nONX2\n")
    assert bench.moved() == [2, 0, 0, 0, 0, 0, 0]  # its direction pin is low from the beginning


@every(
    ("generation", "line", "stated"),
    [
        ("1.5", b"LLA0100S50\n", b"fail\n\r\n"),
        ("1.5", b"LLA00S50\n", b"pass\n\r\n"),
        ("1.5", b"JFX22T1\n", b"False\n\r\n"),
        ("1.5", b"JFX38T1\n", b"True\n\r\n"),
        ("1.5", b"TMhello\n", b""),
        ("1.5", b"ML0\n", b""),
        ("2.0", b"LLA0100S50\n", b"F\r"),
    ],
)
def test_generations_differ_in_rows(generation: str, line: bytes, stated: bytes) -> None:
    assert Bench(generation).ask(line) == stated
    assert FIRMWARES["1.5"].baud == 9_600


# Switches


def test_a_joint_goes_to_its_switch_and_21_pulses_further_and_it_is_stated_half_a_second_later() -> None:
    bench = Bench()
    bench.joints.places[0] = 321
    begun = bench.begun
    stated = bench.ask(b"LLA0400B00C00D00E00F00S50\n")
    assert stated == b"P\r"
    assert (bench.moved()[0], bench.joints.places[0], bench.joints.lost[0]) == (-321, 0, 0)
    turn = 60 + 800 + TURN_US
    assert bench.now - begun == 1_000 * (300 * turn + 21 * (1_600 + TURN_US)) + 500 * MILLISECOND


def test_too_few_steps_fail_and_are_overdriven_all_the_same() -> None:
    bench = Bench()
    assert bench.ask(b"LLA0200B00C00D00E00F00S50\n") == b"F\r"
    assert bench.moved()[0] == -221


def test_an_open_wire_reads_as_reached_and_all_commanded_joints_are_overdriven() -> None:
    bench = Bench()
    bench.joints.open_switches.add(3)
    assert bench.ask(b"LLA07700D07700S50\n") == b"P\r"
    assert bench.moved() == [-7_600, 0, 0, -21, 0, 0, 0]


def calibrated(bench: Bench) -> list[int]:
    """Calibrate as the GUI does: to the switches, back by 500 steps, slowly again; return its counters."""
    whole = [axis.steps for axis in JOINTS]
    digits = [int(axis.switch_at_most) for axis in JOINTS]
    assert bench.ask(wire.switches(whole, digits, 50)) == b"P\r"
    back = [500 if not digit else -500 for digit in digits]
    assert bench.ask(wire.move(back, 15, up=(10, 10), down=(10, 10))) == b"command recieved"
    assert bench.ask(wire.switches(whole, digits, 8)) == b"P\r"
    return [axis.steps if axis.switch_at_most else 0 for axis in JOINTS]


def test_the_guis_calibration_ends_where_its_counters_say() -> None:
    bench = Bench(load=weight)
    bench.joints.places[:6] = [50, 300, 7_700, 90, 150, 6_600]
    assert calibrated(bench) == bench.joints.places[:6]
    assert bench.joints.lost == [0] * 7


@pytest.mark.long(beside="test_the_guis_calibration_ends_where_its_counters_say")
def test_from_anywhere_the_guis_calibration_leads_to_rest() -> None:
    bench = Bench(load=weight)
    bench.joints.places[:6] = [5_000, 3_000, 2_000, 9_000, 1_500, 4_000]
    to_rest = [axis.rest - count for axis, count in zip(JOINTS, calibrated(bench), strict=True)]
    bench.ask(wire.move(to_rest, 25, up=(10, 10), down=(10, 10)))
    assert bench.joints.places[:6] == [axis.rest for axis in JOINTS]
    assert bench.joints.lost == [0] * 7
    assert bench.joints.angles == pytest.approx((0.0, -90.013, 1.0, 0.0, -0.023, -0.023), abs=1e-3)


def test_the_hosts_lines_are_those_that_are_published() -> None:
    assert wire.move([500, -200, 1000], 25, up=(15, 10), down=(20, 5)) == SEVERAL
    assert wire.switches([400, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1], 50) == b"LLA0400B00C00D00E00F11S50\n"


@every(
    ("steps", "speed", "begin", "why"),
    [
        ((), 25.0, 100, "up to 7 axes"),
        ((40_000,), 25.0, 100, "up to 32767 steps"),
        ((1,), 0.0, 100, "divides"),
        ((1,), 25.0, 0, "divides"),
    ],
)
def test_the_hosts_end_refuses_what_the_board_would_take_for_something_else(
    steps: tuple[int, ...], speed: float, begin: int, why: str
) -> None:
    with pytest.raises(ValueError, match=why):
        wire.move(steps, speed, up=(0, begin))


# Points


def test_the_guis_points_lose_their_first_and_stay_in_the_table() -> None:
    bench = Bench()
    point = "MJA1{:02}S25G10H10I10K10"
    lines = "ML3" + "\n".join(point.format(it) for it in (40, 1, 2, 3)) + "\n"
    assert bench.ask(lines.encode()) == b"num points recieved012waypts done"
    assert bench.moved()[0] == 1 + 2 + 3
    assert bench.span_us() == 5 * (400 * 4 // 6 + TURN_US)
    # One more than requested: 2 + 2 new ones, and the third of before.
    two = b"ML2\n" + 2 * (point.format(10).encode() + b"\n")
    assert bench.ask(two) == b"num points recieved01waypts done"
    assert bench.moved()[0] == 10 + 10 + 3
    # And that one's text is in front of the next line.
    assert bench.ask(b"TMhello\n") == b"command recieved"
    assert bench.moved()[0] == 3


def test_a_point_has_49_characters_and_the_track_ends_the_board() -> None:
    bench = Bench()
    line = b"MJA1" + 44 * b"0" + b"123S25G\n"
    assert bench.ask(b"ML1\n" + line) == b"num points recieved0waypts done"
    assert bench.moved()[0] == 1
    assert bench.ask(b"\nML1\nMJA15T11S25\n") == b"num points recieved0waypts done"
    assert bench.moved() == [5, 0, 0, 0, 0, 0, 0]
    assert bench.busy
    assert bench.ask(b"TMhello\n") == b""


# Steps that are lost


def test_a_motor_that_is_too_fast_or_too_heavily_loaded_loses_steps_in_silence() -> None:
    fast = Bench()
    assert fast.ask(b"MJA1500S100G10H10I10K10\n") == b"command recieved"
    assert fast.joints.lost[0] > 300
    assert fast.joints.places[0] == 7_600 + 500 - fast.joints.lost[0]
    for load, lost in ((weightless, False), (lambda _: (0.0, -18.0, 0.0, 0.0, 0.0, 0.0), True)):
        slow = Bench(load=load)
        slow.ask(b"MJB0500S50G10H10I10K10\n")
        assert (slow.joints.lost[1] > 100) is lost
        slow.ask(b"MJB1500S50G10H10I10K10\n")  # with the weight
        assert slow.joints.pulses[1] == 1_000
        assert slow.joints.places[1] == 2_322 + slow.joints.lost[1]


def test_without_current_and_at_a_stop_no_step_is_done() -> None:
    bench = Bench()
    bench.joints.powered = False
    bench.ask(ONE)
    assert (bench.joints.places[0], bench.joints.lost[0]) == (7_600, 500)
    bench.joints.powered = True
    bench.joints.places[0] = 100
    bench.ask(ONE)
    assert bench.joints.places[0] == -21


def test_the_weight_at_the_joints_is_that_of_a_stretched_arm() -> None:
    shoulder = 2.5 * 0.1525 + 2.0 * 0.305 + 1.0 * 0.416315 + 0.5 * 0.52763 + 0.3 * 0.545755
    elbow = 1.0 * 0.111315 + 0.5 * 0.22263 + 0.3 * 0.240755
    meant = (0.0, -9.81 * shoulder, -9.81 * elbow, 0.0, -9.81 * 0.3 * 0.018125, 0.0)
    assert weight((0.0,) * 6) == pytest.approx(meant, abs=1e-6)
    upright = weight((0.0, -90.0, 1.0, 0.0, 0.0, 0.0))
    assert max(map(abs, upright)) < 0.1
    turned = weight((77.0, -40.0, 30.0, 10.0, 20.0, -30.0))
    assert turned == pytest.approx(weight((0.0, -40.0, 30.0, 10.0, 20.0, -30.0)))


# On USB


def test_on_usb_a_client_that_opens_it_resets_the_board_and_a_move_ends_where_it_is() -> None:
    board = Ar2Board(FIRMWARES["2.0"], Joints(weightless))
    board.wake(0)
    board.wake(2 * SECOND)
    board.receive(Packet(SERIAL, 0, ONE), 2 * SECOND)
    sent = board.wake(2 * SECOND + 300 * MILLISECOND).sent
    assert b"".join(it.payload for it in sent) == b"command recieved"
    place = board.joints.places[0]
    assert 7_100 < place < 7_600
    board.receive(Packet(SERIAL, DTR_UP, b""), 2 * SECOND + 300 * MILLISECOND)
    board.advance(10 * SECOND)
    assert board.joints.places[0] == place
    board.receive(Packet(SERIAL, 0, ONE), 10 * SECOND)
    board.hang(11 * SECOND)
    held = board.joints.places[0]
    board.advance(20 * SECOND)
    assert board.joints.places[0] == held < place
