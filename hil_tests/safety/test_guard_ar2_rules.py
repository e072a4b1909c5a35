"""The guard's rules for an arm's board, number by number: times, counts, and what ends a move.

The times are those of the board's sketch: each pulse 20 ms at 1 %, shared by the joints that move; a turn of
its loop 0.1 ms, two at most for a step of the longest joint; the first pulse of each joint twice as long.
"""

import math

import pytest

from firmware_bridge.families.ar2 import wire as words
from firmware_bridge.families.ar2.guard import Ar2Rules, GuardedJoint, move_of
from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Link
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find

ARM = "arm"
ROBOT = find("ar2")


def rules_of(robot: AnyRobot = ROBOT, places: int | None = 100) -> Ar2Rules:
    """Return the rules, with all joints' places confirmed there."""
    rules = Ar2Rules(robot, ARM)
    for joint in rules.axes:
        assert isinstance(joint, GuardedJoint)
        if places is not None:
            assert refuses(rules, words.test(words.place(joint.number, places))) is None
            sends(rules, words.test(words.place(joint.number, places)))
    return rules


def joints(rules: Ar2Rules) -> list[GuardedJoint]:
    return [joint for joint in rules.axes if isinstance(joint, GuardedJoint)]


def line(data: bytes, address: int = 0) -> Packet:
    return Packet(ARM, address, data)


def refuses(rules: Ar2Rules, data: bytes, address: int = 0) -> str | None:
    return rules.refuses(line(data, address), 0)


def sends(rules: Ar2Rules, data: bytes, address: int = 0) -> None:
    rules.sends(line(data, address), 0, requested=False)


def receives(rules: Ar2Rules, data: bytes, address: int = 0) -> None:
    assert rules.receives(line(data, address), 0) is True


def proven(rules: Ar2Rules, word: str) -> None:
    """Have the newest word echoed."""
    sends(rules, words.test(word))
    receives(rules, words.echo(word))


def move(*steps: int, percent: float = 10.0) -> bytes:
    return words.move((*steps, *(0,) * (6 - len(steps))), percent)


@pytest.mark.parametrize(
    ("steps", "percent", "pulse_ms", "lasts_ms"),
    [
        ((1, 0, 0, 0, 0, 0), 10.0, 2.0, 4.2),
        ((5, -5, 0, 0, 0, 0), 10.0, 1.0, 13.0),
        ((0, 0, -12, 0, 0, 4), 5.0, 2.0, 38.4),
        ((3, 3, 3, 3, 3, 3), 10.0, 1.0 / 3.0, 8.6),
        ((0, 0, 0, 0, 0, 0), 20.0, 1.0, 0.0),
    ],
)
def test_a_move_lasts_as_long_as_the_sketch_takes(
    steps: tuple[int, ...], percent: float, pulse_ms: float, lasts_ms: float
) -> None:
    read = move_of(words.move(steps, percent))
    assert read is not None
    assert read.steps == steps
    assert read.pulse_ms == pytest.approx(pulse_ms)
    assert read.lasts_ms == pytest.approx(lasts_ms)


@pytest.mark.parametrize(("percent", "good"), [(1.3, True), (1.299, False), (71.4, True), (71.5, False)])
def test_a_pulse_is_neither_longer_nor_shorter_than_the_sketch_can(percent: float, *, good: bool) -> None:
    refusal = refuses(rules_of(), move(1, percent=percent))
    assert (refusal is None) is good
    assert good or "a move with a pulse of" in str(refusal)


def with_moves_of(milliseconds: int) -> AnyRobot:
    table = ROBOT.links[ARM].model_copy(update={"move_ms": milliseconds})
    return ROBOT.model_copy(update={"links": {**ROBOT.links, ARM: table}})


@pytest.mark.parametrize(
    ("move_ms", "percent", "steps", "good"),
    [(24, 10.0, 10, True), (24, 10.0, 11, False), (500, 4.0, 18, True), (500, 4.0, 20, False)],
)
def test_a_move_is_no_longer_than_the_file_states_and_never_longer_than_100_ms(
    move_ms: int, percent: float, steps: int, *, good: bool
) -> None:
    refusal = refuses(rules_of(with_moves_of(move_ms)), move(steps, percent=percent))
    assert (refusal is None) is good
    assert good or f"{min(move_ms, 100)} are allowed" in str(refusal)


