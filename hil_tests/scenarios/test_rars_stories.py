"""Stories on the whole bench: operator, bridge, bus, four drives, plant."""

import math
from typing import Final

import pytest

from emulators.bench.mission import Noise
from emulators.epos2.drive import Epos2
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.objects import STATUSWORD
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.motion import davis
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, step

STEERED: Final = 0.03
"""Largest error of the wheels' ratio while the rack crosses at 49 mm/s: at most 10 ms of its way, 1.2 % to
1.6 %, and as much for a regulator that overshoots (docs/decisions/motion-limits.md)."""


def test_the_robot_drives_where_the_operator_wants(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20)
    ride.runs_until(8.0)
    assert ride.now["speed_mps"] == pytest.approx(0.3, rel=0.01)
    assert ride.now["y_m"] == pytest.approx(0.0, abs=0.002)
    assert ride.now["x_m"] == pytest.approx(0.3 * 4.0, abs=0.15)


def test_nothing_moves_before_arming(rides: Ridden) -> None:
    ride = rides(step(3.0, speed_mps=0.3), step(3.5, steer_deg=30), step(4.0, lift_m=0.1), seconds=20)
    ride.runs_until(6.0)
    assert ride.fastest() < 1e-3
    assert abs(ride.now["steer_rad"]) < 1e-3
    assert ride.now["lift_m"] < 1e-4
    assert "not armed" in ride.holding


def test_a_silent_operator_brings_the_robot_to_rest(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.5), step(6.0, silent_s=10), seconds=30)
    ride.runs_until(8.0)
    assert ride.fastest(5.0, 6.0) == pytest.approx(0.5, rel=0.02)
    assert ride.now["speed_mps"] == pytest.approx(0, abs=0.002)
    assert "operator link timeout" in ride.holding
    assert ride.hardest() < 1.45


@pytest.mark.parametrize("speed", [0.1, -0.1])
def test_a_silent_operator_stops_a_slow_robot_within_0_6_s(rides: Ridden, speed: float) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=speed), step(6.0, silent_s=10), seconds=30)
    ride.runs_until(8.0)
    assert ride.stands_from(6.0) < 6.6


def test_a_motion_returns_with_the_operator_once_the_stick_was_let_go(rides: Ridden) -> None:
    back = (step(9.0, speed_mps=0.0), step(9.5, speed_mps=0.2))
    ride = rides(ARMED, step(4.0, speed_mps=0.2), step(5.0, silent_s=2), *back, seconds=30)
    ride.runs_until(8.9)
    assert ride.holding == {"stick not neutral"}
    assert ride.now["speed_mps"] == pytest.approx(0, abs=0.002)
    ride.runs_until(12.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert ride.holding == set()


def test_an_emergency_stop_latches_until_cleared_and_armed_again(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.5),
        step(6.0, emergency_stop=True),
        step(9.0, arm=True),
        step(10.0, speed_mps=0.0, clear=True),
        step(11.0, speed_mps=0.2),
        step(12.0, speed_mps=0.0),
        step(12.5, arm=True),
        step(14.5, speed_mps=0.2),
        seconds=30,
    )
    ride.runs_until(6.6)
    assert abs(ride.now["speed_mps"]) < 0.01
    ride.runs_until(12.4)
    assert ride.fastest(6.6, 12.4) < 0.01, "neither arming nor clearing alone lets it move"
    ride.runs_until(18.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert ride.hardest() < 1.45


def test_the_lift_rises_at_rest_only_and_holds_the_wheels(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.2),
        step(5.0, lift_m=0.1),
        step(6.0, speed_mps=0.0),
        step(12.0, speed_mps=0.2),
        step(14.0, speed_mps=0.0, lift_m=0.0),
        step(20.0, speed_mps=0.2),
        seconds=40,
    )
    ride.runs_until(6.0)
    assert ride.now["lift_m"] < 1e-3
    ride.runs_until(12.0)
    raised = ride.now["lift_m"]
    ride.runs_until(14.0)
    assert ride.fastest(12.0, 14.0) < 1e-3
    assert raised > 0.05
    assert ride.held("lift extended")
    ride.runs_until(24.0)
    assert ride.now["lift_m"] < 0.005
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)


