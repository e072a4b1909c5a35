"""Moves of an arm that the guard lets through: one short one at a time, in its travel, from a known place."""

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.ar2.axes import JOINTS
from firmware_bridge.families.ar2 import wire as words
from firmware_bridge.families.ar2.guard import HALT
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from hil_tests.lanes import examples
from hil_tests.safety.guard_bench import Bench
from hil_tests.unit.arduino.ar2_bench import Bench as Arm

ROBOT = find("ar2")
MIDDLE = tuple(axis.steps // 2 for axis in JOINTS)
QUESTION = words.test("q1")
STEP = words.move((5, -5, 0, 0, 0, 0), 10.0)


def line(data: bytes) -> Packet:
    return Packet("arm", 0, data)


class OnTheLine:
    """A guard with an arm's board behind it that has a mind of its own about when it answers."""

    def __init__(self) -> None:
        self.bench = Bench(ROBOT)

    def states(self, data: bytes) -> bool:
        """Send a line; return True if it has left as it is."""
        return self.bench.states(line(data)) == (line(data),)

    def refused(self, data: bytes) -> str:
        """Send a line that does not leave, and return the reason; a query leaves in its place."""
        before = len(self.bench.refusals)
        assert self.bench.states(line(data)) == (line(HALT),)
        assert len(self.bench.refusals) == before + 1
        return self.bench.refusals[-1].reason

    def echoes(self, data: bytes) -> None:
        self.bench.receives(line(data))

    def reported(self, steps: tuple[int, ...] = MIDDLE) -> "OnTheLine":
        """Send it the places of all joints."""
        for joint, place in enumerate(steps, 1):
            assert self.states(words.test(words.place(joint, place)))
        return self


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"MJA15B00C00D00E00F00T00S10G0H100I0K100", "is not listed"),
        (b"MJA15B00C00D00E00F00T05S10G0H100I0K100\n", "is not listed"),
        (b"MJA15B00C00D00E00F00T00S10G10H10I10K10\n", "is not listed"),
        (b"MJA15B00C00D00E00F00T00S10G0H100I0K100\nMJA1\n", "is not listed"),
        (b"MJA150000B00C00D00E00F00T00S10G0H100I0K100\n", "is not listed"),
        (b"LLA0200B00C00D00E00F00S50\n", "is not listed"),
        (b"ML1\n", "is not listed"),
        (b"ONX39\n", "is not listed"),
        (b"TMhello\n", "is not listed"),
        (b"", "is not listed"),
        (words.move((5, 0, 0, 0, 0, 0), 1.2), "a pulse of 16.7 ms at 1.2 %"),
        (words.move((5, 0, 0, 0, 0, 0), 100.0), "a pulse of 0.2 ms at 100 %"),
        (words.move((58, 0, 0, 0, 0, 0), 40.0), "joint J1 (waist): 58 steps at once, 21 are allowed"),
        (words.move((20, 0, 0, 0, 0, 0), 6.0), "a move of up to 74 ms, 72 are allowed"),
        (words.test("G5"), "is not listed"),
        (words.test("A15201"), "joint J1 (waist): 15201 steps are not within 0 to 15200"),
    ],
)
def test_what_is_not_listed_or_beyond_its_bound_does_not_leave(data: bytes, why: str) -> None:
    assert why in OnTheLine().reported().refused(data)


def test_a_joint_moves_once_someone_has_stated_where_it_stands() -> None:
    one = OnTheLine()
    assert "its position is not confirmed" in one.refused(STEP)
    assert one.reported().states(STEP)


@pytest.mark.parametrize(
    ("axis", "place", "sign"), [(it, end, sign) for it in range(6) for end, sign in ((0, -1), (1, 1))]
)
def test_no_joint_goes_beyond_its_travel(axis: int, place: int, sign: int) -> None:
    end = place * JOINTS[axis].steps
    places = (*MIDDLE[:axis], end, *MIDDLE[axis + 1 :])
    beyond = words.move(tuple(sign * (it == axis) for it in range(6)), 2.0)
    inwards = words.move(tuple(-sign * (it == axis) for it in range(6)), 2.0)
    assert "its travel is" in OnTheLine().reported(places).refused(beyond)
    assert OnTheLine().reported(places).states(inwards)


def test_one_move_is_under_way_until_what_was_stated_after_it_is_echoed() -> None:
    one = OnTheLine().reported()
    assert one.states(STEP)
    one.echoes(words.MOVING)
    assert "before the end of the one before was proved" in one.refused(STEP)
    assert "while the arm may move" in one.refused(words.test("A7000"))
    assert one.states(words.test("q8"))
    one.echoes(words.echo("q7"))
    assert "was proved" in one.refused(STEP)
    assert one.states(words.test("q9"))
    for byte in words.echo("q9"):
        one.echoes(bytes([byte]))
    assert one.states(STEP)


@pytest.mark.parametrize(
    "begins_again",
    [
        lambda one: one.bench.states(Packet("arm", DTR_DOWN, b""), Packet("arm", DTR_UP, b"")),
        lambda one: one.bench.receives(Packet("arm", LINE_LOST, b"")),
        lambda one: one.bench.receives(Packet("arm", LINE_BACK, b"")),
    ],
)
def test_a_board_that_begins_again_stands_no_one_knows_where(
    begins_again: Callable[[OnTheLine], object],
) -> None:
    one = OnTheLine().reported()
    assert one.states(STEP)
    begins_again(one)
    assert "its position is not confirmed" in one.refused(STEP)


steps = st.lists(st.integers(-90, 90), min_size=6, max_size=6)
stated = st.one_of(
    st.builds(words.move, steps, st.floats(1.0, 100.0)),
    st.builds(lambda text: words.test(f"q{text}"), st.integers(0, 99)),
    st.binary(max_size=60),
)


@settings(max_examples=examples(60))
@given(lines=st.lists(stated, max_size=30), begin=st.tuples(*(st.integers(0, axis.steps) for axis in JOINTS)))
def test_whatever_is_stated_the_arm_stays_in_its_travel(lines: list[bytes], begin: tuple[int, ...]) -> None:
    """Check it by the emulated board, which executes the moves that have left, and answers at once."""
    one, arm = OnTheLine().reported(begin), Arm()
    arm.joints.places[:6] = begin
    for data in lines:
        for packet in one.bench.states(line(data)):
            received = arm.ask(packet.payload)
            one.echoes(received)
            assert not any(arm.joints.lost), "no joint is driven into its stop"
        assert all(0 <= place <= axis.steps for place, axis in zip(arm.joints.places, JOINTS, strict=False))
