"""A bridge on the live page: it is shown, an emergency stop reaches it at once, and nothing else does."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.bench.operator import ScriptedOperator
from emulators.rig import BRIDGE, Rig
from firmware_bridge.bridge import Bridge
from firmware_bridge.drivers.driver import Power
from firmware_bridge.live.messages import CLOSED, LIVE, OPENED
from firmware_bridge.live.robot import PLACE, LiveRobot
from firmware_bridge.mavlink.trust import Trust
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.units import MILLISECOND, SECOND, from_seconds

PAGE: Final = 1


class ShownRobot:
    """A mission's robot, whose bridge is on the live page; its page is in the test's hands."""

    def __init__(self) -> None:
        robot = find("rome")
        setup = bench_setup_of(robot)
        script = mission_of("line", robot, setup)
        generator: Any = None
        self.rig: Final = Rig(script.on(robot), setup, ScriptedOperator(robot, setup, script, generator))
        self.ended = 0
        self.station: Final = self.rig.world._stations[BRIDGE]  # noqa: SLF001 - the bridge's place
        self.page: Final[list[dict[str, Any]]] = []
        self.at_place: Final[list[Packet]] = []
        self.live: Final = LiveRobot(self.station.node, self.rig.bridge, robot, self._ends)
        self.station.node = self.live
        self.station.receive, self.station.wake = self._receive, self._wake

    def sends(self, payload: bytes) -> list[dict[str, Any]]:
        """Send a page's message now; return what the page receives at once."""
        begun = len(self.page)
        world = self.rig.world
        world._take(self.station, self._receive(Packet(LIVE, PAGE, payload), world.now))  # noqa: SLF001 - as above
        return self.page[begun:]

    def _ends(self) -> None:
        self.ended += 1

    def _receive(self, packet: Packet, now: int) -> Reaction:
        return self._split(self.live.receive(packet, now))

    def _wake(self, now: int) -> Reaction:
        return self._split(self.live.wake(now))

    def _split(self, reaction: Reaction) -> Reaction:
        """Keep what is for the page; the world carries the rest."""
        self.page.extend(json.loads(one.payload) for one in reaction.sent if one.link == LIVE)
        self.at_place.extend(one for one in reaction.sent if (one.link, one.address) == (OPERATOR, PLACE))
        rest = tuple(one for one in reaction.sent if one.link != LIVE)
        return Reaction(rest, reaction.wake_at)


@contextmanager
def made() -> Iterator[ShownRobot]:
    robot = ShownRobot()
    try:
        yield robot
    finally:
        robot.rig.finish()


@pytest.fixture
def driving() -> Iterator[ShownRobot]:
    with made() as robot:
        robot.rig.run(from_seconds(8.0))
        assert robot.rig.bridge.seen.facts.armed
        yield robot


def test_it_is_introduced_as_a_robot_that_can_be_stopped_and_is_shown(driving: ShownRobot) -> None:
    hello, events, state = driving.sends(OPENED)
    assert (hello["mode"], hello["can"], hello["faults"]) == ("robot", ["stop", "emergency_stop"], [])
    assert any("not armed" in one["text"] for one in events["events"])
    assert state["armed"]
    begun = len(driving.page)
    driving.rig.runs(1.0)
    states = [one for one in driving.page[begun:] if one["kind"] == "state"]
    assert 18 <= len(states) <= 21
    assert max(abs(value) for value in states[-1]["command"].values()) > 0
    driving.sends(CLOSED)
    begun = len(driving.page)
    driving.rig.runs(1.0)
    assert driving.page[begun:] == []


def test_an_emergency_stop_of_the_page_is_latched_in_this_cycle_and_takes_the_power(
    driving: ShownRobot,
) -> None:
    driving.sends(OPENED)
    answer = driving.sends(b'{"id":7,"do":"emergency_stop"}')[-1]
    assert (answer["id"], answer["ok"]) == (7, True)
    driving.rig.runs(0.05)
    assert driving.rig.bridge.seen.facts.emergency_stopped
    driving.rig.runs(2.0)
    assert not driving.rig.bridge.seen.facts.armed
    assert all(one.power is not Power.ON for one in driving.rig.bridge.seen.facts.axes.values())
    assert driving.at_place == [], "the answer ends at the page"


def test_a_stop_of_the_page_ends_the_run_in_good_order(driving: ShownRobot) -> None:
    driving.sends(OPENED)
    assert driving.sends(b'{"id":1,"do":"stop"}')[-1]["ok"]
    assert driving.ended == 1


@pytest.mark.parametrize(
    "line",
    [
        b'{"id":3,"do":"arm","on":true}',
        b'{"id":3,"do":"drive","x":1}',
        b'{"id":3,"do":"inject","fault":"shaft_blocked","keys":{}}',
        b'{"id":3,"do":"set","values":{"a":1}}',
        b'{"id":3,"do":"reset_emergency_stop"}',
        b'{"id":3,"do":"shutdown"}',
        b'{"id":3}',
        b'{"id":1e999,"do":"stop"}',
        b'{"id":NaN,"do":"emergency_stop"}',
        b'{"id":[-1e999],"do":"arm"}',
        b'{"id":3,"do":["stop"]}',
        b"[]",
        b"{",
        b"\xff",
        b"[" * 60_000,
    ],
)
def test_nothing_else_reaches_a_real_robot(driving: ShownRobot, line: bytes) -> None:
    driving.sends(OPENED)
    answer = driving.sends(line)[-1]
    assert answer["ok"] is False
    assert "a ground station drives it" in answer["error"]
    assert driving.ended == 0
    driving.rig.runs(0.5)
    assert driving.rig.bridge.seen.facts.armed


def test_the_page_changes_nothing_on_the_wires() -> None:
    robot = find("rome")
    setup = bench_setup_of(robot)
    script = mission_of("line", robot, setup)
    generator: Any = None
    plain = Rig(script.on(robot), setup, ScriptedOperator(robot, setup, script, generator))
    with made() as shown:
        shown.sends(OPENED)
        for rig in (plain, shown.rig):
            rig.run(from_seconds(5.0))
        assert plain.world.trace_sha256 == shown.rig.world.trace_sha256
    plain.finish()


def test_an_emergency_stop_of_the_page_counts_on_a_link_with_signatures_too() -> None:
    robot = find("rome")
    trust = Trust(key=b"k" * 32, started_at=1_700_000_000 * SECOND)
    bridge = Bridge(robot, robot_type_of(robot), trust)
    live = LiveRobot(bridge, bridge, robot, pytest.fail)
    live.wake(0)
    live.receive(Packet(LIVE, PAGE, OPENED), 5 * MILLISECOND)
    live.receive(Packet(LIVE, PAGE, b'{"id":1,"do":"emergency_stop"}'), 10 * MILLISECOND)
    for now in range(20, 100, 10):
        live.wake(now * MILLISECOND)
    assert bridge.seen.facts.emergency_stopped
