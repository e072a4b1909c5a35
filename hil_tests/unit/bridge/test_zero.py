"""Saying where an axis stands: who may, when, and what goes to its drive for it, frame by frame."""

from itertools import product
from typing import TYPE_CHECKING, Final

import pytest

from firmware_bridge import robot_types
from firmware_bridge.bridge import Bridge
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.modes import number_of_own
from firmware_bridge.robots.rars import ROBOT_TYPE
from hil_tests.unit.bridge.bench import ACCEPTED, DENIED, LIFT, STANDS, STEER, TEMPORARILY_REJECTED, driving

if TYPE_CHECKING:
    from collections.abc import Callable

    from hil_tests.unit.bridge.bench import Bench

NAN: Final = float("nan")
HALF_UP_M: Final = 0.5
HALF_UP_QC: Final = 651_611
"""Motor position at half height.

By hand: asin(0.5 / 1.8 + sin 5 deg) is 21.4 deg, so the screw goes 0.3 m * (cos 5 deg - cos 21.4 deg), over
1.5 mm a turn, times 25 in the gear, times 2000 quadcounts.
"""

FRAMES: Final = (
    # 0x2081 := the place, and 0x6098 := 35, each read back; EPOS2 EDS for types.
    "23 81 20 00 00 00 00 00",
    "40 81 20 00 00 00 00 00",
    "2f 98 60 00 23 00 00 00",
    "40 98 60 00 00 00 00 00",
    # 0x6060 := 6, homing mode, until 0x6061 confirms it (CiA 402).
    "2f 60 60 00 06 00 00 00",
    "40 61 60 00 00 00 00 00",
    # The halt ends, bit 4 rises: 0x000F, 0x001F (EPOS Firmware Specification 9.3, maxon's command library).
    "2b 40 60 00 0f 00 00 00",
    "2b 40 60 00 1f 00 00 00",
    "40 41 60 00 00 00 00 00",
    # Halted, and back to profile position.
    "2b 40 60 00 0f 01 00 00",
    "2f 60 60 00 01 00 00 00",
    "40 61 60 00 00 00 00 00",
    "40 64 60 00 00 00 00 00",
)


def lost(bench: "Bench", name: str) -> bool:
    return f"reference lost: {name}" in {event.name for event in bench.bridge.interlock_events}


def restarted(bench: "Bench", name: str = "lift") -> None:
    """Let a drive restart, and be enabled again by an arm."""
    bench.inject(name, bench.drives[name].boots())
    bench.runs(3)
    assert bench.arms() == TEMPORARILY_REJECTED
    bench.runs(1)
    assert bench.drives[name].state is PowerState.OPERATION_ENABLED


def test_a_mode_waits_for_a_position_and_not_for_what_its_drive_does_later(started: "Bench") -> None:
    mode = (1.0, float(number_of_own([*ROBOT_TYPE.modes].index("steering_failed") + 1)))
    assert started.commands(STANDS, STEER, 0.0) == ACCEPTED
    assert started.commands(dialect.MAV_CMD_DO_SET_MODE, *mode) == TEMPORARILY_REJECTED
    assert "being confirmed" in started.reported()
    started.runs(1)
    # Its drive is busy again: an arm enables what a forced disarm disabled; a failed drive may never end it.
    assert started.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0) == ACCEPTED
    started.runs(1)
    assert started.arms() == TEMPORARILY_REJECTED
    (steer,) = (it for it in started.bridge.all_drivers.drivers if it.axis.name == "steer")
    assert steer.state is DriverState.ACTIVATING
    before = started.reported()
    started.commands(dialect.MAV_CMD_DO_SET_MODE, *mode)
    assert "being confirmed" not in started.reported().removeprefix(before)


