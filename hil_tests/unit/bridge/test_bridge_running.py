"""Running: the cycle's order and times, the set-points, and what the operator's requests do."""

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.bridge import Phase
from firmware_bridge.teleop.mavlink import dialect
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.cia402 import State
from firmware_bridge.wire.epos2 import address as at

if TYPE_CHECKING:
    from hil_tests.unit.bridge.conftest import Bench

ACCEPTED, TEMPORARILY_REJECTED, DENIED = 0, 1, 2
ARM = dialect.MAV_CMD_COMPONENT_ARM_DISARM
SAFETY_SWITCH = dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
FORCE = 21196.0
STOP, CLEAR = 0.0, 1.0
METRES_PER_QC = 0.05 * 2.0 * 3.141592653589793 / 26.0 / 2000.0
RPM_AT_03 = 1490
"""0.3 m/s: 6 rad/s at the wheel, times 26, is 1490 rpm at the motor."""


@pytest.fixture
def armed(bench: "Bench") -> "Bench":
    bench.starts()
    assert bench.arms() == ACCEPTED
    return bench


def driving(bench: "Bench", speed: float = 0.3) -> None:
    bench.speed = speed
    bench.runs(1)


def test_a_cycle_is_sync_then_four_answers_then_four_set_points(armed: "Bench") -> None:
    begin = armed.now
    armed.runs(0.2)
    cycle = [p.address for now, _, p in armed.frames if now > begin]
    first = cycle.index(0x080)
    assert cycle[first : first + 10] == [
        0x080, 0x281, 0x282, 0x283, 0x284, 0x764, 0x501, 0x502, 0x403, 0x404,
    ]  # fmt: skip


def test_sync_comes_every_50_ms(armed: "Bench") -> None:
    armed.runs(2)
    times = [now for now, _ in armed.sent(0x080)]
    assert {later - earlier for earlier, later in pairwise(times)} == {50 * MILLISECOND}


def test_without_an_answer_the_set_points_leave_10_ms_after_sync(armed: "Bench") -> None:
    armed.drives["lift"].silent = True
    begin = armed.now
    armed.runs(0.2)
    sync = next(now for now, _ in armed.sent(0x080, begin))
    set_point = next(now for now, _ in armed.sent(0x501, begin))
    assert 10 * MILLISECOND <= set_point - sync < 11 * MILLISECOND


def test_the_wheels_ramp_to_the_wished_speed_and_no_faster_than_the_limit(armed: "Bench") -> None:
    begin = armed.now
    driving(armed)
    targets = [target for word, target in armed.words("left", begin) if word == 0x000F]
    assert targets[-1] == RPM_AT_03
    # 1.41 m/s2 for 50 ms are 351 rpm at the motor.
    assert max(later - earlier for earlier, later in pairwise(targets)) <= 351


def test_the_wheels_follow_the_angle_that_is_steered_not_the_one_that_is_wished(armed: "Bench") -> None:
    armed.drives["steer"].jammed = True
    armed.steer = 30.0
    driving(armed)
    begin = armed.now
    armed.runs(0.2)
    assert {target for _, target in armed.words("left", begin)} == {RPM_AT_03}
    assert {target for _, target in armed.words("right", begin)} == {RPM_AT_03}


def test_in_a_turn_the_outer_wheel_is_faster_by_the_geometry(armed: "Bench") -> None:
    armed.steer = 30.0
    driving(armed)
    left = armed.drives["left"].rpm
    right = armed.drives["right"].rpm
    # R = 0.105 + 0.515 cot 30 = 0.997 m, half the track 0.2 m (2.13), (4.10), (4.11).
    assert right / left == pytest.approx((0.997 + 0.2) / (0.997 - 0.2), rel=0.002)
    assert left + right == pytest.approx(2 * RPM_AT_03, abs=2)


def test_the_set_point_bit_rises_at_a_new_position_and_falls_25_ms_later(armed: "Bench") -> None:
    armed.runs(0.1)
    armed.steer = 10.0
    begin = armed.now
    armed.runs(0.2)
    frames = [(now, word) for now, word, _ in armed.drives["steer"].words if now >= begin]
    risen = next(i for i, (_, word) in enumerate(frames) if word == 0x003F)
    assert [word for _, word in frames[risen:]][:4] == [0x003F, 0x000F, 0x000F, 0x000F]
    sync = max(now for now, _ in armed.sent(0x080) if now < frames[risen][0])
    assert 25 * MILLISECOND <= frames[risen + 1][0] - sync < 26 * MILLISECOND


