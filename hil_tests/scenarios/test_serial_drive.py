"""RARS over the serial port of its first drive: one drive on the line, three behind it, in virtual time."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from emulators.bench import mission as missions
from emulators.canopen.heartbeat import Consumer
from emulators.epos2.drive import Epos2
from emulators.epos2.family import MaxonSerialLine
from emulators.rig import BRIDGE
from emulators.robots.rars import BENCH_SETUP
from emulators.run import RunOrder, drive
from firmware_bridge.bridge import Life
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.drivers.life_cycle import AT_REST
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.settings import Epos2Link, nodes_on
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

if TYPE_CHECKING:
    from firmware_bridge.safety.snapshot import Facts

RARS: Final = find("rars")
USB: Final = over_serial(RARS, Generation.V2)
DRIVING: Final = (ARMED, step(3.5, speed_mps=0.3))
CUT_S: Final = 5.0
WATCH_S: Final = 0.2
"""Timeout of the drives' watch on the bridge."""
BRAKED_S: Final = 0.45
"""The watch, one heartbeat that had just come, and the quick stop from 0.3 m/s."""


def line_of(one: Ride) -> MaxonSerialLine:
    line = one.rig.line
    assert isinstance(line, MaxonSerialLine)
    return line


def states(one: Ride) -> list[PowerState | None]:
    """Return the drives' own states, whether reported or not."""
    return [state_of(device.store.get(od.STATUSWORD)) for device in one.rig.devices.nodes(Epos2).values()]


def armed(one: Ride) -> bool:
    facts: Facts = one.rig.bridge.seen.facts
    return facts.armed


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Callable[[AnyRobot, str], Path]:
    """Drive a shipped mission with each robot once, and return the folder of its results."""
    folders: dict[tuple[str, str], Path] = {}

    def results(robot: AnyRobot, mission: str) -> Path:
        link = Epos2Link.of_link(robot, "drives").driver.value
        if (link, mission) not in folders:
            folder = folders[link, mission] = tmp_path_factory.mktemp(f"{link}-{mission}")
            script = missions.find(mission, robot, BENCH_SETUP)
            drive(RunOrder(robot, BENCH_SETUP, mission, script, 0, folder), lambda _: None)
        return folders[link, mission]

    return results


@pytest.mark.long(beside="test_steering_and_lift_reach_their_targets_through_the_gateway")
@pytest.mark.timeout(240)
def test_the_line_mission_arrives_as_over_can(driven: Callable[[AnyRobot, str], Path]) -> None:
    over_can, through = (
        json.loads((driven(robot, "line") / "summary.json").read_text()) for robot in (RARS, USB)
    )
    assert through["path_length_m"] == pytest.approx(over_can["path_length_m"], abs=0.002)
    assert through["max_speed_mps"] == pytest.approx(over_can["max_speed_mps"], abs=0.001)
    assert through["odometry_error_m"] == pytest.approx(over_can["odometry_error_m"], abs=0.001)
    assert {event["name"] for event in through["interlock_events"]} == {
        event["name"] for event in over_can["interlock_events"]
    }
    (line,) = through["lines"]
    assert over_can["lines"] == []
    assert (line["protocol"], line["baud"], line["cycle_ms"]) == ("v2", 1_000_000, 50.0)
    assert line["bytes"] > 200_000
    assert 20 < line["busy_percent"] < 60
    assert line["longest_cycle_ms"] < line["cycle_ms"]
    assert line["late_cycles"] == 0
    assert through["bus_load_percent"] > over_can["bus_load_percent"]


@pytest.mark.long(beside="test_steering_and_lift_reach_their_targets_through_the_gateway")
@pytest.mark.timeout(240)
def test_every_interlock_holds_as_over_can(driven: Callable[[AnyRobot, str], Path]) -> None:
    """The operator who tries everything that is forbidden: the same holds in the same order, to 0.15 s."""
    over_can, through = (
        json.loads((driven(robot, "interlocks") / "summary.json").read_text()) for robot in (RARS, USB)
    )
    # A line reads the currents one by one: after a hard stop it may keep the power where CAN lets go.
    events = [
        [event for event in reported["interlock_events"] if event["name"] != "held with power"]
        for reported in (over_can, through)
    ]
    names, began = (
        [[event[key] for event in reported] for reported in events] for key in ("name", "began_s")
    )
    assert names[0] == names[1]
    # The set-up takes longer; what is wrong then follows it.
    first = ["starting", "not armed", "reference lost: steer", "reference lost: lift"]
    assert names[0][: len(first)] == first
    assert began[1][len(first) :] == pytest.approx(began[0][len(first) :], abs=0.15)
    assert through["max_speed_mps"] < 0.502
    assert through["max_acceleration_mps2"] < 1.45
    assert through["lines"][0]["late_cycles"] == 0