def test_what_goes_to_the_drive_is_homing_by_method_35(started: "Bench") -> None:
    begin = started.now
    assert started.commands(STANDS, LIFT, 0.0) == ACCEPTED
    started.runs(0.3)
    assert tuple(payload for _, payload in started.sent(0x604, begin)) == FRAMES
    for node in (1, 2, 3):
        assert [word for _, word in started.sent(0x600 + node, begin) if not word.startswith("40 7c")] == []


def test_the_place_is_that_of_the_axis(started: "Bench") -> None:
    assert started.commands(STANDS, LIFT, HALF_UP_M) == ACCEPTED
    started.runs(0.3)
    assert started.drives["lift"].position == pytest.approx(HALF_UP_QC, abs=1)
    assert started.bridge.seen.body.lift_m == pytest.approx(HALF_UP_M, abs=1e-5)
    assert started.commands(STANDS, STEER, -45.0) == ACCEPTED
    started.runs(0.3)
    assert started.bridge.seen.body.steer_rad == pytest.approx(-0.7853982, abs=1e-4)


def test_a_restarted_drive_moves_when_it_was_given_its_position(started: "Bench") -> None:
    restarted(started)
    assert lost(started, "lift")
    assert not lost(started, "steer")
    assert started.arms() == TEMPORARILY_REJECTED
    assert "its reference is lost" in started.reported()
    assert started.commands(STANDS, LIFT, HALF_UP_M) == ACCEPTED
    started.runs(0.3)
    assert not lost(started, "lift")
    assert started.arms() == ACCEPTED
    started.runs(0.5)
    assert started.drives["lift"].position == pytest.approx(HALF_UP_QC, abs=1), "a confirmation moves nothing"


def test_it_may_be_stated_twice_and_once_more_otherwise(started: "Bench") -> None:
    for height in (0.1, 0.1, 0.2):
        assert started.commands(STANDS, LIFT, height) == ACCEPTED
        started.runs(0.3)
        assert started.bridge.seen.body.lift_m == pytest.approx(height, abs=1e-5)
    assert started.arms() == ACCEPTED


def test_while_it_is_set_it_is_stated_again_in_vain_and_no_one_is_armed(started: "Bench") -> None:
    assert started.commands(STANDS, LIFT, 0.1) == ACCEPTED
    assert started.commands(STANDS, LIFT, 0.2) == TEMPORARILY_REJECTED
    assert started.arms() == TEMPORARILY_REJECTED
    started.runs(0.3)
    assert started.bridge.seen.body.lift_m == pytest.approx(0.1, abs=1e-5)


@pytest.mark.parametrize(
    ("axis", "value", "why"),
    [
        (1, 0.0, "no position to confirm for left; to be confirmed: steer (deg), lift (m)"),
        (0, 0.0, "no position to confirm for axis 0"),
        (5, 0.0, "no position to confirm for axis 5"),
        (LIFT, 2.0, "lift at 2 m is not within 0 to 1.116"),
        (LIFT, -0.001, "lift at -0.001 m is not within"),
        (LIFT, NAN, "lift at nan m is not within"),
        (LIFT, float("inf"), "lift at inf m is not within"),
        (STEER, 60.1, "steer at 60.1 deg is not within -60 to 60"),
        (STEER, -60.1, "steer at -60.1 deg is not within"),
    ],
)
def test_a_wrong_axis_or_value_is_refused_with_its_reason(
    started: "Bench", axis: int, value: float, why: str
) -> None:
    begin = started.now
    assert started.commands(STANDS, axis, value) == DENIED
    assert f"zero: {why}" in started.reported()
    started.runs(0.3)
    written = [word for node in (1, 2, 3, 4) for _, word in started.sent(0x600 + node, begin)]
    assert [word for word in written if not word.startswith("40")] == []


@pytest.mark.parametrize(("axis", "value"), [(LIFT, 0.0), (LIFT, 1.115), (STEER, 60.0), (STEER, -60.0)])
def test_the_ends_of_an_axis_are_places_too(started: "Bench", axis: int, value: float) -> None:
    assert started.commands(STANDS, axis, value) == ACCEPTED


