"""Any frames of a bridge at any time: only admissible ones leave, and never power by a safe frame."""

import struct
from typing import Final

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from firmware_bridge.families.epos2.guard.product import can_rules
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot import CommandForm
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.lanes import examples
from hil_tests.safety.guard_bench import LINK, Bench

ROBOT: Final = find("rars")
RULES: Final = can_rules(ROBOT, LINK)
IDENTIFIERS: Final = st.sampled_from([*RULES.listed, 0x503, 0x404, 0x605, 0x123]) | st.integers(0, 2**32 - 1)
WORDS: Final = st.sampled_from([0x0006, 0x0007, 0x000F, 0x003F, 0x010F, 0x0080, 0x000B, 0x0000, 0x001F])
TARGETS: Final = st.sampled_from(
    [0, 1, -1, 500, 3972, 3973, -3973, 134_953, 134_954, 2_890_879]
) | st.integers(-(2**31), 2**31 - 1)
SET_POINTS: Final = st.builds(
    lambda address, word, target: Packet(LINK, address, struct.pack("<Hi", word, target)),
    st.sampled_from([0x501, 0x502, 0x403, 0x404]),
    WORDS,
    TARGETS,
)
REQUESTS: Final = st.builds(
    lambda node, head, rest: Packet(LINK, 0x600 + node, head + rest),
    st.integers(0, 5),
    st.sampled_from(
        [
            bytes.fromhex(text)
            for text in ("23161001", "2b406000", "23ff6000", "40416000", "238360", "2f606000")
        ]
    ),
    st.binary(max_size=4),
)
NETWORK: Final = st.builds(
    lambda command, node: Packet(LINK, 0x000, bytes((command, node))),
    st.sampled_from([0x01, 0x02, 0x80, 0x81, 0x82]),
    st.integers(0, 5),
)
ANYTHING: Final = st.builds(
    Packet, st.sampled_from([LINK, OPERATOR, "serial"]), IDENTIFIERS, st.binary(max_size=9)
)
SPEECH: Final = st.lists(SET_POINTS | SET_POINTS | REQUESTS | NETWORK | ANYTHING, max_size=6)
NODE_OF: Final = {0x501: 1, 0x502: 2, 0x403: 3, 0x404: 4}
COMMAND_OF: Final = {Epos2Axis.of(axis).node: axis.command for axis in ROBOT.axes}


class AnySpeech(RuleBasedStateMachine):
    """A bridge that sends anything, and four drives that only remember if they have power and move."""

    def __init__(self) -> None:
        super().__init__()
        self.bench = Bench(ROBOT)
        self.now = 0
        self.refused = 0
        self.power = dict.fromkeys(COMMAND_OF, False)
        self.moves = dict.fromkeys(COMMAND_OF, False)
        self.off_since = dict.fromkeys(COMMAND_OF, NEVER)
        """Since when the word in force has been the one that takes the power."""
        self.goal = dict.fromkeys(COMMAND_OF, False)
        """True if a position was sent since the power came on."""

    @rule(stated=SPEECH, ms=st.sampled_from([0, 1, 49, 50, 149, 150, 400]))
    def the_bridge_speaks(self, stated: list[Packet], ms: int) -> None:
        self.now += ms * MILLISECOND
        self.receive(self.bench.states(*stated, now=self.now), stated)

    @rule(ms=st.sampled_from([0, 1, 49, 50, 100, 150]))
    def the_bridge_is_silent(self, ms: int) -> None:
        self.now += ms * MILLISECOND
        self.receive(self.bench.states(now=self.now), [])

    @rule()
    def the_guard_is_woken_when_it_wants(self) -> None:
        deadline = self.bench.guard.wake(self.now).wake_at
        if deadline != NEVER:
            assert deadline > self.now
            self.now = deadline
            self.receive(self.bench.states(now=self.now), [])

    def receive(self, sent: tuple[Packet, ...], stated: list[Packet]) -> None:
        """Check what left, and let the drives obey it."""
        texts = [packet for packet in stated if packet.link == OPERATOR]
        assert [packet for packet in sent if packet.link == OPERATOR] == texts
        for packet in sent:
            if packet.link == OPERATOR:
                continue
            assert packet.link == LINK
            # A drive's confirmations are judged by the guard that receives them; here no drive answers.
            assert packet.payload[:1] == b"\x81" or RULES.refuses(packet, self.now) is None
            if packet.address in NODE_OF:
                self.obey(packet, stated)
            elif packet.address == 0:
                self.leave(packet.payload[0], packet.payload[1])
            else:
                self.write(packet.address & 0x7F, packet.payload)

    def leave(self, command: int, addressed: int) -> None:
        """Take a network command: after all but the start a drive receives nothing."""
        for node in COMMAND_OF if addressed == 0 else (addressed,):
            if command != 1:
                assert not self.moves[node]
                assert command != 0x81 or self.now >= self.off_since[node] + 200 * MILLISECOND
                self.off_since[node] = NEVER
                self.power[node] = self.goal[node] = False

    def write(self, node: int, payload: bytes) -> None:
        """Take an SDO request, or a frame that drives do not mind."""
        assert payload != bytes.fromhex("2316100100000000"), "no drive has reported that it has no power"
        if payload[:3] == b"\x2b\x40\x60":
            self.words(node, int.from_bytes(payload[4:6], "little"))
            self.power[node] = self.moves[node] = self.goal[node] = False

    def words(self, node: int, word: int) -> None:
        """Keep since when the power was to go."""
        if word != 0:
            self.off_since[node] = NEVER
        elif self.off_since[node] == NEVER:
            self.off_since[node] = self.now

    def obey(self, packet: Packet, stated: list[Packet]) -> None:
        """Take a set-point as a drive does."""
        node = NODE_OF[packet.address]
        word, target = struct.unpack("<Hi", packet.payload)
        self.words(node, word)
        power = word in {0x000F, 0x003F, 0x010F}
        drives = word == 0x000F and target != 0
        self.goal[node] = word == 0x003F or (power and self.goal[node])
        goes = self.goal[node] and word in {0x000F, 0x003F}
        moves = drives if COMMAND_OF[node] is CommandForm.SPEED else goes
        if packet not in stated:
            assert not moves
            assert power == self.power[node]
        self.power[node] = power
        self.moves[node] = moves

    @invariant()
    def refusals_are_reported_and_counted(self) -> None:
        guard = self.bench.guard
        assert guard.refused == len(self.bench.refusals) >= self.refused
        assert all(refusal.reason for refusal in guard.refusals)
        self.refused = guard.refused


TestAnySpeech = pytest.mark.timeout(60)(AnySpeech.TestCase)
AnySpeech.TestCase.settings = settings(max_examples=examples(100), stateful_step_count=25, derandomize=True)