@pytest.mark.long(keeps=["0-30", "58-0"])
@pytest.mark.parametrize(("begin", "end"), [(0, 10), (0, 30), (0, 58), (-30, 30), (58, 0)])
def test_the_wheels_follow_the_angle_that_is_steered(rides: Ridden, begin: float, end: float) -> None:
    """A step of the steering at 0.3 m/s: the plant's wheels keep the ratio of that instant's angle."""
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.3, steer_deg=begin),
        step(10.0, steer_deg=end),
        seconds=20,
    )
    ride.runs_until(16.0)
    base = find("rars").geometry.base
    half = base.rear_track_m / 2.0
    assert math.degrees(ride.now["steer_rad"]) == pytest.approx(end, abs=0.1)
    for row in ride.rows(9.9, 16.0):
        across = half * davis.curvature(base, row["steer_rad"])
        ratio = row["motor_speed_right_rad_s"] / row["motor_speed_left_rad_s"]
        assert ratio == pytest.approx((1.0 + across) / (1.0 - across), rel=STEERED), row.at
    now = ride.now
    turn = now["speed_mps"] * davis.curvature(base, now["steer_rad"])
    assert now["yaw_rate_rad_s"] == pytest.approx(turn, rel=0.02, abs=1e-3)


def test_a_drive_that_falls_silent_stops_the_robot_and_is_named(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20)
    ride.runs_until(6.0)
    ride.rig.world.silence("steer", from_seconds(6.0))
    ride.runs_until(8.0)
    assert abs(ride.now["speed_mps"]) < 0.002
    (reason,) = ride.held("axis timeout")[:1]
    assert "3" in reason
    assert "steering" in reason
    assert not ride.now["armed"], "a drive that was lost needs a new arm"


@pytest.mark.parametrize("lost", ["left", "right"])
def test_a_wheel_drive_that_is_cut_off_stops_by_its_own_watch(rides: Ridden, lost: str) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20)
    ride.runs_until(6.0)
    ride.rig.world.silence(lost, from_seconds(6.0))
    ride.runs_until(8.0)
    assert ride.stands_from(6.0, slower_than=0.005) < 7.0, "its tyres swing a little when the others let go"
    assert max(abs(ride.now[f"motor_speed_{wheel}_rad_s"]) for wheel in ("left", "right")) < 1.0


def test_the_drives_stop_by_themselves_when_the_bridge_dies(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.5), seconds=20)
    ride.runs_until(6.0)
    ride.rig.world.silence("bridge", from_seconds(6.0))
    ride.runs_until(8.0)
    # Without power it swings on its tyres for a second, by a tenth of a millimeter: nothing brakes an open
    # winding.
    assert ride.stands_from(6.0, slower_than=0.003) < 6.0 + 0.2 + 0.5 / 1.3 + 0.1
    assert ride.hardest(5.5, 8.0) < 1.45


def test_an_orderly_end_leaves_every_drive_without_power(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20)
    ride.runs_until(6.0)
    ride.ends()
    ride.runs_until(9.0)
    assert abs(ride.now["speed_mps"]) < 0.002
    for drive in ride.rig.devices.nodes(Epos2).values():
        state = state_of(drive.store.get(STATUSWORD))
        assert state in (PowerState.SWITCH_ON_DISABLED, PowerState.READY_TO_SWITCH_ON)


def test_a_forced_disarm_brakes_within_a_cycle_and_takes_the_power_off_at_rest(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.5), step(6.0, force_disarm=True), seconds=20)
    ride.runs_until(6.05)
    for drive in ride.rig.devices.nodes(Epos2).values():
        assert state_of(drive.store.get(STATUSWORD)) is PowerState.QUICK_STOP_ACTIVE, "within one cycle"
    began = ride.now["x_m"]
    ride.runs_until(7.0)
    assert ride.now["x_m"] - began < 0.14
    assert ride.stands_from(6.0, slower_than=0.01) < 6.5
    for drive in ride.rig.devices.nodes(Epos2).values():
        assert state_of(drive.store.get(STATUSWORD)) is PowerState.SWITCH_ON_DISABLED
    assert not ride.held("axis fault")
    assert ride.hardest() < 1.45
    assert max(abs(ride.now[f"current_{axis.name}_a"]) for axis in ride.rig.robot.axes) < 0.1


def test_two_runs_with_one_seed_are_the_same_bytes(rides: Ridden) -> None:
    def trace(seed: int) -> str:
        noise = Noise(stick=0.02, jitter_ms=20)
        ride = rides(ARMED, step(3.5, speed_mps=0.3, steer_deg=20), seconds=20, noise=noise, seed=seed)
        ride.runs_until(6.0)
        return ride.rig.world.trace_sha256

    assert trace(1) == trace(1)
    assert trace(1) != trace(2)


def test_the_bus_is_quiet_enough_for_its_cycle(rides: Ridden) -> None:
    """One cycle's frames take a small part of 50 ms: adding to a PDO shows here first."""
    ride = rides(ARMED, step(4.0, speed_mps=0.3, steer_deg=10), seconds=20)
    ride.runs_until(8.0)
    assert ride.rig.can_wire.load_percent() < 10
    assert to_seconds(ride.rig.world.now) == 8.0
