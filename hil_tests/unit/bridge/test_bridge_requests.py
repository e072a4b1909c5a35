"""Effects of the operator's requests, and the loss of the motion permission."""

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, DENIED, RPM_AT_03, TEMPORARILY_REJECTED, driving

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

SAFETY_SWITCH = dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
PAUSE = dialect.MAV_CMD_DO_PAUSE_CONTINUE
FORCE = 21196.0
STOP, CLEAR = 0.0, 1.0


def test_arming_while_the_stick_is_deflected_is_denied(started: "Bench") -> None:
    started.speed = 0.2
    started.runs(0.1)
    assert started.arms() == DENIED
    assert "arm: x stands at 400: this robot wants 0" in started.reported()


def test_a_station_may_arm_before_it_speaks_of_motion(bench: "Bench") -> None:
    bench.talks = False
    bench.starts()
    assert bench.arms() == ACCEPTED
    assert "no motion command has come yet" in bench.reported()


def ramped_down(bench: "Bench", since: int) -> bool:
    """Return True if the left wheel's set-points ramp down to 0 by the robot's deceleration, with power."""
    words = bench.words("left", since)
    rpm = [RPM_AT_03, *(target for _, target in words)]
    steps = [earlier - later for earlier, later in pairwise(rpm)]
    return (
        {word for word, _ in words} == {0x000F} and rpm[-1] == 0 and all(0 <= step <= 351 for step in steps)
    )


@pytest.mark.parametrize(
    ("command", "params"),
    [
        (ARM, (0.0,)),
        (dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,)),
        (dialect.MAV_CMD_OVERRIDE_GOTO, (0.0, 2.0)),
        (dialect.MAV_CMD_DO_SET_MODE, (1.0, 4.0)),
        (dialect.MAV_CMD_DO_SET_MODE, (1.0, 4.0, 3.0)),
        (dialect.MAV_CMD_DO_SET_MODE, (1.0, 11.0)),
        (dialect.MAV_CMD_DO_SET_STANDARD_MODE, (1.0,)),
        (dialect.MAV_CMD_DO_SET_STANDARD_MODE, (5.0,)),
    ],
)
def test_every_way_to_ask_for_a_stop_stops_at_the_ramp(
    armed: "Bench", command: int, params: tuple[float, ...]
) -> None:
    driving(armed)
    begin = armed.now
    armed.commands(command, *params)
    armed.runs(1)
    assert ramped_down(armed, begin), "the stick still commands 0.3 m/s"


def test_a_disarmed_robot_needs_a_new_arm(armed: "Bench") -> None:
    driving(armed)
    assert armed.commands(ARM, 0.0) == ACCEPTED
    armed.runs(1)
    begin = armed.now
    armed.speed = 0.0
    armed.runs(0.2)
    driving(armed)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}


def test_after_a_pause_the_robot_goes_on_when_it_is_requested_to_with_the_stick_let_go(
    armed: "Bench",
) -> None:
    driving(armed)
    armed.commands(PAUSE, 0.0)
    armed.runs(1)
    assert armed.commands(PAUSE, 1.0) == DENIED
    assert "continue: x stands at" in armed.reported()
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.commands(PAUSE, 1.0) == ACCEPTED
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03


def test_arming_ends_a_pause(armed: "Bench") -> None:
    armed.commands(PAUSE, 0.0)
    armed.commands(ARM, 0.0)
    assert armed.arms() == ACCEPTED
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03


def test_the_steer_stick_is_let_go_before_arming_too(started: "Bench") -> None:
    started.steer = 30.0
    started.runs(0.1)
    assert started.arms() == DENIED
    started.steer = 0.0
    started.runs(0.1)
    assert started.arms() == ACCEPTED


def test_who_armed_before_he_spoke_of_motion_begins_with_the_stick_let_go(bench: "Bench") -> None:
    bench.talks = False
    bench.starts()
    assert bench.arms() == ACCEPTED
    begin = bench.now
    bench.talks = True
    driving(bench)
    assert set(bench.words("left", begin)) == {(0x000F, 0)}
    assert "not neutral since the timeout: x stands at 600" in bench.reported()
    bench.speed = 0.0
    bench.runs(0.3)
    driving(bench)
    assert bench.drives["left"].rpm == RPM_AT_03


