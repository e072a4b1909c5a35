"""Ground stations by the rules of their own source: QGroundControl, and those that are built on pymavlink.

Rules of QGroundControl (2026): MultiVehicleManager, InitialConnectStateMachine, StandardModes,
FirmwarePlugin (a generic autopilot), Vehicle, GuidedActionsController.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from pymavlink import mavutil

from firmware_bridge.intent import Arm, Disarm, EmergencyStop
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.bench import CYCLE, acks, target_message
from hil_tests.unit.teleop.stations import ARM, FORCE, Hand
from hil_tests.unit.teleop.test_channels import override

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

HERE, THERE = number_of("10.0.0.1", 14550), number_of("10.0.0.2", 14550)
ARMED_WITHIN = 1500 * MILLISECOND
"""Time that FirmwarePlugin::_armVehicleAndValidate waits for the heartbeat with the armed flag."""


class QGroundControl:
    """QGroundControl's view of the messages that it reads."""

    def __init__(self, bench: RarsBench) -> None:
        self.bench = bench
        self.armed = self.flying = False
        self.flight_mode = ""
        self._names: dict[int, str] = {}
        self._listed: list[Any] = []

    def reads(self, messages: list[Any]) -> list[Any]:
        for one in messages:
            match one.get_type():
                case "HEARTBEAT":
                    assert one.get_srcComponent() == dialect.MAV_COMP_ID_AUTOPILOT1
                    assert one.type not in (dialect.MAV_TYPE_GCS, dialect.MAV_TYPE_ONBOARD_CONTROLLER)
                    self.armed = bool(one.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)
                    self.flight_mode = self._names.get(one.custom_mode, f"Custom:{one.custom_mode:#x}")
                case "EXTENDED_SYS_STATE":
                    if one.landed_state == dialect.MAV_LANDED_STATE_ON_GROUND:
                        self.flying = False
                    elif one.landed_state in (
                        dialect.MAV_LANDED_STATE_TAKEOFF,
                        dialect.MAV_LANDED_STATE_IN_AIR,
                    ):
                        self.flying = True
                case "AVAILABLE_MODES":
                    self._listed.append(one)
                    if one.mode_index >= one.number_modes:
                        self._names = {mode.custom_mode: mode.mode_name for mode in self._listed}
        return messages

    def cycle(self) -> None:
        self.reads(self.bench.report())

    @property
    def shows_emergency_stop(self) -> bool:
        return self.armed and self.flying

    @property
    def shows_disarm(self) -> bool:
        return self.armed and not self.flying

    def connects(self) -> None:
        bench = self.bench
        bench.say(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        self.cycle()
        assert acks(self.reads(bench.order(512, 148))) == [(512, 0)]
        assert acks(self.reads(bench.order(512, 435))) == [(512, 0)]
        assert acks(bench.order(512, 397)) == [(512, 3)], "at once, so that it moves on"
        bench.say(dialect.MAVLink_param_request_list_message(1, 1))
        bench.say(dialect.MAVLink_mission_request_list_message(1, 1))


@pytest.fixture
def qgc(bench: RarsBench) -> QGroundControl:
    station = QGroundControl(bench)
    station.connects()
    return station


def test_it_connects_and_shows_the_mode_by_its_name(qgc: QGroundControl, bench: RarsBench) -> None:
    for _ in range(20):
        qgc.cycle()
    shown = [qgc.flight_mode]
    bench.facts = replace(bench.facts, paused=True)
    qgc.cycle()
    shown.append(qgc.flight_mode)
    assert shown == ["Manual", "Hold"]


def test_every_parameter_of_its_list_comes(bench: RarsBench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    seen = {one.param_index: one for _ in range(20) for one in bench.report() if hasattr(one, "param_index")}
    assert seen.keys() == set(range(next(iter(seen.values())).param_count))


def test_it_believes_that_the_robot_is_armed_in_time(qgc: QGroundControl, bench: RarsBench) -> None:
    bench.stick(y=0)
    assert acks(bench.order(ARM, 1)) == [(ARM, 0)]
    seen = []
    for _ in range(ARMED_WITHIN // CYCLE):
        qgc.cycle()
        seen.append(qgc.armed)
    assert all(seen), "from the next cycle on"


def test_its_screen_offers_a_stop_while_the_robot_is_armed_and_it_brakes(
    qgc: QGroundControl, bench: RarsBench
) -> None:
    shown = [qgc.shows_emergency_stop]
    bench.order(ARM, 1)
    qgc.cycle()
    shown.append(qgc.shows_emergency_stop)
    bench.requested.clear()
    assert acks(bench.order(ARM, 0, FORCE)) == [(ARM, 0)]
    assert bench.requested == [Disarm(force=True)], "which brakes first, and takes the power at rest"
    qgc.cycle()
    assert [*shown, qgc.shows_emergency_stop] == [False, True, False]
    assert not qgc.shows_disarm


def test_the_stop_on_the_screen_of_a_station_that_only_watches_brakes_too(bench: RarsBench) -> None:
    driver, watcher = Hand(bench, HERE), Hand(bench, THERE)
    driver.stick()
    driver.result(ARM, 1)
    bench.requested.clear()
    assert watcher.result(ARM, 0, FORCE) == 0
    assert bench.requested == [EmergencyStop()]


@pytest.mark.parametrize(
    ("pitch", "roll", "yaw", "thrust"), [(500, 0, -250, 0), (500, 0, -250, 500), (500, 700, -250, 1000)]
)
def test_its_joystick_drives_wherever_the_throttle_rests(
    bench: RarsBench, pitch: int, roll: int, yaw: int, thrust: int
) -> None:
    """Vehicle::sendJoystickDataThreadSafe: x pitch, y roll, z thrust from 0, r yaw."""
    bench.say(dialect.MAVLink_manual_control_message(1, pitch, roll, thrust, yaw, 0))
    assert bench.command.speed_mps == 0.25
    assert bench.command.steer_rad == pytest.approx(0.2618, abs=1e-4)
    assert bench.command.lift_rate_mps == 0.0


def test_its_own_action_of_a_file_stops(bench: RarsBench) -> None:
    """MavlinkAction: a command of a file, as docs/ground-stations.md has it."""
    bench.order(ARM, 1)
    bench.requested.clear()
    assert acks(bench.order(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0)) == [(5300, 0)]
    assert bench.requested == [EmergencyStop()]


@pytest.mark.parametrize(("number", "name"), [(0, "MANUAL"), (15, "GUIDED"), (4, "HOLD")])
def test_pymavlink_reads_the_mode_by_its_name_and_requests_it_so(
    bench: RarsBench, number: int, name: str
) -> None:
    """DroneKit raises an error at each heartbeat whose mode is not in this map."""
    numbers = mavutil.mode_mapping_byname(dialect.MAV_TYPE_GROUND_ROVER)
    assert numbers[name] == number
    bench.order(176, 1, numbers[name])
    bench.facts = replace(bench.facts, paused=name == "HOLD")
    assert mavutil.mode_string_v10(bench.reported(0)) == name


def test_what_dronekit_waits_for_comes_within_its_time(bench: RarsBench) -> None:
    """`connect(wait_ready=True)`: parameters, gps_0, armed, mode, attitude, in 30 s."""
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    received = {one.get_type() for _ in range(10 * SECOND // CYCLE) for one in bench.report()}
    assert {"PARAM_VALUE", "GPS_RAW_INT", "HEARTBEAT", "ATTITUDE", "VFR_HUD"} <= received


def test_dronekits_velocity_drives(bench: RarsBench) -> None:
    """send_body_ned_velocity of its guide: frame 9, mask 4039."""
    assert bench.say(target_message(0.2, mask=4039, frame=9)) == []
    assert bench.command.speed_mps == pytest.approx(0.2)


def test_dronekits_overrides_drive_and_are_given_back(bench: RarsBench) -> None:
    bench.say(override(ch3=1600))
    assert bench.command.speed_mps == pytest.approx(0.1)
    bench.say(dialect.MAVLink_rc_channels_override_message(1, 1, *(0,) * 8))
    assert (bench.command.speed_mps, bench.operator.intent.neutral) == (0.0, True)


def test_mavros_drives_by_velocity_in_the_robots_frame(bench: RarsBench) -> None:
    """setpoint_velocity with `mav_frame: BODY_NED`: frame 8, mask 1479; without it, frame 1."""
    assert bench.say(target_message(0.2, -0.1, mask=1479)) == []
    assert bench.command.speed_mps == pytest.approx(0.2)
    bench.report()
    reported = bench.say(target_message(0.2, -0.1, mask=1479, frame=1))
    assert "frame 1; only body frames 8, 9 and 12: it cannot go sideways" in "".join(
        one.text for one in reported
    )


def test_arming_needs_no_more_than_it_did(bench: RarsBench) -> None:
    bench.order(ARM, 1)
    assert bench.requested == [Arm()]


def test_mavproxy_reads_of_no_fence_that_is_breached(bench: RarsBench) -> None:
    """Its fence module takes a geofence without its health for one that has been left, present or not."""
    status = bench.reported(1)
    assert status.onboard_control_sensors_health & dialect.MAV_SYS_STATUS_GEOFENCE
    assert not status.onboard_control_sensors_present & dialect.MAV_SYS_STATUS_GEOFENCE
