"""Any snapshots in any order: no speed under a stop, no limit passed, always a reason."""

import math
from typing import TYPE_CHECKING, Any, Final

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.drivers.driver import Power
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars.rules import tipping_speed
from firmware_bridge.units import MILLISECOND, NEVER, SECOND
from hil_tests.lanes import examples
from hil_tests.safety.gate_bench import Ruling, Snapshot, base_stopped, gate_of, lift_free, stated, well

if TYPE_CHECKING:
    from firmware_bridge.safety.snapshot import ActiveInterlock

ROBOT: Final = find("rars")
ANY: Final = st.floats(width=32) | st.sampled_from([0.0, 0.3, -0.5, 0.5, 0.501])
KNOWN: Final = st.none() | ANY | st.floats(-1.1, 1.1)
AGES: Final = st.sampled_from([0, 50, 249, 250, 251, 499, 500, 501, 5000]).map(lambda ms: ms * MILLISECOND)
HELD: Final = st.none() | AGES
INTENTS: Final = st.fixed_dictionaries(
    {
        "speed_mps": ANY,
        "steer_rad": ANY,
        "lift_m": KNOWN,
        "lift_rate_mps": ANY | st.just(0.0),
    }
)
DRIVES: Final = st.fixed_dictionaries(
    {
        "state": st.sampled_from([PowerState.OPERATION_ENABLED] * 8 + list(PowerState)) | st.none(),
        "age": AGES | st.just(0) | st.none(),
        "velocity": st.just(0.0) | ANY,
        "fault": st.sampled_from(["", "", "", "0x8611"]),
    }
)