def test_no_one_is_requested_while_the_robot_is_armed_or_moves(armed: "Bench") -> None:
    assert armed.commands(STANDS, LIFT, 0.1) == DENIED
    assert "zero: disarm first" in armed.reported()
    driving(armed)
    assert armed.commands(STANDS, LIFT, 0.1) == DENIED
    armed.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    assert armed.commands(STANDS, LIFT, 0.1) == TEMPORARILY_REJECTED
    assert "zero: the robot still moves" in armed.reported()


def test_nor_after_a_forced_disarm_or_in_an_emergency_stop(armed: "Bench") -> None:
    armed.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0.0)
    assert armed.commands(STANDS, LIFT, 0.1) == DENIED
    assert "zero: the emergency stop is latched" in armed.reported()
    armed.runs(0.5)
    armed.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 1.0)
    armed.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    assert armed.commands(STANDS, LIFT, 0.1) == DENIED
    assert "zero: the power was disabled by force" in armed.reported()


def test_a_drive_without_power_is_enabled_first(started: "Bench") -> None:
    """An arm would do it, too; but one is refused while the lift would go to its earlier target."""
    started.inject("lift", started.drives["lift"].boots())
    started.runs(3)
    assert started.commands(STANDS, LIFT, 0.1) == TEMPORARILY_REJECTED
    assert "first, repeat it then" in started.reported()
    started.runs(1.0)
    assert started.commands(STANDS, LIFT, 0.1) == ACCEPTED
    started.runs(0.3)
    assert started.arms() == ACCEPTED


@pytest.mark.parametrize(
    ("address", "how", "states"),
    [
        (od.HOMING_METHOD, "refuses", "0x6098"),
        (od.HOMING_METHOD, "forgets", "0x6098"),
        (at.HOME_POSITION, "refuses", "0x2081"),
        (at.HOME_POSITION, "forgets", "0x2081"),
        (od.MODE, "refuses", "0x6060"),
        (od.MODE, "forgets", "0x6061"),
        (od.MODE_DISPLAY, "refuses", "0x6061"),
    ],
)
def test_a_drive_that_does_not_take_it_is_never_reported_to_home(
    started: "Bench", address: Address, how: str, states: str
) -> None:
    drive = started.drives["steer"]
    drive.referenced = False
    if how == "refuses":
        drive.refuses[address] = AbortCode.DEVICE_STATE
    else:
        drive.forgets.add(address)
    begin = started.now
    assert started.commands(STANDS, STEER, 10.0) == ACCEPTED
    started.runs(1.0)
    words = [word for _, word in started.sent(0x603, begin)]
    assert [word for word in words if word.startswith("2b 40 60 00 1f")] == []
    assert lost(started, "steer")
    assert started.arms() == TEMPORARILY_REJECTED
    assert states in started.reported()


def test_one_that_restarts_meanwhile_has_lost_it(started: "Bench") -> None:
    assert started.commands(STANDS, LIFT, 0.1) == ACCEPTED
    started.inject("lift", started.drives["lift"].boots())
    started.runs(0.5)
    assert lost(started, "lift")
    assert started.arms() == TEMPORARILY_REJECTED


@pytest.mark.long(keeps=["0-True", "5-False", "8-True"])
@pytest.mark.parametrize(("after", "force"), list(product((0, 1, 2, 3, 5, 8), (False, True))))
def test_a_stop_in_the_middle_leaves_it_lost_and_the_drive_is_set_up_again(
    started: "Bench", after: int, *, force: bool
) -> None:
    drive = started.drives["lift"]
    drive.referenced = False
    started.states(dialect.MAVLink_command_long_message(1, 1, STANDS, 0, LIFT, 0.1, 0, 0, 0, 0, 0))
    started.world.run(started.now + after * 250_000)
    if force:
        started.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    else:
        started.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0.0)
        started.runs(0.3)
        started.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 1.0)
    started.runs(0.5)
    began = lost(started, "lift")
    started.arms()
    started.runs(1.0)
    if began:
        assert started.commands(STANDS, LIFT, 0.1) == ACCEPTED
        started.runs(0.3)
    assert started.arms() == ACCEPTED
    started.runs(0.2)
    assert drive.memory[od.MODE] == b"\x01"
    assert started.bridge.seen.body.lift_m == pytest.approx(0.1, abs=1e-5)


