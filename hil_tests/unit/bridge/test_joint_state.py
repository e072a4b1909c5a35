"""The table of the motion permission against an independent statement of its rules, state by state."""

from itertools import product
from typing import NamedTuple

import pytest

from firmware_bridge.bridge.joint_state import (
    FOR_GOOD,
    NO_POWER,
    OFF,
    STOPS,
    Event,
    Life,
    Motion,
    forbidden,
    successor,
)


class Rules(NamedTuple):
    """The rules once more, as flags."""

    armed: bool = False
    stopped: bool = False
    final: bool = False
    off: bool = False

    def after(self, event: Event) -> "Rules":
        free = not (self.stopped or self.off)
        return Rules(
            armed=(self.armed or (event is Event.ARM and free))
            and event not in {Event.DISARM, Event.STOP, Event.TERMINATE, Event.POWER_OFF},
            stopped=event in {Event.STOP, Event.TERMINATE}
            or (self.stopped and (self.final or event is not Event.RESET)),
            final=self.final or event is Event.TERMINATE,
            # No drive is given power while an emergency stop is latched.
            off=event is Event.POWER_OFF or (self.off and (self.stopped or event is not Event.ENABLE)),
        )


def rules_of(motion: Motion) -> Rules:
    return Rules(motion is Motion.ARMED, motion in STOPS, motion in FOR_GOOD, motion in OFF)


def test_each_state_is_one_combination_and_none_stands_twice() -> None:
    assert len({rules_of(motion) for motion in Motion}) == len(Motion)
    assert {one for one in Motion if rules_of(one).stopped or rules_of(one).off} == NO_POWER


@pytest.mark.parametrize(("motion", "event"), [*product(Motion, Event)], ids=lambda it: it.value)
def test_each_event_leads_where_the_rules_lead(motion: Motion, event: Event) -> None:
    assert rules_of(successor(motion, event)) == rules_of(motion).after(event)


@pytest.mark.parametrize(("motion", "event"), [*product(Motion, Event)], ids=lambda it: it.value)
def test_each_event_is_idempotent(motion: Motion, event: Event) -> None:
    once = successor(motion, event)
    assert successor(once, event) is once


def test_from_the_begin_every_state_is_reached_and_only_a_request_arms() -> None:
    reached, left = {Motion.DISARMED}, [Motion.DISARMED]
    while left:
        motion = left.pop()
        for event in Event:
            after = successor(motion, event)
            assert after is not Motion.ARMED or event is Event.ARM or motion is Motion.ARMED
            if after not in reached:
                reached.add(after)
                left.append(after)
    assert reached == set(Motion)


@pytest.mark.parametrize("life", Life)
def test_only_a_running_bridge_is_armed(life: Life) -> None:
    assert (forbidden(life, Motion.ARMED) is None) is (life is Life.RUNNING)
    assert all(forbidden(life, motion) is None for motion in Motion if motion is not Motion.ARMED)
