"""Rides end with their test: the plant is let go."""

from collections.abc import Iterator

import pytest

from hil_tests.scenarios.ride import Ridden, Ride, ride


@pytest.fixture
def rides() -> Iterator[Ridden]:
    made: list[Ride] = []

    def begin(*steps: object, **how: object) -> Ride:
        made.append(ride(*steps, **how))  # type: ignore[arg-type] # passed on as it came
        return made[-1]

    yield begin
    for one in made:
        one.rig.finish()
