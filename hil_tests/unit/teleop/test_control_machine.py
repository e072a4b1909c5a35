"""Several stations in any order of words and silences: one drives, and no one else moves anything."""

from __future__ import annotations

from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from firmware_bridge.intent import Arm, ChangeDriver, Disarm, EmergencyStop
from firmware_bridge.teleop.incoming import Sender
from firmware_bridge.teleop.stations import LAPSES_AFTER
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.teleop.bench import acks, rars
from hil_tests.unit.teleop.stations import ARM, CLEAR, CONTROL, FORCE, PAUSE, RELAY, STOP, Hand

STATIONS = st.integers(0, 3)
PLACES = ((1 << 16, 255, 190), (2 << 16, 255, 190), (1 << 16, 254, 190), (1 << 16, 255, 191))
WORDS = [
    (PAUSE, (0.0,)),
    (PAUSE, (1.0,)),
    (CLEAR, (1.0,)),
    (ARM, (0.0,)),
    (RELAY, (1.0, 1.0)),
    (176, (1.0, 0.0)),
]
STOPS = [(STOP, (1.0,)), (CLEAR, (0.0,)), (ARM, (0.0, FORCE))]


class Ownership(RuleBasedStateMachine):
    """The model: the station in control, its consent to yield, and its last message."""

    @initialize()
    def begin(self) -> None:
        self.bench = rars()
        self.hands = [Hand(self.bench, *place) for place in PLACES]
        self.driver: int | None = None
        self.yields = False
        self.received_at = 0
        self.answered_at: dict[int, int] = {}
        """Times at which a stop of a station that was not in control was answered."""

    def received(self, who: int) -> bool:
        """Note that a station speaks; return whether it may drive."""
        if who == self.driver:
            self.received_at = self.bench.now
        self.bench.requested.clear()
        return self.driver in (None, who)

    def taken(self, who: int, *, yields: bool) -> None:
        self.driver, self.yields, self.received_at = who, yields, self.bench.now

    @rule(who=STATIONS, x=st.integers(-1000, 1000), buttons=st.sampled_from([0, 1, 2]))
    def sticks(self, who: int, x: int, buttons: int) -> None:
        before, may = self.bench.operator.intent, self.received(who)
        self.hands[who].stick(x, buttons=buttons)
        assert (self.bench.operator.intent is not before) is may
        assert self.bench.requested == []

    @rule(who=STATIONS)
    def arms(self, who: int) -> None:
        may = self.received(who)
        accepted = self.hands[who].result(ARM, 1.0) == 0
        assert accepted is may
        assert self.bench.requested == ([Arm()] if may else [])
        if may and self.driver is None:
            self.taken(who, yields=False)

    @rule(who=STATIONS, word=st.sampled_from(WORDS))
    def states(self, who: int, word: tuple[int, tuple[float, ...]]) -> None:
        before, may = self.bench.operator.intent, self.received(who)
        assert (self.hands[who].result(word[0], *word[1]) == 0) is may
        if not may:
            assert self.bench.requested == []
            assert self.bench.operator.intent is before

    @rule(who=STATIONS, word=st.sampled_from(STOPS))
    def stops(self, who: int, word: tuple[int, tuple[float, ...]]) -> None:
        may = self.received(who)
        answers = acks(self.hands[who].order(word[0], *word[1]))
        now = self.bench.now
        if may or now - self.answered_at.get(who, -SECOND) >= SECOND:
            assert answers == [(word[0], 0)]
            self.answered_at |= {} if may else {who: now}
        else:
            assert answers == []
        [requested] = self.bench.requested
        assert isinstance(requested, EmergencyStop | Disarm)
        assert may or requested == EmergencyStop()

    @rule(who=STATIONS, yields=st.booleans())
    def requests_for_control(self, who: int, *, yields: bool) -> None:
        may = self.received(who) or self.yields
        changes = may and self.driver != who
        assert (self.hands[who].result(CONTROL, 1.0, float(yields)) == 0) is may
        assert self.bench.requested == ([ChangeDriver()] if changes else [])
        if may:
            self.taken(who, yields=yields)

    @rule(who=STATIONS)
    def gives_up(self, who: int) -> None:
        self.received(who)
        mine = self.driver == who
        assert (self.hands[who].result(CONTROL, 0.0) == 0) is mine
        if mine:
            assert Disarm() in self.bench.requested
            self.driver, self.yields = None, False

    @rule(passes=st.integers(1, 12_000))
    def time(self, passes: int) -> None:
        self.bench.now += passes * MILLISECOND
        gone = self.driver is not None and self.bench.now - self.received_at >= LAPSES_AFTER
        assert self.bench.operator.lapse(self.bench.now) is gone
        if gone:
            self.driver, self.yields = None, False

    @invariant()
    def the_model_is_right(self) -> None:
        expected: Any = None if self.driver is None else Sender(*PLACES[self.driver])
        assert self.bench.operator.driver == expected


Ownership.TestCase.settings = settings(max_examples=examples(150), stateful_step_count=40)
TestOwnership = Ownership.TestCase
