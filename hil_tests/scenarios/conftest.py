"""Rides end with their test. Those that begin with an armed robot go on from one instant of one bench."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import can
import pytest

from emulators.robots.rars import RarsStep as Step
from hil_tests.scenarios.real_bus import MULTICAST, SDO_ANSWERS, SOCKETCAN, Bench, Eye
from hil_tests.scenarios.ride import Armed, Ridden, Ride, ride


@pytest.fixture(scope="session")
def armed() -> Iterator[Callable[[], Armed]]:
    """The armed robot, made when the first story needs it."""
    made: list[Armed] = []

    def get() -> Armed:
        if not made:
            made.append(Armed())
        return made[0]

    yield get
    for one in made:
        one.finish()


@pytest.fixture
def rides(armed: Callable[[], Armed]) -> Iterator[Ridden]:
    """Make rides: the first of a test that suits forks from the armed robot, all others have a new bench."""
    made: list[Ride] = []
    forked = False

    def begin(*steps: Step, **how: object) -> Ride:
        nonlocal forked
        if not forked and Armed.suits(steps, how):
            forked = True
            return armed().fork(*steps, **how)  # type: ignore[arg-type] # passed on as it came
        made.append(ride(*steps, **how))  # type: ignore[arg-type] # passed on as it came
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
    with can.Bus(interface=interface, channel=channel, hop_limit=0) as bus:
        made = Bench(tmp_path, {}, Eye(bus), unused_port, MULTICAST)
        yield made
        made.finish()


@pytest.fixture
def unused_port() -> int:
    return 14550 + time.monotonic_ns() % 1000