def test_what_an_earlier_run_has_kept_is_reported_and_not_believed(bench: "Bench") -> None:
    bench.bridge.offer({"lift": 0.25, "left": 3.0, "no one": 1.0})
    for drive in bench.drives.values():
        drive.referenced = False
    bench.starts()
    assert lost(bench, "lift")
    assert "position unknown (last known: 0.25 m)" in bench.reported()
    assert bench.arms() == TEMPORARILY_REJECTED
    assert bench.bridge.places == {"lift": 0.25}
    bench.stands(lift_m=0.1)
    assert bench.bridge.places == {"lift": 0.1, "steer": 0.0}


def test_after_a_restart_it_is_reported_where_the_axis_was_last(started: "Bench") -> None:
    started.stands(steer_deg=-30.0, lift_m=0.3)
    restarted(started)
    assert "position unknown (last known: 0.3 m)" in started.reported()
    assert started.bridge.places == pytest.approx({"lift": 0.3, "steer": -30.0}, abs=1e-3)


def started_with(bench_with: "Callable[[Bridge], Bench]", **confirmed: float) -> "Bench":
    """Return a bench whose bridge receives axis positions at its start; its drives have no reference."""
    robot = robot_types.find("rars")
    bench = bench_with(
        Bridge(robot, ROBOT_TYPE, confirmed=tuple(ConfirmPosition(*one) for one in confirmed.items()))
    )
    for drive in bench.drives.values():
        drive.referenced = False
    return bench


def test_what_is_stated_at_the_start_is_taken_when_the_drives_are_ready(
    bench_with: "Callable[[Bridge], Bench]",
) -> None:
    bench = started_with(bench_with, lift=0.2, steer=10.0)
    bench.starts()
    bench.runs(0.5)
    assert bench.bridge.places == {"lift": 0.2, "steer": 10.0}
    assert bench.arms() == ACCEPTED
    assert bench.guard.refused == 0


def test_what_was_stated_at_the_start_is_not_taken_later(bench_with: "Callable[[Bridge], Bench]") -> None:
    bench = started_with(bench_with, lift=0.2)
    bench.runs(0.1)
    bench.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0.0)
    bench.runs(6.0)
    bench.commands(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 1.0)
    bench.arms()
    bench.runs(2.0)
    assert lost(bench, "lift")
    assert bench.bridge.places == {}


@pytest.mark.parametrize("confirmed", [{"lift": 2.0}, {"left": 0.0}, {"no one": 0.0}, {"steer": NAN}])
def test_no_one_starts_a_bridge_with_a_place_that_there_is_not(confirmed: dict[str, float]) -> None:
    robot = robot_types.find("rars")
    with pytest.raises(ValueError, match="zero: "):
        Bridge(robot, ROBOT_TYPE, confirmed=tuple(ConfirmPosition(*one) for one in confirmed.items()))


def test_a_zero_that_was_known_is_lost_where_a_new_one_did_not_come_to_its_end(started: "Bench") -> None:
    """Bit 15 stands all the time; but no one knows which of the two the drive counts from."""
    assert not lost(started, "lift")
    started.states(dialect.MAVLink_command_long_message(1, 1, STANDS, 0, LIFT, 0.1, 0, 0, 0, 0, 0))
    started.world.run(started.now + 750_000)
    started.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    started.runs(0.5)
    assert lost(started, "lift")
