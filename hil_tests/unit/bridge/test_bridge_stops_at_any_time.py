"""An emergency stop and a forced disarm are obeyed in every phase of the bridge's life."""

from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.bridge import Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.drivers.life_cycle import Task
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.bridge.bench import ACCEPTED, ARM, DENIED, RPM_AT_03, TEMPORARILY_REJECTED, driving

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

SAFETY_SWITCH = dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
EMERGENCY_STOP: tuple[Any, ...] = (SAFETY_SWITCH, 0.0)
FORCED_DISARM: tuple[Any, ...] = (ARM, 0.0, 21196.0)
WITHOUT_POWER = {PowerState.SWITCH_ON_DISABLED, PowerState.READY_TO_SWITCH_ON}
both = pytest.mark.parametrize("order", [EMERGENCY_STOP, FORCED_DISARM], ids=["stop", "disarm"])


def states(bench: "Bench") -> set[PowerState]:
    return {drive.state for drive in bench.drives.values()}


def runs_until(bench: "Bench", task: Task) -> None:
    """Let the start-up come to this task."""
    while bench.bridge.all_drivers.task is not task:
        bench.world.run(bench.now + MILLISECOND // 10)
    assert bench.bridge.phase is Life.STARTING


@both
@pytest.mark.parametrize("task", [Task.FIND, Task.IDENTIFY, Task.CONFIGURE, Task.START, Task.ENABLE])
def test_what_stops_while_starting_keeps_the_power_from_coming_on(
    bench: "Bench", order: tuple[Any, ...], task: Task
) -> None:
    runs_until(bench, task)
    assert bench.commands(*order) == ACCEPTED
    bench.runs(2)
    assert bench.bridge.phase is Life.RUNNING
    assert states(bench) <= WITHOUT_POWER
    if order is EMERGENCY_STOP:
        assert bench.arms() == DENIED
        assert bench.commands(SAFETY_SWITCH, 1.0) == ACCEPTED
        bench.runs(1)
        assert states(bench) <= WITHOUT_POWER, "to clear it starts nothing"
    assert bench.arms() == TEMPORARILY_REJECTED
    bench.runs(0.5)
    assert bench.arms() == ACCEPTED
    assert states(bench) == {PowerState.OPERATION_ENABLED}


@both
@pytest.mark.parametrize("task", [Task.FIND, Task.IDENTIFY, Task.CONFIGURE, Task.START])
def test_at_no_instant_after_it_a_drive_has_power(bench: "Bench", order: tuple[Any, ...], task: Task) -> None:
    runs_until(bench, task)
    assert bench.commands(*order) == ACCEPTED
    for _ in range(2000):
        bench.runs(0.001)
        assert PowerState.OPERATION_ENABLED not in states(bench)


@both
def test_what_stops_while_it_only_listens_is_kept_and_sends_nothing_to_the_drives(
    bench: "Bench", order: tuple[Any, ...]
) -> None:
    bench.runs(0.1)
    assert bench.commands(*order) == ACCEPTED
    assert [packet for _, sender, packet in bench.frames if sender == "bridge"] == []
    bench.runs(2)
    assert bench.bridge.phase is Life.RUNNING
    assert states(bench) <= WITHOUT_POWER


def test_ended_while_it_only_listens_it_is_finished_at_once_and_has_stated_nothing(bench: "Bench") -> None:
    bench.runs(0.19)
    bench.stops()
    assert bench.bridge.finished
    bench.runs(1)
    assert bench.frames == []
    assert bench.bridge.not_acknowledged == ()


def test_a_forced_disarm_does_not_end_the_way_on_which_the_power_goes(armed: "Bench") -> None:
    armed.stops()
    while armed.bridge.phase is not Life.LEAVING:
        armed.world.run(armed.now + MILLISECOND // 10)
    assert armed.commands(*FORCED_DISARM) == ACCEPTED
    armed.runs(0.5)
    assert armed.bridge.finished
    assert {drive.memory[od.CONSUMER_HEARTBEAT_1] for drive in armed.drives.values()} == {bytes(4)}


def test_a_stop_is_not_cleared_before_the_drives_are_set_up(bench: "Bench") -> None:
    runs_until(bench, Task.IDENTIFY)
    bench.commands(*EMERGENCY_STOP)
    runs_until(bench, Task.CONFIGURE)
    assert bench.commands(SAFETY_SWITCH, 1.0) == TEMPORARILY_REJECTED
    bench.runs(2)
    assert states(bench) <= WITHOUT_POWER


@both
def test_both_are_obeyed_after_a_failed_start(bench: "Bench", order: tuple[Any, ...]) -> None:
    bench.drives["steer"].silent = True
    bench.runs(3)
    assert bench.bridge.phase is Life.FAILED
    assert bench.commands(*order) == ACCEPTED


def test_while_it_comes_to_rest_a_forced_disarm_brakes_and_takes_the_power_at_rest(armed: "Bench") -> None:
    driving(armed)
    armed.stops()
    armed.runs(0.05)
    assert armed.bridge.phase is Life.STOPPING
    assert armed.drives["left"].rpm > RPM_AT_03 // 2
    assert armed.commands(*FORCED_DISARM) == ACCEPTED
    assert states(armed) == {PowerState.QUICK_STOP_ACTIVE}
    armed.runs(0.2)
    assert states(armed) <= WITHOUT_POWER
    armed.runs(0.3)
    assert armed.bridge.finished, "it was ordered: no one looks whether the robot stands by itself"
    assert states(armed) <= WITHOUT_POWER
    assert armed.bridge.not_acknowledged == ()


def test_while_it_comes_to_rest_an_emergency_stop_is_latched_and_reported(armed: "Bench") -> None:
    driving(armed)
    armed.stops()
    assert armed.commands(*EMERGENCY_STOP) == ACCEPTED
    armed.runs(0.2)
    assert armed.bridge.seen.facts.emergency_stopped
    armed.runs(3)
    assert armed.bridge.finished
    assert states(armed) <= WITHOUT_POWER


def test_while_it_comes_to_rest_nothing_else_is_obeyed_and_that_is_stated(armed: "Bench") -> None:
    driving(armed)
    armed.stops()
    assert armed.arms() == DENIED
    assert armed.commands(ARM, 0.0) == DENIED
    assert "the bridge is ending" in armed.reported()
    armed.runs(0.1)
    assert armed.drives["left"].rpm < RPM_AT_03
