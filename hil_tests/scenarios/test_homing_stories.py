"""An axis that finds its zero by moving: home and drive, and everything that must stop it on its way.

The truth is the plant's. RARS's lift goes down onto its stop, its steering to one of its ends.
"""

import math
from typing import Final

import pytest

from emulators.devices import devices
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.robot import AnyRobot, RobotFileError
from hil_tests.scenarios.homed import LIFT, STEER, homed
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

CAN: Final = homed(LIFT, STEER)
USB: Final = over_serial(CAN, Generation.V2)
BY_ITSELF: Final = STEER.replace('after = ["lift"]', "")
ALONE: Final = homed(None, BY_ITSELF)
"""Only the steering is homed, and waits for no one."""
LINKS: Final = pytest.mark.parametrize("robot", [CAN, USB], ids=["can", "serial"])
EITHER: Final = pytest.mark.parametrize(
    "robot", [ALONE, over_serial(ALONE, Generation.V2)], ids=["can", "serial"]
)
LIFT_ERROR_M: Final = 2e-3
"""A stop is found late, by the way that the drive goes on until its current is high enough."""
END_DEG: Final = 59.8
"""Angle of the steering at 2.65 rad of its pinion."""
HOME: Final = step(2.0, home=["steering"])


def steer_deg(one: Ride) -> float:
    return math.degrees(one.now["steer_rad"])


def kept_back(one: Ride) -> list[str]:
    """Return the guard's refusals."""
    return [refusal.reason for refusal in one.rig.guard.refusals if refusal.packet is not None]


def on_its_way(one: Ride, second: float) -> None:
    """Check that the steering is on its way to its end then."""
    one.runs_until(second)
    assert "homing: steer" in one.holding
    assert -0.8 * END_DEG < steer_deg(one) < -5.0


def stays(one: Ride, since: float, until: float) -> None:
    """Check that the steering stands in this time, short of its end."""
    one.runs_until(until)
    angles = [math.degrees(row["steer_rad"]) for row in one.rows(since, until)]
    assert max(angles) - min(angles) < 0.1
    assert min(angles) > -0.9 * END_DEG
    assert one.held("not homed: steer")


@pytest.mark.long(beside="test_it_is_stopped_on_its_way_and_found_by_the_next_order")
@LINKS
def test_a_raised_lift_that_restarted_is_homed_and_the_robot_drives(rides: Ridden, robot: AnyRobot) -> None:
    """An arm enables first what a restart on a serial line has put to fault."""
    one = rides(
        ARMED,
        step(4.0, lift_m=0.05),
        step(6.5, arm=True),
        step(7.0, lift_m=0.0),
        step(9.0, home=["lift"]),
        step(16.0, arm=True),
        step(17.0, speed_mps=0.2),
        seconds=25,
        robot=robot,
        faults=[fault("drive_restart", 5.2, node="lift", for_s=0.2)],
    )
    one.runs_until(6.4)
    assert "reference lost: lift" in one.holding
    assert one.now["lift_m"] > 0.04
    one.runs_until(15.9)
    assert one.held("homing: lift")
    assert not {"homing: lift", "not homed: lift", "reference lost: lift"} & one.holding
    assert one.now["lift_m"] == pytest.approx(0.0, abs=LIFT_ERROR_M)
    assert one.rig.bridge.seen.body.lift_m == pytest.approx(0.0, abs=1e-3)
    assert one.fastest(4.0, 15.9) < 0.002
    one.runs_until(19.0)
    assert one.now["speed_mps"] == pytest.approx(0.2, rel=0.03)
    assert kept_back(one) == []