class AnyOrder(RuleBasedStateMachine):
    """A gate that is shown anything."""

    def __init__(self) -> None:
        super().__init__()
        self.gate = gate_of(ROBOT)
        self.now = SECOND
        self.seen: Snapshot | None = None
        self.decision: Ruling | None = None
        self.before: dict[str, ActiveInterlock] = {}

    def look(self, **changes: Any) -> None:
        """Show one snapshot; what is not given is well."""
        if self.decision is not None:
            self.before = {event.name: event for event in self.decision.interlock_events}
        drives = changes.pop("drives", [{}] * len(ROBOT.axes))
        intent = {"received_at": self._received_at(changes.pop("age", 0)), **changes.pop("intent", {})}
        axes = {axis.name: self._drive(one) for axis, one in zip(ROBOT.axes, drives, strict=True)}
        self.seen = well(ROBOT, self.now, intent=intent, drives=axes, **changes)
        self.decision = self.gate.rule(self.seen)

    def _received_at(self, age: int | None) -> int:
        return NEVER_RECEIVED if age is None else self.now - age

    def _drive(self, fields: dict[str, Any]) -> dict[str, Any]:
        given = dict(fields)
        state = given.pop("state", PowerState.OPERATION_ENABLED)
        return {"received_at": self._received_at(given.pop("age", 0)), **stated(state), **given}

    @rule(ms=st.sampled_from([0, 1, 50, 199, 200, 300, 5000]))
    def time_passes(self, ms: int) -> None:
        self.now += ms * MILLISECOND

    @rule(intent=INTENTS, commanded=st.floats(-0.5, 0.5), steer=st.floats(-1.03, 1.03))
    def a_well_robot_is_looked_at(self, intent: dict[str, Any], commanded: float, steer: float) -> None:
        self.look(intent=intent, demanded_speed_mps=commanded, speed_mps=commanded, steer_rad=steer)

    @rule(intent=INTENTS, armed=st.booleans(), stop=st.booleans(), age=HELD, steer=KNOWN, lift=KNOWN)
    def an_unwell_robot_is_looked_at(
        self,
        *,
        intent: dict[str, Any],
        armed: bool,
        stop: bool,
        age: int | None,
        steer: float | None,
        lift: float | None,
    ) -> None:
        self.look(intent=intent, armed=armed, emergency_stopped=stop, age=age, steer_rad=steer, lift_m=lift)

    @rule(intent=INTENTS, drives=st.lists(DRIVES, min_size=4, max_size=4), speed=ANY)
    def unwell_drives_are_looked_at(
        self, intent: dict[str, Any], drives: list[dict[str, Any]], speed: float
    ) -> None:
        self.look(intent=intent, drives=drives, speed_mps=speed)

    @rule(lift=st.floats(0.0, 1.1), rate=st.sampled_from([0.0, 0.05]), speed=st.sampled_from([0.0, 0.2]))
    def the_lift_is_commanded(self, lift: float, rate: float, speed: float) -> None:
        self.look(intent={"lift_m": lift, "lift_rate_mps": rate, "speed_mps": speed})

    @invariant()
    def no_speed_while_a_stop_holds(self) -> None:
        if self.decision is None or self.seen is None:
            return
        if base_stopped(self.decision):
            assert self.decision.allowed.speed_mps == 0.0
            assert self.decision.interlock_events
        facts, body = self.seen.facts, self.seen.body
        unfit = not facts.armed or facts.emergency_stopped
        silent = self.now - facts.received_at >= 500 * MILLISECOND
        extended = body.lift_m is None or not body.lift_m <= 0.005
        broken = any(
            axis.power is not Power.ON or axis.fault or facts.now - axis.received_at >= 250 * MILLISECOND
            for axis in facts.axes.values()
        )
        if self.seen.facts.now == self.now and (unfit or silent or extended or broken):
            assert base_stopped(self.decision)
        if self.seen.facts.now == self.now and (unfit or silent or broken):
            assert not lift_free(self.decision)

    @invariant()
    def nothing_beyond_a_limit(self) -> None:
        if self.decision is None or self.seen is None:
            return
        decision = self.decision
        assert math.isfinite(decision.allowed.speed_mps)
        assert abs(decision.allowed.speed_mps) <= 0.5
        if not base_stopped(decision):
            assert self.seen.body.steer_rad is not None
            assert abs(decision.allowed.speed_mps) <= tipping_speed(ROBOT, self.seen.body.steer_rad)
            assert decision.allowed.steer_rad is not None
            assert abs(decision.allowed.steer_rad) <= math.atan(0.515 / 0.310) + 1e-9
        assert abs(decision.allowed.lift_rate_mps) <= 0.1
        assert decision.allowed.lift_m is None or 0.0 <= decision.allowed.lift_m <= 1.2

    @invariant()
    def lift_and_wheels_never_together(self) -> None:
        if self.decision is None or self.seen is None or self.decision.allowed.speed_mps == 0.0:
            return
        height = self.seen.body.lift_m
        moves = self.decision.allowed.lift_rate_mps != 0.0 and self.decision.allowed.lift_m is None
        goes = (
            self.decision.allowed.lift_m is not None
            and height is not None
            and abs(self.decision.allowed.lift_m - height) > 0.001
        )
        assert not moves
        assert not goes

    @invariant()
    def every_hold_has_its_reason_and_its_beginning(self) -> None:
        if self.decision is None or self.seen is None:
            return
        events = {event.name: event for event in self.decision.interlock_events}
        assert len(events) == len(self.decision.interlock_events)
        for name, event in events.items():
            assert event.reason
            assert event.remedy
            before = self.before.get(name)
            assert event == before or event.since == self.seen.facts.now

    @invariant()
    def a_deadline_lies_ahead(self) -> None:
        if self.seen is not None:
            deadline = self.gate.next_deadline(self.seen.facts)
            assert (
                deadline == NEVER or self.seen.facts.now < deadline <= self.seen.facts.now + 500 * MILLISECOND
            )


TestAnyOrder = pytest.mark.timeout(60)(AnyOrder.TestCase)
AnyOrder.TestCase.settings = settings(max_examples=examples(150), stateful_step_count=30, derandomize=True)