@pytest.mark.parametrize("number", range(1, 7))
@pytest.mark.parametrize("sign", [1, -1])
def test_no_joint_goes_further_in_a_move_than_its_top_speed_allows(number: int, sign: int) -> None:
    """Its steps in one cycle of the arm, and one for rounding."""
    axis = next(it for it in ROBOT.axes if Ar2Axis.of(it).joint == number)
    cycle_s = ROBOT.cycle * Ar2Link.of_link(ROBOT, ARM).every / 1e9
    most = math.floor(axis.top_speed * 400 * abs(axis.ratio) / math.tau * cycle_s) + 1
    rules = rules_of(places=500)
    before = (0,) * (number - 1)
    for steps, good in ((most, True), (most + 1, False)):
        refusal = refuses(rules, move(*before, sign * steps, percent=40.0))
        assert (refusal is None or "at once" not in refusal) is good, refusal


def test_the_guard_counts_every_step_that_leaves() -> None:
    rules = rules_of(places=30)
    for number in range(4):
        assert refuses(rules, move(-5, 5, percent=20.0)) is None
        sends(rules, move(-5, 5, percent=20.0))
        assert [joint.place for joint in joints(rules)[:3]] == [25 - 5 * number, 35 + 5 * number, 30]
        proven(rules, f"q{number}")
    assert refuses(rules, move(-11, percent=20.0)) == (
        "joint J1 (waist): to -1 steps, its travel is 0 to 15200"
    )
    assert refuses(rules, move(-10, percent=20.0)) is None


def test_who_moves_is_known_until_the_end_of_the_move_is_proved() -> None:
    rules = rules_of()
    assert not any(joint.moving or joint.powered for joint in joints(rules))
    requested = rules.requested_by(line(move(0, 3, 0, -3)))
    assert {Ar2Axis.of(joint.axis).joint for joint, one in requested.items() if one.moves} == {2, 4}
    assert {one.speed for one in requested.values()} == {0.0}
    sends(rules, move(0, 3, 0, -3))
    assert [joint.powered for joint in joints(rules)] == [False, True, False, True, False, False]
    proven(rules, "q1")
    assert not any(joint.powered for joint in joints(rules))
    assert [joint.place for joint in joints(rules)] == [100, 103, 100, 97, 100, 100], "nothing is forgotten"


def test_an_echo_of_before_the_move_proves_nothing() -> None:
    rules = rules_of()
    proven(rules, "q1")
    sends(rules, move(3))
    sends(rules, words.test("q1"))
    receives(rules, b"x")
    assert "was proved" in str(refuses(rules, move(3)))
    receives(rules, words.echo("q1"))
    assert refuses(rules, move(3)) is None


def test_what_a_board_states_before_it_is_requested_is_let_in() -> None:
    rules = Ar2Rules(ROBOT, ARM)
    receives(rules, b"anything")
    assert not rules.waiting


@pytest.mark.parametrize("address", [LINE_LOST, LINE_BACK])
def test_only_the_line_itself_states_that_it_is_gone(address: int) -> None:
    rules = rules_of()
    receives(rules, b"more", address)
    assert [joint.place for joint in joints(rules)] == [100] * 6
    receives(rules, b"", address)
    assert [joint.place for joint in joints(rules)] == [None] * 6


def test_a_line_that_is_lost_ends_the_move() -> None:
    rules = rules_of()
    sends(rules, move(3, 0, 0, 0, 0, 3))
    receives(rules, b"", LINE_LOST)
    assert not any(joint.powered for joint in joints(rules))
    assert refuses(rules, words.test(words.place(1, 50))) is None


@pytest.mark.parametrize("address", [DTR_UP, DTR_DOWN])
def test_the_boards_reset_line_carries_no_words(address: int) -> None:
    rules = rules_of()
    assert refuses(rules, b"", address) is None
    assert refuses(rules, b"TMq1\n", address) == f"address {address} is none of a line's"
    sends(rules, b"", address)
    assert [joint.place for joint in joints(rules)] == [None] * 6


