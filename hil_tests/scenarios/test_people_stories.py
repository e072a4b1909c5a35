"""Stories of what people do beside the operator: they end the bridge, start another one, and join."""

import math
from typing import Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import parse
from emulators.rig import BRIDGE
from emulators.robot_plant import plant_parameters
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS: Final[AnyRobot] = find("rars")
ROBOTS: Final = {"can": RARS, "serial": over_serial(RARS)}
ENDS_S: Final = 6.0
AGAIN: Final = (step(12.0, speed_mps=0.0), step(13.0, arm=True), step(14.0, speed_mps=0.2))
DRIVING: Final = (ARMED, step(4.0, speed_mps=0.3))

on_each_link = pytest.mark.parametrize("link", ROBOTS)


def powered(one: Ride) -> bool:
    return any(axis.powered for axis in one.rig.devices.axes)


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_requested_to_end_it_leaves_no_power_and_the_next_one_drives(rides: Ridden, link: str) -> None:
    end = fault("bridge_ends", ENDS_S, for_s=5.0)
    one = rides(*DRIVING, *AGAIN, seconds=20, robot=ROBOTS[link], faults=[end])
    one.runs_until(ENDS_S + 4.0)
    assert one.rig.bridge.finished
    assert not powered(one)
    assert one.stands_from(ENDS_S, slower_than=0.01) < ENDS_S + 0.5
    one.runs_until(15.5)
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)
    record = one.rig.faults.records[-1]
    assert (record.kind, record.nodes) == ("bridge_ends", (BRIDGE,))


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_killed_it_leaves_the_drives_to_their_own_watch(rides: Ridden, link: str) -> None:
    end = fault("bridge_ends", ENDS_S, how="killed", for_s=5.0)
    one = rides(*DRIVING, *AGAIN, seconds=20, robot=ROBOTS[link], faults=[end])
    one.runs_until(ENDS_S + 2.0)
    assert not one.rig.world.here(BRIDGE)
    assert not powered(one)
    assert ENDS_S + 0.2 < one.stands_from(ENDS_S, slower_than=0.01) < ENDS_S + 1.2
    one.runs_until(15.5)
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)


@pytest.mark.long(beside="test_ctrl_c_on_a_slope_holds_and_a_second_one_within_5_s_lets_go")
def test_requested_twice_on_a_slope_it_lets_go(rides: Ridden) -> None:
    plant = RARS.plant.model_copy(update={"parameters": {"slope": math.radians(5.0), "floor_friction": 0.9}})
    end = fault("bridge_ends", ENDS_S, again_after_s=4.0)
    one = rides(ARMED, seconds=20, robot=RARS.model_copy(update={"plant": plant}), faults=[end])
    one.runs_until(ENDS_S + 3.9)
    assert one.rig.bridge.holding
    assert powered(one)
    one.runs_until(ENDS_S + 5.5)
    assert one.rig.bridge.finished
    assert not powered(one)


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_a_run_across_a_bridge_that_was_started_again_goes_on_as_it_went(rides: Ridden, link: str) -> None:
    end = fault("bridge_ends", ENDS_S, how="killed", for_s=0.4)
    one = rides(*DRIVING, seconds=20, robot=ROBOTS[link], faults=[end])
    one.runs_until(ENDS_S - 0.1)
    before, first = one.rig.snapshot(), one.rig.bridge
    one.runs_until(ENDS_S + 1.0)
    after, second = one.rig.snapshot(), one.rig.bridge
    one.runs_until(ENDS_S + 1.5)
    went = one.rig.world.trace_sha256
    assert second is not first
    for moment, bridge in ((before, first), (after, second)):
        one.rig.restore(moment)
        assert one.rig.bridge is bridge
        one.runs_until(ENDS_S + 1.5)
        assert one.rig.world.trace_sha256 == went


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_suspended_it_finds_its_drives_stopped_and_moves_none_of_them_on(rides: Ridden, link: str) -> None:
    suspended = fault("bridge_suspended", ENDS_S, for_s=5.0)
    one = rides(*DRIVING, *AGAIN, seconds=20, robot=ROBOTS[link], faults=[suspended])
    one.runs_until(ENDS_S + 5.0)
    assert ENDS_S + 0.2 < one.stands_from(ENDS_S, slower_than=0.01) < ENDS_S + 1.2
    one.runs_until(ENDS_S + 5.5)
    assert "bridge stalled" in one.held_between(ENDS_S + 5.0, ENDS_S + 5.2)
    assert not one.now["armed"]
    one.runs_until(AGAIN[1].at_s)
    assert one.fastest(ENDS_S + 1.3, AGAIN[1].at_s) < 0.01
    one.runs_until(15.5)
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)


