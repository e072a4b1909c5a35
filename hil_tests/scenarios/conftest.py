"""Rides end with their test. Those that begin with an armed robot go on from one instant of one bench."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import can
import pytest

from emulators.robots.rars import RarsStep as Step
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.real_bus import MULTICAST, SDO_ANSWERS, SOCKETCAN, Bench, Eye
from hil_tests.scenarios.ride import Armed, Ridden, Ride, ride

KEPT: Final = 3
"""Number of robots that stand by, armed."""


@pytest.fixture(scope="session")
def armed() -> Iterator[Callable[[AnyRobot], Armed]]:
    """Robots that are armed, each made when the first story needs it; those that were used last are kept."""
    made: list[Armed] = []

    def get(robot: AnyRobot) -> Armed:
        found = next((one for one in made if one.robot == robot), None)
        if found is None:
            if len(made) == KEPT:
                made.pop(0).finish()
            found = Armed(robot)
        else:
            made.remove(found)
        made.append(found)
        return found

    yield get
    for one in made:
        one.finish()


@pytest.fixture
def rides(request: pytest.FixtureRequest, armed: Callable[[AnyRobot], Armed]) -> Iterator[Ridden]:
    """Make rides: the first of a test that suits forks from the armed robot, all others have a new bench.

    A test that changes the program has new ones only: the armed robot began without its change.
    """
    made: list[Ride] = []
    forked = "monkeypatch" in request.fixturenames

    def begin(*steps: Step, **how: Any) -> Ride:
        nonlocal forked
        if not forked and Armed.suits(steps, how):
            forked = True
            robot = how.pop("robot", None)
            return armed(find("rars") if robot is None else robot).fork(*steps, **how)
        made.append(ride(*steps, **how))
        return made[-1]

    yield begin
    for one in made:
        one.rig.finish()


@pytest.fixture
def bench(tmp_path: Path, unused_port: int) -> Iterator[Bench]:
    interface, channel = SOCKETCAN
    with can.Bus(interface=interface, channel=channel, can_filters=SDO_ANSWERS) as bus:
        made = Bench(tmp_path, {}, Eye(bus), unused_port)
        yield made
        made.finish()


@pytest.fixture
def datagrams(tmp_path: Path, unused_port: int) -> Iterator[Bench]:
    """Return a bench whose bus is a group of receivers on this machine."""
    interface, channel = MULTICAST
    with can.Bus(interface=interface, channel=channel) as bus:
        made = Bench(tmp_path, {}, Eye(bus), unused_port, MULTICAST)
        yield made
        made.finish()


@pytest.fixture
def unused_port() -> int:
    return 14550 + time.monotonic_ns() % 1000
