"""RARS with an IMU and its governor does not tip over; without the governor the same manoeuvres do it."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find
from emulators.rig import Rig
from emulators.run import RunOrder, operator_of
from firmware_bridge.units import SECOND
from hil_tests.scenarios.ride import Ride, fault, step
from hil_tests.stability.manoeuvres import LASTS_S, LISTS, Driver, drawn, robot

USUAL, HARD = LISTS["usual"], LISTS["hard"]
PART, SMALL = 20, 5


@pytest.fixture(scope="module")
def governed() -> Iterator[Driver]:
    driver = Driver(robot(governed=True))
    yield driver
    driver.finish()


@pytest.fixture(scope="module")
def free() -> Iterator[Driver]:
    driver = Driver(robot(governed=False))
    yield driver
    driver.finish()


def tipped(driver: Driver, seeds: range, *, hard: bool) -> list[int]:
    """Return the seeds of the manoeuvres in which it tips over."""
    return [seed for seed in seeds if driver.tips(drawn(seed, hard=hard))]


def test_what_tips_without_the_governor_does_not_with_it(governed: Driver, free: Driver) -> None:
    over = tipped(free, range(HARD.in_make_test), hard=True)
    assert over
    assert [seed for seed in over if governed.tips(drawn(seed, hard=True))] == []


def test_what_once_tipped_with_it_does_not_any_more(governed: Driver) -> None:
    for one in LISTS.values():
        assert [seed for seed in one.found if governed.tips(drawn(seed, hard=one.hard))] == []


def test_a_load_on_the_raised_table_tips_it_over_without_the_governor_only(
    governed: Driver, free: Driver
) -> None:
    one = drawn(39)
    assert one.lasts_s > LASTS_S
    assert free.tips(one)
    assert not governed.tips(one)


@pytest.mark.parametrize("first", range(0, USUAL.in_make_test, SMALL))
def test_nothing_tips_over_with_the_governor(governed: Driver, first: int) -> None:
    assert tipped(governed, range(first, first + SMALL), hard=False) == []


@pytest.mark.long(beside="test_what_tips_without_the_governor_does_not_with_it")
@pytest.mark.parametrize("first", range(0, HARD.in_long_lane, PART))
def test_of_the_hard_ones_more_than_a_fifth_tip_without_it_and_none_with_it(
    governed: Driver, free: Driver, first: int
) -> None:
    assert len(tipped(free, range(first, first + PART), hard=True)) > PART / 5
    assert tipped(governed, range(first, first + PART), hard=True) == []


@pytest.mark.long(beside="test_nothing_tips_over_with_the_governor")
@pytest.mark.parametrize("first", range(USUAL.in_make_test, USUAL.in_long_lane, PART))
def test_nothing_of_the_whole_list_tips_over_with_the_governor(governed: Driver, first: int) -> None:
    assert tipped(governed, range(first, first + PART), hard=False) == []


OF_GOVERNOR = {"margin limit", "lift margin limit", "tilt unknown"}
SETTLED = 2 * SECOND


def taken_by_the_governor(mission: str) -> set[str]:
    """Return which of the governor's rules are active in a shipped mission; the robot must not tip over."""
    machine = robot(governed=True)
    setup = bench_setup_of(machine)
    script = find(mission, machine, setup)
    order = RunOrder(machine, setup, mission, script, 0, Path())
    rig = Rig(
        script.on(machine),
        setup,
        operator_of(order),
        noise=script.noise,
        link=script.conditions,
        faults=script.fault,
    )
    rig.run(order.duration)
    assert rig.devices.plant.read("tipped") == 0.0
    rig.finish()
    assert len(rig.samples) > 100
    # Until the filter of the IMU has settled, for 1 s after the start, the tilt is unknown.
    late = {one.name for one in rig.interlock_events if one.ended is None or one.ended > SETTLED}
    return late & OF_GOVERNOR


def test_the_governor_takes_no_part_in_the_mission_line() -> None:
    assert taken_by_the_governor("line") == set()


@pytest.mark.long(beside="test_the_governor_takes_no_part_in_the_mission_line")
@pytest.mark.parametrize(
    "mission",
    ["thesis", "pursuit", "stuck", "interlocks", "left_failed", "steering_failed", "circles"],
)
def test_the_governor_takes_no_part_in_a_shipped_mission(mission: str) -> None:
    assert taken_by_the_governor(mission) == set()


def test_on_the_level_the_governor_takes_nothing(on_slope: Callable[..., Ride]) -> None:
    drives = (step(11.0, speed_mps=0.5), step(13.0, speed_mps=-0.5), step(15.0, radius_m=1.0))
    one = on_slope(robot(governed=True), 0.0, *drives)
    one.runs_until(17.0)
    assert one.fastest(11.0, 17.0) > 0.49
    assert not {"margin limit", "lift margin limit", "tilt unknown"} & one.held_between(4.0, 17.0)


def test_ten_kilograms_climb_fifteen_degrees(on_slope: Callable[..., Ride]) -> None:
    one = on_slope(robot(governed=True), 15.0, step(11.0, speed_mps=0.5))
    one.runs_until(15.0)
    assert one.now["speed_mps"] == pytest.approx(0.48, abs=0.03)
    assert one.rig.devices.plant.read("zmp_margin") > 0.05


def test_ten_kilograms_on_thirty_degrees_stand_do_not_climb_and_back_down(
    on_slope: Callable[..., Ride],
) -> None:
    drives = (step(11.0, speed_mps=0.3), step(13.5, speed_mps=-0.3), step(18.0, speed_mps=0.0))
    one = on_slope(robot(governed=True), 30.0, *drives)
    one.runs_until(13.4)
    climbed = one.now["x_m"]
    assert one.fastest(11.5, 13.4) < 0.005
    assert "margin limit" in one.held_between(11.0, 11.2)
    one.runs_until(17.9)
    assert one.now["x_m"] < climbed - 0.02
    assert -0.10 < one.now["speed_mps"] < -0.005
    one.runs_until(19.5)
    assert abs(one.now["speed_mps"]) < 0.005
    assert one.rig.devices.plant.read("tipped") == 0.0


def test_the_table_rises_no_further_than_the_slope_lets_it(on_slope: Callable[..., Ride]) -> None:
    one = on_slope(robot(governed=True), 24.0, step(11.0, lift_rate_mps=0.1), payload_kg=0.5)
    one.runs_until(19.5)
    # (0.141 m - 10 mm - 9 mm - z tan 1 deg) / tan 24 deg is where the heaviest payload's centre of mass may
    # be, the 9 mm for a payload that stands 71 mm aside.
    assert one.now["lift_m"] == pytest.approx(0.215, abs=0.01)
    margin = one.rig.bridge.seen.body.margin_m
    assert 0.019 < margin < 0.029
    # The plant's payload is lighter than the heaviest.
    assert one.rig.devices.plant.read("zmp_margin") > margin


def test_without_the_imu_it_does_not_move(on_slope: Callable[..., Ride]) -> None:
    one = on_slope(robot(governed=True), 10.0, step(11.0, speed_mps=0.3))
    one.runs_until(12.0)
    assert one.now["speed_mps"] > 0.2
    one.rig.faults.plan([fault("imu_silent", 12.0)])
    one.runs_until(13.5)
    assert "tilt unknown" in one.holding
    assert abs(one.now["speed_mps"]) < 0.005
