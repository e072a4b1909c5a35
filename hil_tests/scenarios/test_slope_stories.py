"""Stories of slopes: power goes only where the robot stands by itself, by the plant's truth."""

import math
from typing import Final

import pytest

from emulators.epos2.drive import Epos2
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.bridge import Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

RARS: Final[AnyRobot] = find("rars")
GRIP: Final = 0.9
"""On the thesis's own floor the robot slides at 10 degrees with its wheels standing: no drive holds that."""
ALLOWED_M: Final = 0.020
BRAKED: Final = (step(4.0, speed_mps=0.2), step(4.5, speed_mps=0.0))
DOWNHILL: Final = (step(4.0, speed_mps=-0.2), step(4.5, speed_mps=0.0))
RAISED: Final = (step(4.0, lift_m=0.2),)
STOPPED_S: Final = 5.5
STOPPED: Final = step(STOPPED_S, emergency_stop=True)
POWERED: Final = {PowerState.OPERATION_ENABLED, PowerState.QUICK_STOP_ACTIVE}

on_each_link = pytest.mark.parametrize("serial", [False, True], ids=["can", "serial"])


def on_slope(degrees: float, *, serial: bool = False) -> AnyRobot:
    """RARS, uphill ahead, on a floor that grips."""
    plant = RARS.plant.model_copy(
        update={"parameters": {"slope": math.radians(degrees), "floor_friction": GRIP}}
    )
    robot = RARS.model_copy(update={"plant": plant})
    return over_serial(robot) if serial else robot


def on_level(*, serial: bool) -> AnyRobot:
    """RARS on the thesis's own floor."""
    return over_serial(RARS) if serial else RARS


def states(one: Ride) -> set[PowerState | None]:
    """Return the drives' own states, whether reported or not."""
    return {state_of(device.store.get(od.STATUSWORD)) for device in one.rig.devices.nodes(Epos2).values()}


def powered(one: Ride) -> list[bool]:
    return [bool(axis.powered) for axis in one.rig.devices.axes]


def went(one: Ride, since_s: float) -> float:
    """The furthest that the robot has gone from where it was then, up or down, m."""
    rows = one.rows(since_s, 1e6)
    return max(abs(row["x_m"] - rows[0]["x_m"]) for row in rows)


@pytest.mark.long(keeps=["0-before0-False-False", "10-before5-False-True"])
@pytest.mark.parametrize(
    ("degrees", "before", "serial", "held"),
    [
        (0, BRAKED, False, False),
        (2, BRAKED, False, True),
        (2, DOWNHILL, False, True),
        (5, DOWNHILL, False, True),
        (-5, BRAKED, False, True),
        (10, BRAKED, False, True),
        (0, DOWNHILL, True, False),
        (10, DOWNHILL, True, True),
    ],
)
def test_an_emergency_stop_ends_without_power_where_the_robot_stands_by_itself(
    rides: Ridden, degrees: float, before: tuple[Step, ...], *, held: bool, serial: bool
) -> None:
    one = rides(ARMED, *before, STOPPED, seconds=20, robot=on_slope(degrees, serial=serial))
    one.runs_until(STOPPED_S + 3.0)
    assert went(one, STOPPED_S) < 0.001
    if held:
        assert states(one) == {PowerState.QUICK_STOP_ACTIVE}
        assert "held with power" in one.holding
        assert "on a slope: held with power" in one.held("held with power")[0]
    else:
        assert not any(powered(one))
        assert one.held("held with power") == []
    assert not one.now["armed"]
    assert one.rig.guard.refused == 0


SPEEDS: Final = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)


@pytest.mark.long(keeps=["0.35-30-can"])
@on_each_link
@pytest.mark.parametrize("steered", [0, 30])
@pytest.mark.parametrize("speed", [sign * speed for speed in SPEEDS for sign in (1, -1)])
def test_an_emergency_stop_on_the_level_is_not_taken_for_a_slope(
    rides: Ridden, speed: float, steered: int, *, serial: bool
) -> None:
    """Current that is left of the ramp, or was read before the standstill, holds nothing."""
    steers = (step(3.2, steer_deg=steered),) if steered else ()
    drives = step(5.2 if steered else 4.0, speed_mps=speed)
    at_s = drives.at_s + 3.0
    stops = step(at_s, emergency_stop=True)
    one = rides(ARMED, *steers, drives, stops, seconds=25, robot=on_level(serial=serial))
    one.runs_until(at_s + 6.0)
    assert one.held("held with power") == []
    assert not any(powered(one))


