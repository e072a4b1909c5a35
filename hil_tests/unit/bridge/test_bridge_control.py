"""The station in control, in the whole bridge: a change of it, and its loss, start nothing."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge import robot_types
from firmware_bridge.bridge import Bridge
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, DENIED, RPM_AT_03, driving

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

PLACE = number_of("192.0.2.7", 14550)
CONTROL = 32100
OTHER = Codec(255, 190)


def stick(x: int) -> Any:
    return dialect.MAVLink_manual_control_message(1, x, 0, 0, 0, 0)


def order(command: int, *params: float) -> Any:
    seven = (*params, *(0.0,) * (7 - len(params)))
    return dialect.MAVLink_command_long_message(1, 1, command, 0, *seven)


def other_states(bench: "Bench", *messages: Any) -> None:
    """Let another station say something, all in one instant."""
    datagram = b"".join(OTHER.encode(message) for message in messages)
    bench.air.carry(bench.at_station, Packet(OPERATOR, PLACE, datagram))
    bench.world.run(bench.now)


def test_who_arms_beside_a_stick_that_idles_begins_with_his_own_let_go(started: "Bench") -> None:
    begin = started.now
    other_states(started, order(ARM, 1.0), stick(1000))
    for _ in range(20):
        other_states(started, stick(1000))
        started.runs(0.05)
    assert started.bridge.seen.facts.armed
    assert {target for _, target in started.words("left", begin)} == {0}
    assert "not neutral since the timeout: x stands at 1000" in started.reported()
    for x in (0, 0, *(600,) * 20):
        other_states(started, stick(x))
        started.runs(0.05)
    assert started.drives["left"].rpm == RPM_AT_03


def test_control_that_passes_on_parts_the_operator_even_between_two_cycles(armed: "Bench") -> None:
    driving(armed)
    armed.commands(CONTROL, 1.0, 1.0)
    begin = armed.now
    other_states(armed, order(CONTROL, 1.0), stick(1000))
    for _ in range(20):
        other_states(armed, stick(1000))
        armed.runs(0.05)
    assert armed.bridge.seen.facts.armed
    assert armed.words("left", begin)[-1] == (0x000F, 0)


def test_a_driver_who_is_lost_leaves_a_robot_that_is_not_armed(bench_with: Callable[[Bridge], Any]) -> None:
    """Check it for any timeout of the operator in the robot file."""
    rars = robot_types.find("rars")
    patient = rars.operator.model_copy(update={"lost_ms": 60_000})
    bench = bench_with(Bridge(rars.model_copy(update={"operator": patient}), ROBOT_TYPE))
    bench.starts()
    assert bench.arms() == ACCEPTED
    bench.talks = False
    bench.runs(9.9)
    assert bench.bridge.seen.facts.armed
    bench.runs(0.2)
    assert not bench.bridge.seen.facts.armed
    assert "no station in control" in bench.reported()


def test_control_is_lost_at_rest_only(armed: "Bench", monkeypatch: pytest.MonkeyPatch) -> None:
    driving(armed)
    armed.talks = False
    rules = armed.bridge._permission.rules  # noqa: SLF001 - a robot that is held to move is hard to come by
    monkeypatch.setattr(type(rules), "at_standstill", lambda *_: False)
    armed.runs(12)
    assert "is gone" not in armed.reported()
    monkeypatch.undo()
    armed.runs(0.1)
    assert "is gone, no station in control" in armed.reported()


def test_a_refusal_of_the_first_station_is_not_the_others(armed: "Bench") -> None:
    other_states(armed, order(ARM, 0.0), stick(-1000))
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03
    assert armed.commands(ARM, 0.0) == ACCEPTED
    assert armed.commands(CONTROL, 0.0) == ACCEPTED
    assert armed.commands(CONTROL, 0.0) == DENIED
    other_states(armed, order(CONTROL, 1.0))
    armed.runs(1 * MILLISECOND / 1e9)
    assert armed.arms() == DENIED