def test_a_line_has_one_address() -> None:
    assert refuses(rules_of(), b"TMq1\n", 7) == "address 7 is none of a line's"
    assert refuses(rules_of(), move(3), 7) == "address 7 is none of a line's"
    assert not any(one.moves for one in rules_of().requested_by(line(move(3), 7)).values())


@pytest.mark.parametrize(
    ("data", "address", "of_all"),
    [
        (b"TMq1\n", 0, True),
        (b"TMhalt\n", 0, True),
        (move(3), 0, True),
        (b"TMq1\n", 1, False),
        (move(3), 1, False),
        (words.test("A50"), 0, False),
        (b"LLA0200\n", 0, False),
    ],
)
def test_a_question_and_a_move_are_words_to_all_joints(data: bytes, address: int, *, of_all: bool) -> None:
    rules = rules_of()
    assert rules.axes_of(line(data, address)) == (rules.axes if of_all else ())


def test_a_joint_that_is_no_axis_is_not_moved_and_not_stated_to_stand_anywhere() -> None:
    robot = ROBOT.model_copy(update={"axes": ROBOT.axes[:5]})
    rules = rules_of(robot)
    assert refuses(rules, words.test("F50")) == "no axis is joint J6"
    assert refuses(rules, move(0, 0, 0, 0, 0, 3)) == (
        "joint J6 is no axis of this robot, and moves by 3 steps"
    )
    assert refuses(rules, move(1, 1, 1, 1, 1, 0)) is None


def test_what_other_axes_must_know_of_a_joint() -> None:
    joint = joints(rules_of())[0]
    assert (joint.homes, joint.homes_within_s, joint.speed) == (False, 0.0, 0.0)
    assert joint.commanded_at < -1_000_000 * 10**9, "nothing was sent yet"
    assert joint.cycle == ROBOT.cycle * Ar2Link.of_link(ROBOT, ARM).every


def test_a_joint_moves_though_no_one_has_stated_where_the_others_stand() -> None:
    rules = rules_of(places=None)
    sends(rules, words.test(words.place(1, 100)))
    for number in range(3):
        assert refuses(rules, move(5)) is None
        sends(rules, move(5))
        assert [joint.powered for joint in joints(rules)] == [True, *[False] * 5]
        proven(rules, f"q{number}")
        assert not any(joint.powered for joint in joints(rules))
    assert [joint.place for joint in joints(rules)] == [115, *[None] * 5]
    assert "its position is not" in str(refuses(rules, move(5, 5)))


@pytest.mark.parametrize("rounds", [1, 2, 3])
def test_an_older_echo_never_proves_a_newer_move(rounds: int) -> None:
    rules = rules_of()
    for _ in range(rounds):
        proven(rules, "q1")
        sends(rules, move(3))
        sends(rules, words.test("q1"))
        receives(rules, b"x")
        assert "was proved" in str(refuses(rules, move(3)))
        receives(rules, words.echo("q1"))


def test_an_echo_that_only_ends_like_it_proves_nothing() -> None:
    rules = rules_of()
    sends(rules, move(3))
    sends(rules, words.test("q12"))
    receives(rules, words.echo("q112"))
    assert "was proved" in str(refuses(rules, move(3)))


def test_a_packet_without_bytes_is_no_loss() -> None:
    rules = rules_of()
    receives(rules, b"")
    assert [joint.place for joint in joints(rules)] == [100] * 6


def test_a_line_that_is_served_each_second_cycle_has_twice_the_time() -> None:
    table = ROBOT.links[ARM].model_copy(update={"every": 2})
    slower = rules_of(ROBOT.model_copy(update={"links": {**ROBOT.links, ARM: table}}))
    for joint, usual in zip(joints(slower), joints(rules_of()), strict=True):
        assert joint.cycle == 2 * usual.cycle
        assert joint.at_once - 1 == pytest.approx(2 * (usual.at_once - 1), abs=2)


def test_a_joint_that_counts_the_other_way_round_goes_as_far() -> None:
    axes = tuple(axis.model_copy(update={"direction": -axis.direction}) for axis in ROBOT.axes)
    mirrored = Ar2Rules(ROBOT.model_copy(update={"axes": axes}), ARM)
    assert [joint.at_once for joint in joints(mirrored)] == [joint.at_once for joint in joints(rules_of())]
