"""RARS weighs itself by its motors' currents and its IMU: a load that is not the stated one stops it."""

import math
from collections.abc import Callable

import pytest

from firmware_bridge.drivers.driver import Feedback, Reading
from firmware_bridge.robots.rars.geometry import Weighing
from firmware_bridge.robots.rars.weighing import FORGETS, LASTS_S, Weigher
from firmware_bridge.units import MILLISECOND, SECOND, to_seconds
from hil_tests.scenarios.ride import Ride, step
from hil_tests.stability.manoeuvres import robot

UNLOADED_KG = 70.6
EVERY = 50 * MILLISECOND
MACHINE = robot(governed=True, weighed=True)
TABLE = Weighing(acceleration="ahead", newton_per_ampere=20.0, resistance_n=8.0)


@pytest.mark.parametrize(
    ("payload_kg", "degrees", "speed_mps"),
    [(0.0, 10.0, 0.3), (10.0, 15.0, 0.3), (10.0, 10.0, -0.3), (10.0, -10.0, 0.3)],
)
def test_a_stated_load_is_weighed_and_stops_nothing(
    on_slope: Callable[..., Ride], payload_kg: float, degrees: float, speed_mps: float
) -> None:
    one = on_slope(MACHINE, degrees, step(11.0, speed_mps=speed_mps), payload_kg=payload_kg)
    one.runs_until(16.0)
    assert one.rig.bridge.seen.body.mass_kg == pytest.approx(UNLOADED_KG + payload_kg, rel=0.05)
    assert "load implausible" not in one.held_between(4.0, 16.0)


@pytest.mark.parametrize("then_kg", [10.0, 40.0])
def test_a_load_far_above_the_stated_one_stops_it_as_often_as_it_drives(
    on_slope: Callable[..., Ride], then_kg: float
) -> None:
    """It forgets at standstill, so that it may be armed: with the load off it drives, else it stops again."""
    again = (step(18.0, speed_mps=0.0), step(21.0, arm=True), step(23.0, speed_mps=0.3))
    one = on_slope(MACHINE, 10.0, step(11.0, speed_mps=0.3), *again, payload_kg=40.0)
    one.runs_until(17.0)
    assert "load implausible" in one.held_between(11.0, 17.0)
    assert abs(one.now["speed_mps"]) < 0.01
    assert one.now["armed"] == 0.0
    one.rig.devices.plant.change("lift_payload", then_kg)
    one.runs_until(22.0)
    assert one.now["armed"] == 1.0
    one.runs_until(29.0)
    assert ("load implausible" in one.held_between(22.0, 29.0)) == (then_kg > 10.0)
    assert one.now["armed"] == float(then_kg <= 10.0)


def fed(weigher: Weigher, count: int, *, amperes: float = 10.0, ahead: float = 2.0, begin: int = 0) -> None:
    """Let currents come each 50 ms at 0.2 m/s."""
    for number in range(begin, begin + count):
        at = SECOND + number * EVERY
        axes = {name: Feedback(name, current_a=amperes / 2.0, current_at=at) for name in ("left", "right")}
        weigher.take(axes, {"ahead": Reading(ahead, at, at)}, 0.2)


def test_force_by_acceleration_is_mass() -> None:
    weigher = Weigher(TABLE, "left", "right")
    fed(weigher, round(LASTS_S / to_seconds(EVERY)))
    assert weigher.mass_kg is None, "older measurements count by less"
    fed(weigher, 30, begin=50)
    assert weigher.mass_kg == pytest.approx((10.0 * 20.0 - 8.0) / 2.0)


@pytest.mark.parametrize(
    ("amperes", "ahead"), [(math.nan, 2.0), (10.0, math.nan), (10.0, math.inf), (10.0, 0.9), (10.0, -0.9)]
)
def test_what_is_no_measurement_does_not_count(amperes: float, ahead: float) -> None:
    weigher = Weigher(TABLE, "left", "right")
    fed(weigher, 100, amperes=amperes, ahead=ahead)
    assert weigher.mass_kg is None
    fed(weigher, 100, begin=100)
    assert weigher.mass_kg == pytest.approx(96.0)


def test_a_current_counts_once_and_a_stand_forgets() -> None:
    weigher = Weigher(TABLE, "left", "right")
    fed(weigher, 40)
    for _ in range(100):
        fed(weigher, 1, begin=39)
    found = [weigher.mass_kg]
    fed(weigher, 60, begin=40)
    found.append(weigher.mass_kg)
    for number in range(2 * FORGETS // EVERY):
        at = SECOND + (100 + number) * EVERY
        stands = {name: Feedback(name, current_a=0.0, current_at=at) for name in ("left", "right")}
        weigher.take(stands, {}, 0.0)
    found.append(weigher.mass_kg)
    assert found == [None, pytest.approx(96.0), None]