@pytest.mark.long(beside="test_it_is_stopped_on_its_way_and_found_by_the_next_order")
@LINKS
def test_steering_that_no_one_has_seen_finds_its_end(rides: Ridden, robot: AnyRobot) -> None:
    one = rides(
        step(1.5, zero={"lift": 0.0}),
        HOME,
        step(9.0, arm=True),
        step(10.0, speed_mps=0.1, steer_deg=0.0),
        seconds=19,
        robot=robot,
        stands=False,
    )
    one.runs_until(8.0)
    assert not {"reference lost: steer", "reference lost: lift"} & one.holding
    known = math.degrees(one.rig.bridge.seen.body.steer_rad)
    assert known == pytest.approx(steer_deg(one), abs=0.5)
    assert known == pytest.approx(-END_DEG, abs=0.5)
    one.runs_until(17.0)
    assert steer_deg(one) == pytest.approx(0.0, abs=0.5)
    assert one.now["speed_mps"] == pytest.approx(0.1, rel=0.05)
    assert kept_back(one) == []


@pytest.mark.long(keeps=["emergency stop-can"])
@EITHER
@pytest.mark.parametrize(
    ("how", "why"),
    [
        ({"emergency_stop": True}, "stopped by an order"),
        ({"disarm": True}, "stopped by an order"),
        ({"force_disarm": True}, "stopped by an order"),
        ({"silent_s": 1.8}, "no motion command for"),
    ],
    ids=["emergency stop", "disarm", "forced disarm", "silence"],
)
def test_it_is_stopped_on_its_way_and_found_by_the_next_order(
    rides: Ridden, robot: AnyRobot, how: dict[str, object], why: str
) -> None:
    one = rides(
        HOME,
        step(3.3, **how),
        step(5.5, clear=True),
        step(5.7, arm=True),
        step(7.0, home=["steering"]),
        seconds=14,
        robot=robot,
        stands=False,
    )
    on_its_way(one, 3.25)
    stays(one, 4.2, 5.4)
    assert why in " | ".join(one.held("not homed: steer"))
    one.runs_until(12.5)
    assert not {"not homed: steer", "reference lost: steer"} & one.holding
    assert steer_deg(one) == pytest.approx(-END_DEG, abs=0.5)
    assert kept_back(one) == []


def test_the_end_of_the_program_ends_a_homing_in_good_order(rides: Ridden) -> None:
    one = rides(HOME, seconds=12, robot=ALONE, stands=False)
    on_its_way(one, 3.25)
    one.ends()
    stays(one, 3.8, 8.0)
    assert one.rig.bridge.finished
    assert one.rig.bridge.not_acknowledged == ()
    assert kept_back(one) == []


def test_a_drive_that_is_cut_off_stops_by_itself(rides: Ridden) -> None:
    one = rides(
        HOME,
        seconds=12,
        robot=ALONE,
        stands=False,
        faults=[fault("can_cut", 3.3, between=["right", "steer"])],
    )
    on_its_way(one, 3.25)
    stays(one, 4.0, 6.0)


def test_a_drive_that_gives_its_homing_up_has_no_zero(rides: Ridden) -> None:
    """So fast against the stop its following error is too large before its current is."""
    fast = BY_ITSELF.replace("speed = 1.0", "speed = 4.5")
    one = rides(
        HOME,
        seconds=12,
        robot=homed(None, fast.replace("current_a = 0.35", "current_a = 3.0")),
        stands=False,
    )
    one.runs_until(9.0)
    assert {"not homed: steer", "reference lost: steer"} <= one.holding
    assert "it gave its homing up" in " | ".join(one.held("not homed"))


def test_an_encoder_that_stands_still_ends_it(rides: Ridden) -> None:
    """No one sees it move any more: it is stopped before its time is over."""
    one = rides(
        HOME, seconds=14, robot=ALONE, stands=False, faults=[fault("encoder_frozen", 3.3, node="steer")]
    )
    on_its_way(one, 3.25)
    one.runs_until(6.0)
    assert {"not homed: steer", "reference lost: steer"} <= one.holding


def test_a_plant_without_the_switch_is_refused() -> None:
    by_switch = LIFT.replace("method = -4 ", "method = 17 ").replace("current_a = 0.5", "#")
    with pytest.raises(RobotFileError, match="the plant has no output 'negative_limit_lift'"):
        devices(homed(by_switch))
