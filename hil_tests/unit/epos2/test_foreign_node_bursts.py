"""100,000 frames of a foreign node, in every network state: no exception, the standard's answers, no
current in the winding where none may be.

`FOREIGN_FRAMES=10000000 pytest hil_tests/unit/epos2/test_foreign_node_bursts.py` is longer, with other seeds.
"""

import os

import pytest
from hypothesis import Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.unit.epos2.foreign_node import NODE, RARE, ForeignNode

BURST = 128
EXAMPLES = 90
STEPS = 30
SOME = 10_000
ENOUGH = 100_000


class Bursts(RuleBasedStateMachine):
    """Bursts of anything, and between them what leads to where a burst alone would seldom come."""

    frames = 0
    powered = 0
    off = 0
    aborts: set[int] = set()  # noqa: RUF012 - the count over all examples

    @initialize()
    def plug_in(self) -> None:
        self.foreign_node = ForeignNode()

    @rule(seed=st.integers(0, 1 << 30))
    def bursts(self, seed: int) -> None:
        self.foreign_node.bursts(seed, BURST)

    @rule(wait=st.integers(0, 40 * MILLISECOND))
    def waits(self, wait: Nanoseconds) -> None:
        self.foreign_node.waits(wait)

    @rule(seed=st.integers(0, 1 << 30))
    def enables_then_bursts(self, seed: int) -> None:
        foreign_node = self.foreign_node
        foreign_node.sends(0x000, bytes((0x01, NODE)))
        foreign_node.sends(0x600 + NODE, bytes.fromhex("2b02640001000000"))
        for word in (0x00, 0x80, 0x06, 0x0F):
            foreign_node.sends(0x600 + NODE, bytes((0x2B, 0x40, 0x60, 0, word, 0, 0, 0)))
            foreign_node.waits(MILLISECOND)
        foreign_node.bursts(seed, BURST)

    @rule(place=st.integers(0, 2), payload=st.binary(min_size=8, max_size=8))
    def disturbs(self, place: int, payload: bytes) -> None:
        address, _ = RARE[0](lambda below: place % below)
        self.foreign_node.sends(address, payload)

    def teardown(self) -> None:
        Bursts.frames += self.foreign_node.frames
        Bursts.powered += self.foreign_node.powered_frames
        Bursts.off += self.foreign_node.winding.off_frames
        Bursts.aborts |= self.foreign_node.aborts


@pytest.mark.timeout(0)
@pytest.mark.parametrize("enough", [SOME, pytest.param(ENOUGH, marks=pytest.mark.long)])
def test_whatever_a_foreign_node_sends_the_drive_stays_a_drive(enough: int) -> None:
    Bursts.frames, Bursts.powered, Bursts.off, Bursts.aborts = 0, 0, 0, set()
    wanted = int(os.environ.get("FOREIGN_FRAMES", "0")) if enough == ENOUGH else 0
    examples = max(EXAMPLES * enough // ENOUGH, EXAMPLES * wanted // ENOUGH)
    run_state_machine_as_test(
        Bursts,
        settings=settings(
            max_examples=examples,
            stateful_step_count=STEPS,
            deadline=None,
            derandomize=not wanted,
            database=None,
            phases=(Phase.generate,),
        ),
    )
    assert Bursts.frames >= max(enough, wanted)
    assert Bursts.powered > Bursts.frames // 20, "the motor was under power for a good part of it"
    assert Bursts.off > Bursts.frames // 20, "... and without it, with its winding watched"
    wanted_aborts = {AbortCode.NO_OBJECT, AbortCode.READ_ONLY, AbortCode.TOO_HIGH, AbortCode.UNKNOWN_COMMAND}
    assert wanted_aborts <= Bursts.aborts


def test_one_seed_is_one_story() -> None:
    stories = []
    for _ in range(2):
        foreign_node = ForeignNode()
        foreign_node.bursts(7, 500)
        stories.append(
            (
                foreign_node.now,
                foreign_node.axis.position,
                tuple(value for _, value in foreign_node.drive.store.numbers()),
            )
        )
    assert stories[0] == stories[1]