def test_killed_as_it_runs_on_the_next_one_drives(rides: Ridden) -> None:
    faults = [
        fault("bridge_suspended", ENDS_S, for_s=0.5),
        fault("bridge_ends", ENDS_S + 0.5, how="killed", for_s=0.5),
    ]
    one = rides(*DRIVING, *AGAIN, seconds=20, faults=faults)
    one.runs_until(15.5)
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)


def test_a_second_bridge_disturbs_no_one(rides: Ridden) -> None:
    one = rides(*DRIVING, seconds=20, faults=[fault("second_bridge", 5.0, for_s=1.0)])
    one.runs_until(7.0)
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.3, abs=0.02)


@pytest.mark.long(keeps=["take", "garbage"])
@pytest.mark.parametrize("order", ["", "take", "arm", "disarm", "clear", "hold", "garbage"])
def test_a_second_station_changes_nothing(rides: Ridden, order: str) -> None:
    joins = fault("second_station", 5.0, order=order, stick=-1.0, for_s=1.5)
    one = rides(*DRIVING, seconds=20, faults=[joins])
    one.runs_until(7.0)
    assert one.rig.stations[-1].accepted == []
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.3, abs=0.02)


def test_a_second_station_s_emergency_stop_is_obeyed(rides: Ridden) -> None:
    one = rides(
        *DRIVING, seconds=20, faults=[fault("second_station", 5.0, order="emergency stop", for_s=1.0)]
    )
    one.runs_until(7.0)
    assert one.rig.stations[-1].accepted
    assert not one.now["armed"]
    assert one.fastest(6.0, 7.0) < 0.01


def test_another_master_s_frames_are_held_against_him(rides: Ridden) -> None:
    one = rides(
        *DRIVING,
        seconds=20,
        faults=[fault("stray_frames", 5.0, identifier=0x501, data="060000000000", for_s=1.0)],
    )
    one.runs_until(7.0)
    assert one.held("second controller: drives")
    assert one.fastest(6.5, 7.0) < 0.01


def test_a_mission_names_its_floor() -> None:
    rest = '[[step]]\nat_s = 1.0\ntitle = "s"\narm = true\n'
    text = f'title = "t"\nduration_s = 9.0\n[plant]\nslope = 0.05\n{rest}'
    mission = parse(text, "my.toml", RARS, bench_setup_of(RARS))
    assert plant_parameters(mission.on(RARS))["slope"] == 0.05
    assert "slope" not in plant_parameters(RARS)


def test_a_bridge_that_runs_again_does_not_go_on_from_the_speed_of_before(rides: Ridden) -> None:
    suspended = fault("bridge_suspended", ENDS_S, for_s=0.3)
    one = rides(*DRIVING, seconds=20, faults=[suspended])
    one.runs_until(ENDS_S + 0.25)
    assert one.rig.bridge.seen.commanded.speed_mps == pytest.approx(0.3, abs=0.02)
    one.runs_until(ENDS_S + 0.31)
    assert abs(one.rig.bridge.seen.commanded.speed_mps) < 0.1
