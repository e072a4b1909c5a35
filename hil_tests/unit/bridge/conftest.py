"""The bridge on a bus with four paper drives, or with four emulated ones."""

from collections.abc import Callable, Iterator

import pytest

from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.family import Devices
from emulators.world import World
from firmware_bridge import robot_types
from firmware_bridge.bridge import Bridge
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robots.rars import ROBOT_TYPE
from hil_tests.unit.bridge.bench import Bench, Moments, sound
from hil_tests.unit.bridge.fake_drive import FakeDrive


def joined() -> Bench:
    return joined_with(Bridge(robot_types.find("rars"), ROBOT_TYPE))


def joined_with(bridge: Bridge) -> Bench:
    """Join a bridge of the test's own to four drives and a station."""
    robot = robot_types.find("rars")
    return Bench(robot, bridge, {axis.name: FakeDrive(axis) for axis in robot.axes})


@pytest.fixture
def robot() -> AnyRobot:
    return robot_types.find("rars")


@pytest.fixture
def bench() -> Iterator[Bench]:
    """Four drives, a bridge behind its guard, a station; the guard refuses the test's frames, or nothing."""
    yield from sound(joined())


@pytest.fixture(scope="session")
def moments() -> Moments:
    return Moments(joined)


@pytest.fixture
def started(moments: Moments) -> Iterator[Bench]:
    """The same when the drives are set up and the bridge runs."""
    yield from moments.started()


@pytest.fixture
def armed(moments: Moments) -> Iterator[Bench]:
    """The same, and armed."""
    yield from moments.armed()


@pytest.fixture
def emulated() -> Iterator[tuple[Bench, Devices]]:
    """The same with four emulated drives above the plant."""
    robot = robot_types.find("rars")
    below = devices(robot)
    bench = Bench(robot, Bridge(robot, ROBOT_TYPE), below.nodes(Epos2), world=World(below.physics))
    yield bench, below
    assert [refusal.reason for refusal in bench.guard.refusals] == []
    below.plant.close()


@pytest.fixture(scope="session")
def bench_with() -> Callable[[Bridge], Bench]:
    """Return the constructor for tests that bring their own bridge."""
    return joined_with


@pytest.fixture(scope="session")
def new_bench() -> Callable[[], Bench]:
    """Return the constructor for tests that need one for each example."""
    return joined