def test_rs232_drives_with_the_longer_cycle_that_its_robot_file_states(rides: Ridden) -> None:
    slow = over_serial(RARS, Generation.V1).model_copy(update={"cycle_ms": 140})
    one = rides(ARMED, step(4.0, speed_mps=0.2, ramp_mps2=0.2), seconds=8, robot=slow)
    one.runs(7)
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.002)
    assert line_of(one).carried(slow, one.rig.world.now, one.rig.devices).late_cycles == 0
    assert one.rig.guard.refused == 0


def test_steering_and_lift_reach_their_targets_through_the_gateway(rides: Ridden) -> None:
    one = rides(
        ARMED,
        step(3.5, speed_mps=0.2, steer_deg=20),
        step(6.0, speed_mps=0.0, steer_deg=0),
        step(8.0, lift_m=0.05),
        seconds=12,
        robot=USB,
    )
    one.runs_until(5.9)
    assert one.now["steer_rad"] == pytest.approx(0.349, abs=0.005)
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.005)
    one.runs_until(11.5)
    assert one.now["lift_m"] == pytest.approx(0.05, abs=0.002)
    assert one.rig.guard.refused == 0


@pytest.mark.long(beside="test_killed_it_leaves_the_drives_to_their_own_watch")
def test_when_the_bridge_dies_all_four_drives_stop_by_their_own_watch(rides: Ridden) -> None:
    """The gateway, too, which receives no heartbeat of the bridge: it misses the guarding of node 2."""
    one = rides(*DRIVING, seconds=8, robot=USB)
    one.runs_until(CUT_S)
    assert one.now["speed_mps"] == pytest.approx(0.3, abs=0.005)
    one.rig.world.silence(BRIDGE, one.rig.world.now)
    one.runs_until(CUT_S + WATCH_S + 0.06)
    assert PowerState.OPERATION_ENABLED not in states(one)
    one.runs_until(CUT_S + 1)
    assert states(one) == [PowerState.FAULT] * 4
    assert one.stands_from(CUT_S, slower_than=0.01) < CUT_S + BRAKED_S


@pytest.mark.long(beside="test_a_cause_has_the_outcome_that_was_measured")
def test_an_adapter_that_is_unplugged_is_reported_within_a_cycle_and_needs_a_new_arm(rides: Ridden) -> None:
    one = rides(
        *DRIVING,
        step(6.0, speed_mps=0.0),
        step(7.0, arm=True),
        step(9.0, speed_mps=0.2),
        seconds=14,
        robot=USB,
    )
    one.runs_until(CUT_S)
    line_of(one).adapter.plugged = False
    one.runs_until(CUT_S + 0.05)
    assert "link lost: drives" in one.holding
    one.runs_until(CUT_S + 0.1)
    assert not armed(one)
    one.runs_until(CUT_S + 1)
    assert states(one) == [PowerState.FAULT] * 4
    assert one.stands_from(CUT_S, slower_than=0.01) < CUT_S + BRAKED_S
    assert one.held("link lost: drives") == ["the serial line to the drives is gone"]
    line_of(one).adapter.plugged = True
    one.runs_until(6.9)
    assert "link lost: drives" not in one.holding
    assert one.held("axis fault: left")[0].count("reports fault 0x8130")
    assert one.held("axis fault: lift")[0].count("reports fault 0x8130")
    assert states(one) == [PowerState.FAULT] * 4
    assert not armed(one)
    one.runs_until(8.9)
    assert states(one) == [PowerState.OPERATION_ENABLED] * 4
    assert armed(one)
    one.runs_until(10.0)
    assert one.now["speed_mps"] == pytest.approx(0.2, abs=0.01)
    assert one.rig.guard.refused == 1  # it spoke for the axes while the line was gone


def test_no_arming_while_the_adapter_is_out(rides: Ridden) -> None:
    one = rides(ARMED, step(5.5, arm=True), seconds=8, robot=USB)
    one.runs_until(CUT_S)
    line_of(one).adapter.plugged = False
    one.runs_until(7)
    assert not armed(one)
    assert all(drive.state in AT_REST for drive in one.rig.bridge.all_drivers.drivers)


