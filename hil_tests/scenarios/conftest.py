"""Rides end with their test. Those that begin with an armed robot go on from one instant of one bench."""

from collections.abc import Callable, Iterator

import pytest

from emulators.robots.rars import RarsStep as Step
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