@pytest.mark.long(keeps=["2-0.3-serial", "10--0.5-can"])
@on_each_link
@pytest.mark.parametrize("speed", [0.0, 0.1, 0.3, 0.5, -0.1, -0.3, -0.5])
@pytest.mark.parametrize("degrees", [2, 5, 10, -2, -5, -10])
def test_an_emergency_stop_on_a_slope_holds_the_robot_however_it_drove(
    rides: Ridden, degrees: float, speed: float, *, serial: bool
) -> None:
    drives = (step(4.0, speed_mps=speed),) if speed else ()
    stops = step(6.0, emergency_stop=True)
    one = rides(ARMED, *drives, stops, seconds=20, robot=on_slope(degrees, serial=serial))
    one.runs_until(10.5)
    stood = one.now["x_m"]
    assert "held with power" in one.holding
    one.runs_until(13.5)
    assert powered(one)[:2] == [True, True]
    assert abs(one.now["x_m"] - stood) < ALLOWED_M


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_all_axes_let_go_together_and_steering_and_lift_not_before(rides: Ridden, *, serial: bool) -> None:
    steps = (step(4.0, speed_mps=0.4, steer_deg=20), step(5.0, emergency_stop=True))
    one = rides(ARMED, *steps, seconds=20, robot=on_slope(0, serial=serial))
    one.runs_until(5.0)
    seen = []
    while any(powered(one)):
        seen.append((sum(powered(one)), abs(one.now["speed_mps"])))
        one.runs(0.01)
    assert {count for count, speed in seen if speed > 0.01} == {4}
    # A serial line reports them one after the other.
    assert sum(count < 4 for count, _ in seen) <= (15 if serial else 0)


@pytest.mark.long(beside="test_an_end_on_a_shallow_slope_is_caught_when_it_rolls")
@pytest.mark.parametrize("degrees", [0.8, 1.5])
def test_what_friction_seemed_to_explain_is_caught_when_it_rolls(rides: Ridden, degrees: float) -> None:
    """It came to rest from above: friction holds part of the slope while the current is looked at."""
    one = rides(ARMED, *DOWNHILL, STOPPED, seconds=20, robot=on_slope(degrees))
    one.runs_until(STOPPED_S + 3.5)
    assert "moved when its power was disabled" in one.held("held with power")[0]
    assert powered(one) == [True, True, False, False], "what holds by itself is not given power again"
    assert 0.001 < went(one, STOPPED_S) < ALLOWED_M
    assert one.fastest(STOPPED_S + 3.0) < 0.003


@pytest.mark.long(keeps=["5"])
@pytest.mark.parametrize("degrees", [0, 5])
def test_a_raised_lift_keeps_its_height_with_and_without_power(rides: Ridden, degrees: float) -> None:
    one = rides(ARMED, *RAISED, step(7.0, emergency_stop=True), seconds=20, robot=on_slope(degrees))
    one.runs_until(7.0)
    before = one.now["lift_m"]
    assert before > 0.19
    one.runs_until(9.5)
    assert any(powered(one)) is (degrees == 5)
    assert one.now["lift_m"] == pytest.approx(before, abs=0.001)
    assert went(one, 7.0) < 0.001


def test_what_is_held_does_not_drive_and_is_armed_as_ever_once_cleared(rides: Ridden) -> None:
    after = (
        step(6.5, speed_mps=0.2),
        step(6.8, speed_mps=0.0),
        step(7.0, arm=True),
        step(7.5, clear=True),
        step(7.8, arm=True),
        step(8.4, arm=True),
        step(9.0, speed_mps=0.2),
    )
    one = rides(ARMED, *BRAKED, STOPPED, *after, seconds=20, robot=on_slope(5))
    one.runs_until(7.4)
    assert went(one, STOPPED_S) < 0.001
    assert not one.now["armed"]
    assert "held with power" in one.holding
    one.runs_until(8.8)
    assert one.now["armed"]
    assert one.held("held with power")
    assert "held with power" not in one.holding
    assert went(one, STOPPED_S) < 0.002
    one.runs_until(10.0)
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.02)


def test_a_forced_disarm_is_the_order_that_lets_a_held_robot_go(rides: Ridden) -> None:
    one = rides(ARMED, *BRAKED, STOPPED, step(7.0, force_disarm=True), seconds=20, robot=on_slope(5))
    one.runs_until(7.2)
    assert not any(powered(one))
    one.runs_until(9.5)
    assert not any(powered(one)), "nothing gives it power again"
    assert one.fastest(9.0, 9.5) > 0.5
    assert "held with power" not in one.holding