def test_not_armed_the_steering_is_told_to_halt_where_it_was(bench: "Bench") -> None:
    bench.starts()
    bench.steer = 20.0
    begin = bench.now
    bench.runs(0.3)
    assert set(bench.words("steer", begin)) == {(0x010F, 0)}


def test_a_silent_operator_trips_at_half_a_second_sharp(armed: "Bench") -> None:
    driving(armed)
    heard_at = armed.bridge._pipeline.known(armed.now).intent.heard_at  # noqa: SLF001 - the instant itself
    armed.talks = False
    armed.runs(0.6)
    slower = next(now for now, word, rpm in armed.drives["left"].words if now > heard_at and rpm < RPM_AT_03)
    assert 500 * MILLISECOND < slower - heard_at < 501 * MILLISECOND
    assert "no motion command for 0.50 s" in armed.told()


def test_a_silent_operator_brings_the_wheels_to_rest_and_they_stay_enabled(armed: "Bench") -> None:
    driving(armed)
    armed.talks = False
    armed.runs(1.0)
    assert armed.drives["left"].rpm == 0
    assert armed.drives["left"].state is State.OPERATION_ENABLED


def test_odometry_counts_what_the_wheels_rolled(armed: "Bench") -> None:
    driving(armed)
    armed.speed = 0.0
    armed.runs(0.5)
    pose = armed.bridge._pipeline.known(armed.now).pose  # noqa: SLF001 - before telemetry rounds it
    assert pose.x_m == pytest.approx(armed.drives["left"].position * METRES_PER_QC, abs=1e-4)
    assert pose.y_m == pytest.approx(0.0, abs=1e-4)


def test_the_battery_is_read_once_a_second(armed: "Bench") -> None:
    begin = armed.now
    armed.runs(3)
    asked = [payload for _, payload in armed.sent(0x601, begin)]
    assert asked == ["40 7c 20 01 00 00 00 00"] * 3
    told = [m.voltages[0] for m in armed.station.heard if m.get_type() == "BATTERY_STATUS"]
    assert told[-1] == 24_600


def test_a_battery_that_cannot_be_read_blocks_nothing(armed: "Bench") -> None:
    del armed.drives["left"].memory[at.ANALOGUE_INPUT_1]
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03
    armed.runs(3)
    told = [m.voltages[0] for m in armed.station.heard if m.get_type() == "BATTERY_STATUS"]
    assert told[-1] == 0xFFFF


def test_arming_while_the_stick_is_deflected_is_denied(bench: "Bench") -> None:
    bench.starts()
    bench.speed = 0.2
    bench.runs(0.1)
    assert bench.arms() == DENIED
    assert "the stick asks for 0.20 m/s" in bench.told()


def test_arming_without_motion_commands_is_refused_by_name(bench: "Bench") -> None:
    bench.talks = False
    bench.starts()
    assert bench.arms() == TEMPORARILY_REJECTED
    assert "arm: no motion command has come yet" in bench.told()


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
    assert "enabling drive 1 (left rear wheel)" in armed.told()
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


def test_the_orderly_end_stops_disables_and_leaves(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    armed.stops()
    armed.runs(1.5)
    assert armed.bridge.finished
    words = [word for word, _ in armed.words("left", begin)]
    ramp = [rpm for word, rpm in armed.words("left", begin) if word == 0x000F]
    assert ramp == sorted(ramp, reverse=True)
    assert ramp[-1] == 0
    assert words[-2:] == [0x0006, 0x0000]
    for drive in armed.drives.values():
        assert drive.state is State.SWITCH_ON_DISABLED
        assert drive.memory[at.CONSUMER_HEARTBEAT_1] == bytes(4)
    assert [payload for _, payload in armed.sent(0x000, begin)] == [f"80 0{node}" for node in (1, 2, 3, 4)]


def test_a_finished_bridge_is_silent(armed: "Bench") -> None:
    armed.stops()
    armed.runs(1)
    begin = armed.now
    armed.runs(0.5)
    assert [sender for now, sender, _ in armed.frames if now > begin and sender == "bridge"] == []
    assert armed.bridge.wake(armed.now).sent == ()


def test_the_orderly_end_on_a_dead_bus_takes_no_longer_than_4_s(armed: "Bench") -> None:
    driving(armed)
    for drive in armed.drives.values():
        drive.silent = True
    armed.stops()
    armed.runs(4)
    assert armed.bridge.phase is Phase.FINISHED


def test_a_late_wake_skips_cycles_instead_of_running_them_in_a_row(armed: "Bench") -> None:
    late = armed.now + SECOND
    reaction = armed.bridge.wake(late)
    assert [packet.address for packet in reaction.sent].count(0x080) == 1
    assert late < reaction.wake_at <= late + 50 * MILLISECOND