def test_after_a_silence_nothing_moves_before_the_stick_was_let_go(armed: "Bench") -> None:
    driving(armed)
    armed.talks = False
    armed.runs(1.5)
    begin = armed.now
    armed.talks = True
    armed.runs(2)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}
    armed.speed = 0.0
    armed.runs(0.1)
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03, "a short silence needs no new arm"


def test_after_a_long_silence_motion_needs_a_new_arm(armed: "Bench") -> None:
    armed.talks = False
    reported = []
    for seconds in (9.9, 0.3):
        armed.runs(seconds)
        reported.append(armed.bridge.seen.facts.armed)
    assert reported == [True, False]
    assert "no station in control" in armed.reported()
    armed.talks = True
    armed.runs(0.5)
    begin = armed.now
    driving(armed)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.arms() == ACCEPTED


def test_a_lift_target_does_not_outlive_its_operators_link(armed: "Bench") -> None:
    armed.commands(dialect.MAV_CMD_DO_SET_ACTUATOR, 0.0)
    armed.runs(0.2)
    armed.talks = False
    armed.runs(1)
    begin = armed.now
    armed.talks = True
    armed.runs(1)
    assert len(set(armed.words("lift", begin))) == 1, "it stays where it stands"
    assert armed.bridge.seen.command.lift_m is None


def test_disarming_at_rest_keeps_power_on_and_holds_still(armed: "Bench") -> None:
    assert armed.commands(ARM, 0.0) == ACCEPTED
    begin = armed.now
    armed.speed = 0.3
    armed.runs(0.5)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}


def test_a_forced_disarm_at_rest_takes_the_power_off_at_once(armed: "Bench") -> None:
    begin = armed.now
    assert armed.commands(ARM, 0.0, FORCE) == ACCEPTED
    assert armed.now - begin <= MILLISECOND
    assert {drive.state for drive in armed.drives.values()} == {PowerState.SWITCH_ON_DISABLED}
    after = armed.now
    armed.runs(0.5)
    assert {word for name in armed.drives for word, _ in armed.words(name, after)} == {0x0000}


