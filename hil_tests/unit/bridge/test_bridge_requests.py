"""What the operator's requests do, and what takes the leave to move away."""

from itertools import pairwise
from typing import TYPE_CHECKING

from firmware_bridge.teleop.mavlink import dialect
from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.cia402 import State
from firmware_bridge.wire.epos2 import address as at
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, DENIED, RPM_AT_03, TEMPORARILY_REJECTED, driving

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

SAFETY_SWITCH = dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
FORCE = 21196.0
STOP, CLEAR = 0.0, 1.0


def test_arming_while_the_stick_is_deflected_is_denied(bench: "Bench") -> None:
    bench.starts()
    bench.speed = 0.2
    bench.runs(0.1)
    assert bench.arms() == DENIED
    assert "the base would move at once; let the stick go" in bench.told()


def test_a_station_may_arm_before_it_speaks_of_motion(bench: "Bench") -> None:
    bench.talks = False
    bench.starts()
    assert bench.arms() == ACCEPTED
    assert "no motion command has come yet" in bench.told()


def test_disarming_while_driving_is_refused(armed: "Bench") -> None:
    driving(armed)
    assert armed.commands(ARM, 0.0) == TEMPORARILY_REJECTED
    armed.runs(0.2)
    assert armed.drives["left"].rpm == RPM_AT_03


def test_disarming_at_rest_keeps_power_on_and_holds_still(armed: "Bench") -> None:
    assert armed.commands(ARM, 0.0) == ACCEPTED
    begin = armed.now
    armed.speed = 0.3
    armed.runs(0.5)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}


def test_a_forced_disarm_takes_the_power_off_at_once(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    assert armed.commands(ARM, 0.0, FORCE) == ACCEPTED
    assert armed.now - begin <= MILLISECOND
    assert {drive.state for drive in armed.drives.values()} == {State.SWITCH_ON_DISABLED}
    after = armed.now
    armed.runs(0.5)
    assert {word for name in armed.drives for word, _ in armed.words(name, after)} == {0x0000}


def test_after_a_forced_disarm_arming_enables_again_and_is_asked_for_twice(armed: "Bench") -> None:
    armed.commands(ARM, 0.0, FORCE)
    armed.runs(0.2)
    assert armed.arms() == TEMPORARILY_REJECTED
    assert "enabling node 1 (left rear wheel)" in armed.told()
    armed.runs(0.5)
    assert {drive.state for drive in armed.drives.values()} == {State.OPERATION_ENABLED}
    assert armed.arms() == ACCEPTED


def test_an_emergency_stop_ramps_down_then_latches_a_quick_stop(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    assert armed.commands(SAFETY_SWITCH, STOP) == ACCEPTED
    armed.runs(1)
    words = armed.words("left", begin)
    ramp = [rpm for word, rpm in words if word == 0x000F]
    assert ramp == sorted(ramp, reverse=True)
    assert max(earlier - later for earlier, later in pairwise([RPM_AT_03, *ramp])) <= 351
    assert words[-1] == (0x000B, 0)
    assert {drive.state for drive in armed.drives.values()} == {State.QUICK_STOP_ACTIVE}


def test_an_emergency_stop_is_left_by_clearing_and_arming(armed: "Bench") -> None:
    armed.commands(SAFETY_SWITCH, STOP)
    armed.runs(0.2)
    assert armed.arms() == DENIED
    assert "the emergency stop is latched" in armed.told()
    assert armed.commands(SAFETY_SWITCH, CLEAR) == ACCEPTED
    armed.runs(0.2)
    assert armed.drives["left"].state is State.QUICK_STOP_ACTIVE
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(0.2)
    assert armed.arms() == ACCEPTED
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03


def test_a_final_emergency_stop_cannot_be_cleared(armed: "Bench") -> None:
    armed.commands(dialect.MAV_CMD_DO_FLIGHTTERMINATION, 1.0)
    armed.runs(0.2)
    assert armed.commands(SAFETY_SWITCH, CLEAR) == DENIED
    assert armed.arms() == DENIED


def test_a_fault_stops_the_others_and_takes_the_leave_away(armed: "Bench") -> None:
    driving(armed)
    armed.inject("steer", armed.drives["steer"].fails(0x8611))
    armed.runs(1)
    assert armed.drives["left"].rpm == armed.drives["right"].rpm == 0
    assert "node 3 (steering) reports fault 0x8611" in armed.told()
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(0.5)
    assert armed.drives["steer"].state is State.OPERATION_ENABLED
    begin = armed.now
    armed.speed = 0.3
    armed.runs(0.3)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}, "motion needs a new arm"
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.arms() == ACCEPTED


def test_a_faulted_drive_is_never_told_to_move(armed: "Bench") -> None:
    driving(armed)
    armed.inject("left", armed.drives["left"].fails(0x2310))
    begin = armed.now
    armed.runs(0.5)
    assert set(armed.words("left", begin)) == {(0x000B, 0)}


def test_a_silent_drive_stops_the_robot_and_is_named(armed: "Bench") -> None:
    driving(armed)
    armed.drives["lift"].silent = True
    armed.runs(0.8)
    assert armed.drives["left"].rpm == 0
    assert "node 4 (scissor lift)" in armed.told()


def test_a_drive_that_restarted_is_set_up_again_when_armed(armed: "Bench") -> None:
    armed.inject("right", armed.drives["right"].boots())
    armed.runs(0.5)
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(1)
    assert armed.drives["right"].memory[at.CONSUMER_HEARTBEAT_1] == bytes.fromhex("c8006400")
    assert armed.drives["right"].state is State.OPERATION_ENABLED
    assert armed.arms() == ACCEPTED
