"""Any commands at any time: sums stay within their bounds, sides apart; and honesty is not punished."""

import struct
from typing import Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.lanes import examples
from hil_tests.safety.guard_bench import Bench, position, wheel
from hil_tests.safety.guard_robots import RARS
from hil_tests.safety.sums_bench import CYCLE, ENABLE, ROBOTS, TOP, Motors, as_far_as_allowed, speed

HALT, GO, OFF, SHUTDOWN = 0x010F, 0x003F, 0x0000, 0x0006


@st.composite
def frames(draw: st.DrawFn, robot: AnyRobot) -> tuple[Nanoseconds, list[Packet]]:
    after = draw(st.sampled_from([0, 1, 7, 20, 25, 49, 50, 51, 100]))
    stated = st.builds(
        speed,
        st.sampled_from([Epos2Axis.of(axis).node for axis in robot.axes]),
        st.sampled_from([0, 200, 600, 900, TOP, -TOP, -600, TOP + 1]) | st.integers(-TOP, TOP),
        st.sampled_from([ENABLE, ENABLE, ENABLE, ENABLE, 0x010F, 0x0006]),
    )
    return after * MILLISECOND, draw(st.lists(stated, min_size=1, max_size=4))


@pytest.mark.parametrize("robot", ROBOTS, ids=["pair", "omni"])
@settings(max_examples=examples(60))
@given(data=st.data())
def test_whatever_is_sent_no_sum_stays_beyond_its_bound(robot: AnyRobot, data: st.DataObject) -> None:
    """For a cycle at most, and over any length of time by no more than two cycles' way at top speed."""
    bench, motors = Bench(robot), Motors(robot)
    for after, stated in data.draw(st.lists(frames(robot), max_size=20)):
        motors.lives(bench, motors.now + after, stated)


@st.composite
def honest(draw: st.DrawFn, robot: AnyRobot) -> tuple[list[Nanoseconds], list[list[int]]]:
    """Offsets in the cycle, one for each axis, and a vector for each cycle; all within the bounds."""
    one = st.sampled_from([0, 100, 400, 600, 800, TOP]) | st.integers(0, TOP)
    speeds = st.builds(lambda way, rpm: way * rpm, st.sampled_from([1, -1]), one)
    count = len(robot.axes)
    vectors = draw(st.lists(st.lists(speeds, min_size=count, max_size=count), max_size=30))
    offsets = draw(st.lists(st.integers(0, CYCLE - 1), min_size=count, max_size=count))
    return offsets, [as_far_as_allowed(robot, vector) for vector in vectors]


@pytest.mark.parametrize("robot", ROBOTS, ids=["pair", "omni"])
@settings(max_examples=examples(60))
@given(data=st.data())
def test_an_honest_bridge_is_never_refused(robot: AnyRobot, data: st.DataObject) -> None:
    """Vectors within the bounds, each axis at its own instant of every cycle, in whatever order."""
    offsets, vectors = data.draw(honest(robot))
    bench = Bench(robot)
    for cycle, vector in enumerate(vectors):
        for offset, node in sorted(zip(offsets, range(1, len(vector) + 1), strict=True)):
            now = cycle * CYCLE + offset
            assert bench.guard.wake(now - 1 if now else 0).sent == ()
            assert bench.states(speed(node, vector[node - 1]), now=now) == (speed(node, vector[node - 1]),)
    assert bench.guard.refused == 0


NODES: Final = {1: "wheels", 2: "wheels", 4: "lift"}
WORDS: Final = st.sampled_from([OFF, SHUTDOWN, ENABLE, ENABLE, GO, HALT, 0x000B])


class NeverBoth(RuleBasedStateMachine):
    """A bridge that sends anything to three drives, of which either two or one may be commanded to move."""

    def __init__(self) -> None:
        super().__init__()
        self.bench = Bench(RARS)
        self.now = 0
        self.moves = dict.fromkeys(NODES, False)
        self.goal = False

    @rule(node=st.sampled_from(sorted(NODES)), word=WORDS, aim=st.sampled_from([0, 1, -1, 500, 9999]))
    def speaks(self, node: int, word: int, aim: int) -> None:
        stated = (position if node == 4 else wheel)(node, word, aim)
        self.receive(stated, self.bench.states(stated, now=self.now))

    @rule(ms=st.sampled_from([1, 50, 150]))
    def is_silent(self, ms: int) -> None:
        self.now += ms * MILLISECOND
        self.receive(None, self.bench.states(now=self.now))

    def receive(self, stated: Packet | None, sent: tuple[Packet, ...]) -> None:
        for packet in sent:
            word, target = struct.unpack("<Hi", packet.payload)
            node = packet.address & 0x7F
            if node == 4:
                self.goal = word == GO or (self.goal and word in {ENABLE, HALT})
                self.moves[4] = self.goal and word != HALT
            elif node in NODES:
                self.moves[node] = word == ENABLE and target != 0
            assert packet is stated or not self.moves.get(node)

    @invariant()
    def one_side_at_most(self) -> None:
        assert len({NODES[node] for node, moves in self.moves.items() if moves}) <= 1


TestNeverBoth = pytest.mark.timeout(60)(NeverBoth.TestCase)
NeverBoth.TestCase.settings = settings(max_examples=examples(60), stateful_step_count=20)
