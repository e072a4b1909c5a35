"""Standstill of a robot, by its kinematic model and by each axis that carries it, and a mode's state."""

from collections.abc import Mapping
from typing import Any, Final

import pytest

from firmware_bridge.drivers.driver import Feedback, Reading
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion.pose import Pose
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

NOW: Final = 10 * SECOND
SILENT: Final = 250 * MILLISECOND
BOUND: Final = 0.2


class Slide:
    """A body with one place: a motion is where to go, the state is where it is."""

    def requested(self, motion: float, state: float) -> frozenset[str]:
        return frozenset({"base"}) if motion != state else frozenset()

    def moving(self, _state: object) -> frozenset[str]:
        return frozenset()

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> object:
        return axes, sensors


def rules_of(*without: str) -> Rules:
    """Return the rules of a mode without these axes."""
    body: Any = Slide()
    return Rules(
        kinematics=body,
        without=frozenset(without),
        groups=frozenset({"base"}),
        travelling=frozenset({"base"}),
        standstill_below={"left": BOUND, "right": BOUND},
        silent_after={"left": SILENT, "right": SILENT},
        numbers={},
        interlocks=(),
        limits=(),
    )


def seen(
    left: float = 0.0, age: Nanoseconds = 0, *, commanded: float = 0.0, place: float = 0.0
) -> Snapshot[Any, Any]:
    """Return a snapshot; the left axis was last received so long ago."""
    axes = {
        "left": Feedback("left", received_at=NOW - age, velocity=left),
        "right": Feedback("right", received_at=NOW),
    }
    facts = Facts(
        now=NOW,
        armed=False,
        emergency_stopped=False,
        received_at=NEVER_RECEIVED,
        neutral=True,
        axes=axes,
        sensors={"voltage": Reading(24.0, NOW, NOW)},
        links_lost={},
    )
    return Snapshot(facts=facts, command=0.0, commanded=commanded, body=place, pose=Pose())


@pytest.mark.parametrize(
    ("commanded", "place", "rests"),
    [(0.0, 0.0, True), (2.0, 2.0, True), (2.0, 1.0, False), (0.0, 1.0, False)],
)
def test_a_robot_rests_while_it_is_where_it_is_to_be(commanded: float, place: float, *, rests: bool) -> None:
    assert rules_of().at_standstill(seen(commanded=commanded, place=place)) is rests


@pytest.mark.parametrize(
    ("without", "left", "age", "stands"),
    [
        ((), 0.199, 0, True),
        ((), 0.2, 0, False),
        ((), -0.2, 0, False),
        ((), 0.2, SILENT, False),
        (("right",), 0.2, SILENT, False),
        (("left",), 0.2, SILENT - 1, False),
        (("left",), 0.2, SILENT, True),
        (("left",), 0.199, 0, True),
    ],
)
def test_an_axis_in_use_must_stand_however_long_it_is_silent(
    without: tuple[str, ...], left: float, age: Nanoseconds, *, stands: bool
) -> None:
    """An axis that the mode does without is polled until it was silent for 250 ms."""
    assert rules_of(*without).stopped(seen(left, age)) is stands


def test_a_mode_senses_by_axes_and_sensors() -> None:
    known = seen()
    assert rules_of().sensed(known).body == (known.facts.axes, known.facts.sensors)