@pytest.mark.long(keeps=["can"])
@on_each_link
def test_a_forced_disarm_under_way_brakes_first(rides: Ridden, *, serial: bool) -> None:
    steps = (step(4.0, speed_mps=0.5), step(5.0, force_disarm=True))
    one = rides(ARMED, *steps, seconds=20, robot=on_slope(0, serial=serial))
    one.runs_until(7.0)
    assert went(one, 5.0) < 0.25
    assert one.stands_from(5.0, slower_than=0.01) < 5.8
    assert not any(powered(one))


@pytest.mark.long(keeps=["10-False"])
@pytest.mark.parametrize(("degrees", "serial"), [(10, False), (5, True)])
def test_ctrl_c_on_a_slope_holds_and_a_second_one_within_5_s_lets_go(
    rides: Ridden, degrees: float, *, serial: bool
) -> None:
    one = rides(ARMED, *BRAKED, seconds=30, robot=on_slope(degrees, serial=serial))
    one.runs_until(STOPPED_S)
    one.ends()
    one.runs_until(STOPPED_S + 6.0)
    bridge = one.rig.bridge
    assert bridge.phase is Life.STOPPING
    assert one.rig.guard.holding
    assert states(one) == {PowerState.QUICK_STOP_ACTIVE}
    assert went(one, STOPPED_S) < 0.001
    assert "held with power" in one.holding
    one.ends()
    one.runs(0.5)
    assert bridge.phase is Life.STOPPING, "more than 5 s after it was first held: it is a first one again"
    assert (
        "Ctrl-C within 5 s powers down"
        in {event.name: event.reason for event in bridge.interlock_events}["ending"]
    )
    assert went(one, STOPPED_S) < 0.001
    one.runs(4.0)
    one.ends()
    one.runs(1.0)
    assert bridge.not_acknowledged == ()
    assert one.rig.bridge.phase is Life.FINISHED
    assert not any(powered(one))
    assert {
        device.store.get(od.CONSUMER_HEARTBEAT_1) for device in one.rig.devices.nodes(Epos2).values()
    } == {0}


@pytest.mark.long(keeps=["0-False"])
@pytest.mark.parametrize(("degrees", "serial"), [(0, False), (0.3, False), (0, True)])
def test_ctrl_c_where_the_robot_stands_by_itself_ends_in_3_s(
    rides: Ridden, degrees: float, *, serial: bool
) -> None:
    one = rides(ARMED, *DOWNHILL, seconds=30, robot=on_slope(degrees, serial=serial))
    one.runs_until(STOPPED_S)
    one.ends()
    one.runs_until(STOPPED_S + 3.5)
    assert one.rig.bridge.finished
    assert not any(powered(one))
    assert went(one, STOPPED_S) < ALLOWED_M


def test_an_end_on_a_shallow_slope_is_caught_when_it_rolls(rides: Ridden) -> None:
    one = rides(ARMED, *DOWNHILL, seconds=30, robot=on_slope(1.5))
    one.runs_until(STOPPED_S)
    one.ends()
    one.runs_until(STOPPED_S + 3.5)
    assert one.rig.guard.holding
    assert went(one, STOPPED_S) < ALLOWED_M
    assert one.fastest(STOPPED_S + 3.0) < 0.003


def test_a_bridge_that_dies_on_a_slope_leaves_the_robot_to_roll(rides: Ridden) -> None:
    """As it is: the drives' own watch ends in a quick stop, then no torque, and the robot has no brakes."""
    one = rides(ARMED, *BRAKED, seconds=30, robot=on_slope(5))
    one.runs_until(STOPPED_S)
    one.rig.world.silence("bridge", one.rig.world.now)
    one.runs_until(STOPPED_S + 3.0)
    assert states(one) == {PowerState.FAULT}
    assert one.fastest(STOPPED_S + 2.9) > 0.5


@pytest.mark.interpreted
def test_a_driver_that_reports_no_current_keeps_the_power(
    rides: Ridden, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("firmware_bridge.families.epos2.driver.product.REPORTS", frozenset())
    one = rides(ARMED, *BRAKED, STOPPED, seconds=20, robot=on_slope(0))
    one.runs_until(STOPPED_S + 1.5)
    assert states(one) == {PowerState.QUICK_STOP_ACTIVE}
    reason = one.held("held with power")[0]
    assert reason == "held with power: the holding current of node 1 (left rear wheel) is not known"
