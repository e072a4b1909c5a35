"""The guard of a link with one axis: listed lines, its speed at both edges, power at standstill."""

import math
from typing import ClassVar, Final

import pytest

from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard.one_axis import OneAxisRules
from firmware_bridge.units import NEVER

BOTH: Final = find("diff_drive")
ROBOT: Final = BOTH.model_copy(update={"axes": BOTH.axes[:1]})
LINK: Final = "drives"
TOP: Final = ROBOT.axes[0].top_speed


class Rules(OneAxisRules):
    """`v` and a number is a speed."""

    LISTED: ClassVar[frozenset[bytes]] = frozenset({b"state"})
    POWERS: ClassVar[bytes] = b"on"
    STOPS: ClassVar[frozenset[bytes]] = frozenset({b"stop", b"off"})
    SAFE: ClassVar[bytes] = b"v0"

    def speed_of(self, line: bytes) -> float | None:
        return float(line[1:]) if line.startswith(b"v") else None

    def unpowered_by(self, line: bytes) -> bool:
        return line == b"is off"


def packet(line: bytes, address: int = 0) -> Packet:
    return Packet(LINK, address, line)


def after(*lines: bytes) -> Rules:
    rules = Rules(ROBOT, LINK)
    for line in lines:
        rules.sends(packet(line), 0, requested=True)
    return rules


def speed(value: float) -> bytes:
    return b"v%r" % value


def test_it_begins_at_standstill_without_power_and_every_safe_line_is_its_own() -> None:
    rules = Rules(ROBOT, LINK)
    (axis,) = rules.axes
    assert (axis.axis.name, axis.cycle, axis.commanded_at) == (ROBOT.axes[0].name, ROBOT.cycle, -NEVER)
    assert (axis.speed, axis.moving, axis.powered, axis.homes) == (0.0, False, False, False)
    assert rules.safe(axis) == (packet(b"v0"),)
    assert rules.replacement_of(packet(b"other")) is None
    assert not rules.waiting


@pytest.mark.parametrize("line", [b"state", b"on", b"stop", b"off", b"v0", speed(TOP), speed(-TOP)])
def test_listed_lines_and_speeds_up_to_the_bound_leave(line: bytes) -> None:
    assert Rules(ROBOT, LINK).refuses(packet(line), 0) is None


@pytest.mark.parametrize("value", [TOP * (1.0 + 1e-9), -TOP * (1.0 + 1e-9), math.inf, math.nan])
def test_a_speed_beyond_the_bound_or_that_is_no_number_does_not(value: float) -> None:
    reason = Rules(ROBOT, LINK).refuses(packet(speed(value)), 0)
    assert reason is not None
    assert reason.endswith(f"is beyond {TOP:g}")
    assert ROBOT.axes[0].called in reason


@pytest.mark.parametrize(
    "stated", [packet(b"other"), packet(b""), packet(b"state", 7), packet(b"", DTR_UP), packet(b"", DTR_DOWN)]
)
def test_what_is_not_listed_does_not_leave(stated: Packet) -> None:
    rules = Rules(ROBOT, LINK)
    assert rules.refuses(stated, 0) == f"the line {stated.payload!r} is not listed"
    assert rules.axes_of(stated) == ()


@pytest.mark.parametrize(("line", "requested"), [(b"v1.5", 1.5), (b"v0", 0.0), (b"stop", 0.0), (b"off", 0.0)])
def test_a_set_point_is_of_the_axis_and_a_stop_is_one(line: bytes, requested: float) -> None:
    rules = after(b"v2.0")
    (axis,) = rules.axes
    assert rules.axes_of(packet(line)) == rules.axes
    assert rules.requested_by(packet(line)) == {axis: (requested != 0.0, requested)}
    assert rules.sends(packet(line), 0, requested=True) == rules.axes
    assert (axis.speed, axis.moving) == (requested, requested != 0.0)


@pytest.mark.parametrize("line", [b"state", b"on"])
def test_other_lines_are_no_set_points(line: bytes) -> None:
    rules = after(b"v2.0")
    assert rules.axes_of(packet(line)) == ()
    assert rules.sends(packet(line), 0, requested=True) == ()
    assert rules.axes[0].speed == 2.0


def test_power_is_given_at_standstill_only() -> None:
    assert after(b"v1.0").refuses(packet(b"on"), 0) == (
        f"{ROBOT.axes[0].called}: power on while a speed is in force"
    )
    assert after(b"v1.0", b"stop").refuses(packet(b"on"), 0) is None


def test_it_counts_as_powered_from_the_command_until_the_device_reports_otherwise() -> None:
    rules = after(b"on", b"off")
    (axis,) = rules.axes
    assert axis.powered
    for received in (packet(b"is on\n"), packet(b"is off\n", LINE_LOST), packet(b"is o")):
        assert rules.receives(received, 0)
        assert axis.powered
    assert rules.receives(packet(b"ff\n"), 0)
    assert not axis.powered


def test_a_link_with_two_axes_is_none_of_its() -> None:
    with pytest.raises(ValueError, match="too many values"):
        Rules(BOTH, LINK)