@pytest.mark.long(beside="test_a_drive_that_falls_silent_on_its_own_link_stops_its_group_alone")
def test_a_drive_behind_the_gateway_that_falls_silent_stops_the_robot(rides: Ridden) -> None:
    one = rides(
        *DRIVING, step(6.0, speed_mps=0.0), step(8.5, arm=True), step(10.0, arm=True), seconds=12, robot=USB
    )
    one.runs_until(CUT_S)
    one.rig.world.silence("steer", one.rig.world.now)
    one.runs_until(CUT_S + 0.35)
    assert "axis timeout: steer" in one.holding
    assert not armed(one)
    assert one.stands_from(CUT_S, slower_than=0.01) < CUT_S + 0.6
    one.rig.world.silence("steer", NEVER)
    one.runs_until(11.0)
    assert states(one) == [PowerState.OPERATION_ENABLED] * 4
    assert armed(one)


@pytest.mark.long(beside="test_a_cause_has_the_outcome_that_was_measured")
def test_a_drive_that_restarts_behind_the_gateway_is_noticed_and_set_up_again(rides: Ridden) -> None:
    """Its target is 0 again then: the earlier one must be written again."""
    one = rides(
        ARMED,
        step(3.5, speed_mps=0.1, steer_deg=10),
        step(6.5, speed_mps=0.0, steer_deg=0),
        step(6.8, zero={"steering": 10.0}),
        step(7.5, arm=True),
        step(8.5, steer_deg=10),
        seconds=10,
        robot=USB,
    )
    one.runs_until(CUT_S)
    steering = one.rig.devices.nodes(Epos2)["steer"].store
    target = steering.get(od.TARGET_POSITION)
    assert target != 0
    reset = Packet(CAN, cia301.NMT, cia301.encode_nmt(NmtCommand.RESET_NODE, 3))
    one.rig.can_wire.carry(one.rig.world._stations["left"], reset)  # noqa: SLF001 - a third party's word
    one.runs_until(6.0)
    assert steering.get(od.TARGET_POSITION) != target
    assert "axis not enabled: steer" in one.holding
    assert not armed(one)
    one.runs_until(9.5)
    assert states(one) == [PowerState.OPERATION_ENABLED] * 4
    assert armed(one)
    assert steering.get(od.TARGET_POSITION) == pytest.approx(target, abs=5)


@pytest.mark.interpreted
def test_a_drive_that_does_not_notice_the_bridge_s_silence_is_not_driven(
    rides: Ridden, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gateway to which a guarding answer is no heartbeat would be stopped by no one."""
    receive = Consumer.receive

    def not_receiving(self: Consumer, payload: bytes, now: Nanoseconds) -> None:
        if self.node != Epos2Link.of_link(USB, "drives").guardian(nodes_on(USB, "drives")):
            receive(self, payload, now)

    monkeypatch.setattr(Consumer, "receive", not_receiving)
    one = rides(ARMED, seconds=8, robot=USB)
    one.runs_until(3)
    bridge = one.rig.bridge
    assert bridge.phase is Life.FAILED
    assert bridge.failure is not None
    assert "node 1 (left rear wheel): it did not notice that node 2 was silent" in bridge.failure
    assert PowerState.OPERATION_ENABLED not in states(one)


@pytest.mark.long(beside="test_an_orderly_end_leaves_every_drive_without_power")
def test_the_orderly_end_takes_the_power_off(rides: Ridden) -> None:
    one = rides(*DRIVING, seconds=10, robot=USB)
    one.runs_until(CUT_S)
    one.ends()
    one.runs_until(8.5)
    assert one.rig.bridge.finished
    assert states(one) == [PowerState.SWITCH_ON_DISABLED] * 4
    stores = [device.store for device in one.rig.devices.nodes(Epos2).values()]
    assert [store.get(od.CONSUMER_HEARTBEAT_1) for store in stores] == [0] * 4


@pytest.mark.long(keeps=["0.9"])
@pytest.mark.parametrize("instant", [0.2, 0.9, 3.7, 4.2003])
def test_a_run_over_serial_that_is_taken_back_goes_on_as_it_went(rides: Ridden, instant: float) -> None:
    one = rides(*DRIVING, seconds=8, robot=USB)
    one.runs_until(instant)
    kept = one.rig.snapshot()
    one.runs_until(instant + 0.5)
    trace = one.rig.world.trace_sha256
    one.rig.restore(kept)
    assert one.rig.world.now == from_seconds(instant)
    one.runs_until(instant + 0.5)
    assert one.rig.world.trace_sha256 == trace
