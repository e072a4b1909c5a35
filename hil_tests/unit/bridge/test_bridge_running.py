"""Running: the cycle's order and times, the set-points, the lift, and the orderly end."""

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.scale import Scale
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.motion.scissor import screw_from_height
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.plausibility import Plausibility
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, RPM_AT_03, driving

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.bridge.bench import Bench

METRES_PER_QC = 0.05 * 2.0 * 3.141592653589793 / 26.0 / 2000.0


def test_a_cycle_is_sync_then_four_answers_then_four_set_points(armed: "Bench") -> None:
    begin = armed.now
    armed.runs(0.2)
    cycle = [p.address for now, _, p in armed.frames if now > begin]
    first = cycle.index(0x080)
    # A wheel's quick stop deceleration goes ahead of its set-point.
    assert cycle[first : first + 12] == [
        0x080, 0x281, 0x282, 0x283, 0x284, 0x764, 0x201, 0x501, 0x202, 0x502, 0x403, 0x404,
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


def test_the_wheels_ramp_to_the_commanded_speed_and_no_faster_than_the_limit(armed: "Bench") -> None:
    begin = armed.now
    driving(armed)
    targets = [target for word, target in armed.words("left", begin) if word == 0x000F]
    assert targets[-1] == RPM_AT_03
    # 1.41 m/s2 for 50 ms are 351 rpm at the motor.
    assert max(later - earlier for earlier, later in pairwise(targets)) <= 351


def test_the_wheels_follow_the_angle_that_is_steered_not_the_one_that_is_commanded(armed: "Bench") -> None:
    driving(armed)
    armed.drives["steer"].jammed = True
    armed.steer = 30.0
    armed.runs(0.05)
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


def test_not_armed_the_steering_is_commanded_to_halt_where_it_was(started: "Bench") -> None:
    started.steer = 20.0
    begin = started.now
    started.runs(0.3)
    assert set(started.words("steer", begin)) == {(0x010F, 0)}


def test_a_silent_operator_trips_at_half_a_second_sharp(armed: "Bench") -> None:
    driving(armed)
    received_at = armed.bridge.seen.facts.received_at
    armed.talks = False
    armed.runs(0.6)
    slower = next(
        now for now, word, rpm in armed.drives["left"].words if now > received_at and rpm < RPM_AT_03
    )
    assert 500 * MILLISECOND < slower - received_at < 501 * MILLISECOND
    assert "no motion command for 0.50 s" in armed.reported()


def test_a_silent_operator_brings_the_wheels_to_rest_and_they_stay_enabled(armed: "Bench") -> None:
    driving(armed)
    armed.talks = False
    armed.runs(1.0)
    assert armed.drives["left"].rpm == 0
    assert armed.drives["left"].state is PowerState.OPERATION_ENABLED


def test_odometry_counts_what_the_wheels_rolled(armed: "Bench") -> None:
    driving(armed)
    armed.speed = 0.0
    armed.runs(0.5)
    pose = armed.bridge.seen.pose
    assert pose.x_m == pytest.approx(armed.drives["left"].position * METRES_PER_QC, abs=1e-4)
    assert pose.y_m == pytest.approx(0.0, abs=1e-4)


def test_the_battery_is_read_once_a_second(armed: "Bench") -> None:
    begin = armed.now
    armed.runs(3)
    requested = [payload for _, payload in armed.sent(0x601, begin)]
    assert requested == ["40 7c 20 01 00 00 00 00"] * 3
    reported = [m.voltages[0] for m in armed.station.received if m.get_type() == "BATTERY_STATUS"]
    assert reported[-1] == 24_600


def test_a_battery_that_cannot_be_read_blocks_nothing(armed: "Bench") -> None:
    del armed.drives["left"].memory[at.ANALOGUE_INPUT_1]
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03
    armed.runs(3)
    reported = [m.voltages[0] for m in armed.station.received if m.get_type() == "BATTERY_STATUS"]
    assert reported[-1] == 0xFFFF


def test_the_orderly_end_stops_disables_and_leaves(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    armed.stops()
    armed.runs(3.5)
    assert armed.bridge.finished
    words = [word for word, _ in armed.words("left", begin)]
    ramp = [rpm for word, rpm in armed.words("left", begin) if word == 0x000F]
    assert ramp == sorted(ramp, reverse=True)
    assert ramp[-1] == 0
    assert words[-2:] == [0x0006, 0x0000]
    for drive in armed.drives.values():
        assert drive.state is PowerState.SWITCH_ON_DISABLED
        assert drive.memory[od.CONSUMER_HEARTBEAT_1] == bytes(4)
    assert [payload for _, payload in armed.sent(0x000, begin)] == [f"80 0{node}" for node in (1, 2, 3, 4)]


def test_a_finished_bridge_is_silent(armed: "Bench") -> None:
    armed.stops()
    armed.runs(3)
    begin = armed.now
    armed.runs(0.5)
    assert [sender for now, sender, _ in armed.frames if now > begin and sender == "bridge"] == []
    assert armed.bridge.wake(armed.now).sent == ()


def test_the_orderly_end_on_a_dead_bus_takes_no_longer_than_4_s(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    for drive in armed.drives.values():
        drive.silent = True
    armed.stops()
    armed.runs(4)
    assert armed.bridge.phase is Life.FINISHED
    # Their watch stays on: no report has confirmed that they powered down.
    assert armed.bridge.not_acknowledged == tuple(drive.axis.called for drive in armed.drives.values())
    written = [payload for node in (1, 2, 3, 4) for _, payload in armed.sent(0x600 + node, begin)]
    assert [payload for payload in written if payload[3:8] == "16 10"] == []


@pytest.mark.parametrize("before_s", [0.0, 0.4, 6.0])
def test_a_robot_that_stands_is_not_held_for_drives_that_are_gone(armed: "Bench", before_s: float) -> None:
    """Gone at once, while its stop is escalated, or after each of its steps."""
    armed.runs(1)
    for drive in armed.drives.values():
        drive.silent = True
    armed.runs(before_s)
    armed.stops()
    armed.runs(6)
    assert armed.bridge.phase is Life.FINISHED
    assert armed.bridge.not_acknowledged == tuple(drive.axis.called for drive in armed.drives.values())


def test_a_late_wake_skips_cycles_instead_of_running_them_in_a_row(armed: "Bench") -> None:
    late = armed.now + SECOND
    reaction = armed.bridge.wake(late)
    assert [packet.address for packet in reaction.sent].count(0x080) == 1
    assert late < reaction.wake_at <= late + 50 * MILLISECOND


class FailsWhenReported(Bridge):
    """A bridge with a fault of its own in the pipeline."""

    fails = False

    def _run(self, now: Nanoseconds) -> None:
        if self.fails:
            raise ZeroDivisionError
        super()._run(now)


@pytest.mark.interpreted
def test_an_exception_in_the_pipeline_ends_in_the_same_orderly_stop(
    bench_with: "Callable[[Bridge], Bench]", robot: AnyRobot
) -> None:
    bridge = FailsWhenReported(robot, ROBOT_TYPE)
    bench = bench_with(bridge)
    bench.starts()
    bench.arms()
    driving(bench)
    begin = bench.now
    bridge.fails = True
    bench.runs(3.5)
    assert isinstance(bench.carrier.failed, ZeroDivisionError)
    assert bridge.finished
    ramp = [rpm for word, rpm in bench.words("left", begin) if word == 0x000F]
    assert max(earlier - later for earlier, later in pairwise([RPM_AT_03, *ramp])) <= 351
    assert {drive.state for drive in bench.drives.values()} == {PowerState.SWITCH_ON_DISABLED}


def lift_height(bench: "Bench") -> float:
    height: float | None = bench.bridge.seen.body.lift_m
    assert height is not None
    return height


def test_the_lift_follows_its_stick_at_the_rate_and_rests_when_it_is_let_go(armed: "Bench") -> None:
    armed.lift = 1.0
    armed.runs(2)
    risen = lift_height(armed)
    assert risen == pytest.approx(2 * 0.10, abs=0.02)
    armed.lift = None
    armed.runs(0.1)
    begin = armed.now
    stood = lift_height(armed)
    armed.runs(0.5)
    assert {word for word, _ in armed.words("lift", begin)} == {0x010F}
    assert lift_height(armed) == stood == pytest.approx(risen, abs=0.01)


def test_the_lift_goes_to_a_height_no_faster_than_its_rate_and_arrives(armed: "Bench") -> None:
    assert armed.commands(dialect.MAV_CMD_DO_SET_ACTUATOR, -0.8) == ACCEPTED
    armed.runs(0.5)
    assert lift_height(armed) < 0.06
    armed.runs(1.5)
    # A tenth of 1116 mm: 6 x 300 mm x (sin 45 - sin 5).
    assert lift_height(armed) == pytest.approx(0.1116, abs=0.001)


def test_a_lift_that_cannot_follow_is_not_left_behind(bench_with: "Callable[[Bridge], Bench]") -> None:
    # Of a robot that is patient with it.
    rars = find("rars")
    patient = [axis.model_copy(update={"plausibility": Plausibility(within_ms=10_000)}) for axis in rars.axes]
    armed = bench_with(Bridge(rars.model_copy(update={"axes": tuple(patient)}), ROBOT_TYPE))
    armed.starts()
    assert armed.arms() == ACCEPTED
    armed.drives["lift"].jammed = True
    armed.lift = 1.0
    armed.runs(3)
    target = armed.drives["lift"].words[-1][2]
    # 30 mm above collapsed are 0.3 s at 0.10 m/s.
    assert Scale.of(armed.robot.axis("lift")).counts(
        screw_from_height(armed.robot.geometry.lift, 0.030)
    ) == pytest.approx(target, abs=2)


def test_with_the_lift_extended_the_robot_can_be_armed_but_not_driven(armed: "Bench") -> None:
    armed.lift = 1.0
    armed.runs(1)
    armed.lift = None
    armed.runs(0.5)
    armed.commands(ARM, 0.0)
    assert armed.arms() == ACCEPTED
    begin = armed.now
    driving(armed)
    assert {target for _, target in armed.words("left", begin)} == {0}
    assert "the lift stands at" in armed.reported()


def test_telemetry_reaches_the_station(armed: "Bench") -> None:
    driving(armed)
    armed.station.received.clear()
    armed.runs(1)
    (odometry, *_) = [m for m in armed.station.received if m.get_type() == "ODOMETRY"]
    assert odometry.vx == pytest.approx(0.3, abs=0.001)
