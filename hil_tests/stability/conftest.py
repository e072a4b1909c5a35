"""A robot that stands on a slope which has turned up under it."""

import math
from collections.abc import Callable, Iterator

import pytest

from emulators.robots.rars import RarsStep
from firmware_bridge.robot import AnyRobot
from hil_tests.scenarios.ride import ARMED, SETTLED_S, Ride, ride
from hil_tests.stability.manoeuvres import HEAVIEST_KG


@pytest.fixture
def on_slope() -> Iterator[Callable[..., Ride]]:
    opened: list[Ride] = []

    def begin(machine: AnyRobot, degrees: float, *steps: RarsStep, payload_kg: float = HEAVIEST_KG) -> Ride:
        one = ride(ARMED, *steps, seconds=30.0, robot=machine)
        opened.append(one)
        one.runs_until(SETTLED_S)
        plant = one.rig.devices.plant
        plant.change("lift_payload", payload_kg)
        # Slowly: its drives hold their speed, and the floor turns up under it.
        for share in range(1, 601):
            plant.change("slope", share / 600.0 * math.radians(degrees))
            one.runs(0.01)
        return one

    yield begin
    for one in opened:
        one.rig.finish()