def test_a_forced_disarm_under_way_brakes_at_once_and_takes_the_power_off_at_rest(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    assert armed.commands(ARM, 0.0, FORCE) == ACCEPTED
    assert armed.now - begin <= MILLISECOND
    assert {drive.state for drive in armed.drives.values()} == {PowerState.QUICK_STOP_ACTIVE}
    assert armed.commands(ARM, 0.0, FORCE) == ACCEPTED, "a station repeats it"
    armed.runs(0.5)
    assert {drive.state for drive in armed.drives.values()} == {PowerState.SWITCH_ON_DISABLED}
    words = [word for word, _ in armed.words("left", begin)]
    assert words == sorted(words, reverse=True)
    assert set(words) == {0x000B, 0x0000}


def test_a_forced_disarm_takes_the_power_of_what_does_not_come_to_rest(armed: "Bench") -> None:
    """Within 3 s at the latest: an encoder that shows motion must not keep the power on."""
    driving(armed)
    left = armed.drives["left"]
    begin = armed.now
    assert armed.commands(ARM, 0.0, FORCE) == ACCEPTED
    while armed.now < begin + 3.1 * SECOND:
        left.position += 2_000.0
        armed.runs(0.05)
    assert {drive.state for drive in armed.drives.values()} == {PowerState.SWITCH_ON_DISABLED}


def test_after_a_forced_disarm_arming_enables_again_and_is_requested_twice(armed: "Bench") -> None:
    armed.commands(ARM, 0.0, FORCE)
    armed.runs(0.2)
    assert armed.arms() == TEMPORARILY_REJECTED
    assert "enabling node 1 (left rear wheel)" in armed.reported()
    armed.runs(0.5)
    assert {drive.state for drive in armed.drives.values()} == {PowerState.OPERATION_ENABLED}
    assert armed.arms() == ACCEPTED


def test_an_emergency_stop_ramps_down_stands_and_then_lets_go(armed: "Bench") -> None:
    driving(armed)
    begin = armed.now
    assert armed.commands(SAFETY_SWITCH, STOP) == ACCEPTED
    armed.runs(0.6)
    words = armed.words("left", begin)
    ramp = [rpm for word, rpm in words if word == 0x000F]
    assert ramp == sorted(ramp, reverse=True)
    assert max(earlier - later for earlier, later in pairwise([RPM_AT_03, *ramp])) <= 351
    assert words[-1] == (0x000B, 0)
    assert {drive.state for drive in armed.drives.values()} == {PowerState.QUICK_STOP_ACTIVE}
    armed.runs(0.4)
    assert armed.words("left", begin)[-1] == (0x0000, 0)
    assert {drive.state for drive in armed.drives.values()} == {PowerState.SWITCH_ON_DISABLED}


def test_cleared_after_it_was_let_go_it_is_armed_as_after_a_quick_stop(armed: "Bench") -> None:
    armed.commands(SAFETY_SWITCH, STOP)
    armed.runs(1)
    assert armed.commands(SAFETY_SWITCH, CLEAR) == ACCEPTED
    armed.runs(0.2)
    assert armed.drives["left"].state is PowerState.SWITCH_ON_DISABLED
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(0.2)
    assert armed.arms() == ACCEPTED
    armed.runs(3)
    driving(armed)
    assert armed.drives["left"].rpm == RPM_AT_03


def test_an_emergency_stop_is_left_by_clearing_and_arming(armed: "Bench") -> None:
    armed.commands(SAFETY_SWITCH, STOP)
    armed.runs(0.2)
    assert armed.arms() == DENIED
    assert "the emergency stop is latched" in armed.reported()
    assert armed.commands(SAFETY_SWITCH, CLEAR) == ACCEPTED
    armed.runs(0.2)
    assert armed.drives["left"].state is PowerState.QUICK_STOP_ACTIVE
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
    assert "node 3 (steering) reports fault 0x8611" in armed.reported()
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(0.5)
    assert armed.drives["steer"].state is PowerState.OPERATION_ENABLED
    begin = armed.now
    armed.speed = 0.3
    armed.runs(0.3)
    assert set(armed.words("left", begin)) == {(0x000F, 0)}, "motion needs a new arm"
    armed.speed = 0.0
    armed.runs(0.1)
    assert armed.arms() == ACCEPTED


def test_a_faulted_drive_is_never_reported_to_move(armed: "Bench") -> None:
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
    assert "node 4 (scissor lift)" in armed.reported()


def test_a_drive_that_restarted_is_set_up_again_when_armed(armed: "Bench") -> None:
    armed.inject("right", armed.drives["right"].boots())
    armed.runs(0.5)
    assert armed.arms() == TEMPORARILY_REJECTED
    armed.runs(1)
    assert armed.drives["right"].memory[od.CONSUMER_HEARTBEAT_1] == bytes.fromhex("c8006400")
    assert armed.drives["right"].state is PowerState.OPERATION_ENABLED
    assert armed.arms() == ACCEPTED


def test_no_heartbeat_is_active_while_an_interlock_stops_the_whole_robot(armed: "Bench") -> None:
    """From the last motion command until the stick was neutral again, at every heartbeat."""
    driving(armed)
    seen: dict[str, set[int]] = {}
    for talks, speed, seconds in ((False, 0.3, 2.0), (True, 0.3, 2.5), (True, 0.0, 2.5), (True, 0.3, 2.5)):
        armed.talks, armed.speed = talks, speed
        for _ in range(round(seconds / 0.05)):
            before = len(armed.station.received)
            armed.runs(0.05)
            held = {event.name for event in armed.bridge.interlock_events if event.interlock.stops is None}
            for message in armed.station.received[before:]:
                if message.get_type() == "HEARTBEAT":
                    assert (message.system_status == dialect.MAV_STATE_ACTIVE) is (not held), held
                    for name in held or {"nothing"}:
                        seen.setdefault(name, set()).add(message.system_status)
    assert {"operator link timeout", "stick not neutral", "nothing"} <= seen.keys()
