"""Stories of stops that a drive does not obey: on the whole bench, over CAN and over a serial line."""

from typing import TYPE_CHECKING, Final

import pytest

from emulators.epos2.drive import Epos2
from emulators.robots.rars import RarsStep as Step
from emulators.wires import DatagramWire
from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.bridge.stops import NOT_ACKNOWLEDGED
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import to_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

if TYPE_CHECKING:
    from emulators.world import Wire

RARS: Final[AnyRobot] = find("rars")
LINKS: Final = {"can": RARS, "serial": over_serial(RARS)}
DRIVING: Final = (ARMED, step(4.0, speed_mps=0.3))
NOT_RECEIVING_S: Final = 6.0
LEFT: Final = "node 1 (left rear wheel)"
UNPOWERED: Final = (PowerState.SWITCH_ON_DISABLED, PowerState.READY_TO_SWITCH_ON, PowerState.SWITCHED_ON)
BEAT: Final = cia301.ERROR_CONTROL + Epos2Link.of_link(RARS, "drives").bridge_node

on_each_link = pytest.mark.parametrize("link", LINKS)
deafened = pytest.mark.parametrize("command", ["stop", "enter_pre_operational", "reset_communication"])


def driven(rides: Ridden, link: str, *steps: Step, command: str | None = None, fresh: bool = False) -> Ride:
    """Drive at 0.3 m/s, where a third party's network command meets the left wheel's drive."""
    faults = (
        () if command is None else (fault("nmt_foreign_node", NOT_RECEIVING_S, command=command, node="left"),)
    )
    own_bench = {"robot": LINKS[link]} if fresh or link != "can" else {}
    return rides(*DRIVING, *steps, seconds=20, faults=faults, **own_bench)


def states(one: Ride) -> list[PowerState | None]:
    """Return the drives' own states, whether reported or not."""
    return [state_of(device.store.get(od.STATUSWORD)) for device in one.rig.devices.nodes(Epos2).values()]


def reported(one: Ride) -> set[str]:
    return {
        event.reason.partition(";")[0]
        for event in one.rig.interlock_events
        if event.name.startswith(NOT_ACKNOWLEDGED)
    }


def unpowered(one: Ride) -> bool:
    return not any(axis.powered for axis in one.rig.devices.axes)


def receives_only(one: Ride, *addresses: int) -> None:
    """Let the left wheel's drive receive only frames with these identifiers from now on."""
    station = one.rig.world._stations["left"]  # noqa: SLF001 - no fault of a mission is as selective
    listens = station.listens
    assert listens is not None
    station.listens = lambda packet: packet.address in addresses and listens(packet)


def ended(one: Ride, within_s: float) -> float:
    """End the program, and return how long that took."""
    began = to_seconds(one.rig.world.now)
    one.ends()
    while not one.rig.bridge.finished:
        assert to_seconds(one.rig.world.now) < began + within_s
        one.runs(0.05)
    return to_seconds(one.rig.world.now) - began


@pytest.mark.long(keeps=["stop-can", "reset_communication-can"])
@on_each_link
@deafened
def test_a_drive_that_a_foreign_node_made_unable_to_receive_comes_to_rest(
    rides: Ridden, link: str, command: str
) -> None:
    one = driven(rides, link, command=command)
    one.runs_until(10.0)
    assert one.stands_from(NOT_RECEIVING_S, slower_than=0.01) < NOT_RECEIVING_S + 1.5
    assert one.fastest(8.5, 10.0) < 0.003
    assert not one.now["armed"]
    assert one.rig.guard.refused == 0


@pytest.mark.long(keeps=["stop"])
@deafened
def test_an_emergency_stop_stops_a_drive_that_receives_nothing_and_blocks_arming(
    rides: Ridden, command: str
) -> None:
    one = driven(rides, "can", step(6.05, emergency_stop=True), step(7.5, arm=True), command=command)
    one.runs_until(10.0)
    assert one.stands_from(NOT_RECEIVING_S, slower_than=0.01) < NOT_RECEIVING_S + 1.5
    assert one.rig.bridge.seen.facts.emergency_stopped
    assert not one.now["armed"]


@pytest.mark.long(keeps=["stop-can"])
@on_each_link
@deafened
def test_a_forced_disarm_takes_the_power_of_a_drive_that_receives_nothing(
    rides: Ridden, link: str, command: str
) -> None:
    one = driven(rides, link, step(6.05, force_disarm=True), command=command)
    one.runs_until(NOT_RECEIVING_S + 1.5)
    assert unpowered(one)
    assert not set(states(one)) & {PowerState.OPERATION_ENABLED, PowerState.QUICK_STOP_ACTIVE}


@pytest.mark.long(keeps=["reset_communication-can"])
@on_each_link
@deafened
def test_an_orderly_end_leaves_no_drive_with_power_that_receives_nothing(
    rides: Ridden, link: str, command: str
) -> None:
    one = driven(rides, link, command=command)
    one.runs_until(NOT_RECEIVING_S + 0.02)
    ended(one, 8.0)
    assert unpowered(one)
    assert one.rig.bridge.not_acknowledged == ()
    one.runs(2.0)
    assert one.fastest(to_seconds(one.rig.world.now) - 0.5) < 0.003


def test_a_drive_that_receives_only_the_heartbeat_stops_when_it_is_withheld(rides: Ridden) -> None:
    one = driven(rides, "can", fresh=True)
    one.runs_until(NOT_RECEIVING_S)
    receives_only(one, BEAT)
    one.runs_until(9.0)
    left = one.rig.devices.nodes(Epos2)["left"]
    assert state_of(left.store.get(od.STATUSWORD)) is PowerState.FAULT
    assert left.store.get(Address(0x1003, 1)) == 0x8130
    assert f"{LEFT}: power off by SDO not acknowledged" in reported(one)
    assert f"{LEFT}: silence not acknowledged" not in reported(one), "it was enough"


def test_a_drive_without_a_watch_that_receives_only_the_network_is_reset_at_last(rides: Ridden) -> None:
    """Reset communication has taken its watch over the bridge: silence does not stop it."""
    one = driven(rides, "can", command="reset_communication", fresh=True)
    one.runs_until(NOT_RECEIVING_S + 0.01)
    receives_only(one, cia301.NMT)
    one.runs_until(10.0)
    assert states(one)[0] is PowerState.SWITCH_ON_DISABLED
    assert unpowered(one)
    one.runs_until(14.0)
    assert one.fastest(13.5, 14.0) < 0.003, "it rolls out"
    assert f"{LEFT}: silence not acknowledged" in reported(one)
    assert any("the drive's reference is lost" in reason for reason in one.held(f"{NOT_ACKNOWLEDGED}: left"))
    assert one.rig.guard.refused == 0


def test_where_nothing_helps_the_operator_and_the_program_say_so(rides: Ridden) -> None:
    one = driven(rides, "can", command="reset_communication", fresh=True)
    one.runs_until(NOT_RECEIVING_S + 0.01)
    receives_only(one)
    one.runs_until(12.0)
    last = one.held(f"{NOT_ACKNOWLEDGED}: left")[-1]
    assert last == f"{LEFT}: reset not acknowledged; nothing is left to try; it may go on moving"
    ended(one, 4.0)
    assert one.rig.bridge.not_acknowledged == ("node 1 (left rear wheel)",)
    assert states(one)[0] is PowerState.OPERATION_ENABLED, "only the battery switch is left"


def test_an_end_that_a_drive_does_not_confirm_goes_on_to_the_last_step_and_names_it(rides: Ridden) -> None:
    one = driven(rides, "can", step(5.0, speed_mps=0.0), fresh=True)
    one.runs_until(7.0)
    one.rig.world.silence("right", one.rig.world.now)
    assert ended(one, 8.0) > 1.0
    assert one.rig.bridge.not_acknowledged == ("node 2 (right rear wheel)",)
    left, right, steer, lift = states(one)
    assert {left, steer, lift} <= {PowerState.SWITCH_ON_DISABLED, PowerState.FAULT}
    assert right is PowerState.FAULT, "its own watch"
    assert one.rig.devices.nodes(Epos2)["right"].store.get(od.CONSUMER_HEARTBEAT_1) != 0


def second_bridge(one: Ride) -> tuple[Bridge, list[Packet]]:
    """Start a second bridge on the drives' bus, now; return it, and the frames that it sends there."""
    second, sent = Bridge(RARS, robot_type_of(RARS)), list[Packet]()
    links: dict[str, Wire] = {"drives": one.rig.can_wire, OPERATOR: DatagramWire()}
    one.rig.world.attach("second", guarded(second, RARS), links)
    one.rig.can_wire.observe(lambda _, sender, packet: sent.append(packet) if sender == "second" else None)
    return second, sent


@pytest.mark.long(keeps=["0.1"])
@pytest.mark.parametrize("after_s", [0.0, 0.005, 0.1, 0.19])
def test_a_second_bridge_that_is_ended_at_once_leaves_the_first_one_s_robot_alone(
    rides: Ridden, after_s: float
) -> None:
    one = driven(rides, "can", fresh=True)
    one.runs_until(NOT_RECEIVING_S)
    second, sent = second_bridge(one)
    one.runs(after_s)
    one.rig.world.stop("second")
    one.runs_until(NOT_RECEIVING_S + 1.0)
    assert second.finished
    assert sent == []
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.3, abs=0.02)


def test_a_second_bridge_refuses_to_start_and_states_why(rides: Ridden) -> None:
    one = driven(rides, "can", fresh=True)
    one.runs_until(NOT_RECEIVING_S)
    second, sent = second_bridge(one)
    one.runs_until(NOT_RECEIVING_S + 1.0)
    assert second.phase is Life.FAILED
    assert second.failure is not None
    assert second.failure.startswith("link 'drives': someone else sends ")
    one.rig.world.stop("second")
    one.runs(1.0)
    assert second.finished
    assert sent == []
    assert one.now["armed"]
    assert one.now["speed_mps"] == pytest.approx(0.3, abs=0.02)


@pytest.mark.long(keeps=["heartbeat"])
@pytest.mark.parametrize(
    ("frame", "reported"),
    [
        (Packet(CAN, BEAT, b"\x05"), "someone else sends the heartbeat of this bridge, node 100: 764#05"),
        (Packet(CAN, cia301.SYNC, b""), "someone else sends SYNC: 080#"),
        (Packet(CAN, cia301.NMT, b"\x01\x09"), "someone else sends a network command: 000#0109"),
        (
            Packet(CAN, 0x502, bytes.fromhex("0F0000000000")),
            "someone else sends node 2 (right rear wheel) set-points: 502#0F0000000000",
        ),
    ],
    ids=["heartbeat", "sync", "network command", "set-point"],
)
def test_another_master_stops_the_robot_and_blocks_arming_while_it_is_received(
    rides: Ridden, frame: Packet, reported: str
) -> None:
    one = driven(rides, "can", step(6.5, speed_mps=0.0), step(8.0, arm=True), step(10.5, arm=True))
    one.runs_until(NOT_RECEIVING_S)
    sender = one.rig.world._stations["left"]  # noqa: SLF001 - a third party's word
    while to_seconds(one.rig.world.now) < 8.5:
        one.rig.can_wire.carry(sender, frame)
        one.runs(0.25)
    assert one.stands_from(NOT_RECEIVING_S, slower_than=0.01) < NOT_RECEIVING_S + 0.8
    assert not one.now["armed"]
    assert one.held("second controller: drives") == [reported]
    one.runs_until(11.0)
    assert "second controller: drives" not in one.holding
    assert one.now["armed"]


@pytest.mark.parametrize(
    "frame",
    ["2316100100000000", "2384600001000000", "2B4060000F000000", "2F60600006000000"],
    ids=["no watch", "a profile without brakes", "controlword", "homing mode"],
)
def test_a_drive_that_someone_else_has_written_to_stops_and_is_set_up_again(
    rides: Ridden, frame: str
) -> None:
    one = driven(
        rides, "can", step(6.5, speed_mps=0.0), *(step(8.0 + second, arm=True) for second in range(4))
    )
    drive = one.rig.devices.nodes(Epos2)["left"]
    one.runs_until(NOT_RECEIVING_S)
    watched = drive.store.get(od.CONSUMER_HEARTBEAT_1)
    sender = one.rig.world._stations["steer"]  # noqa: SLF001 - a third party's word
    one.rig.can_wire.carry(sender, Packet(CAN, 0x601, bytes.fromhex(frame)))
    one.runs_until(8.0)
    assert one.stands_from(NOT_RECEIVING_S, slower_than=0.01) < NOT_RECEIVING_S + 1.2
    assert not one.now["armed"]
    (reported,) = one.held("axis reconfigured: left")
    assert f"601#{frame}" in reported
    assert states(one)[0] in UNPOWERED, "no one knows what it would do"
    one.runs_until(12.5)
    assert "axis reconfigured: left" not in one.holding
    assert one.now["armed"]
    assert drive.store.get(od.CONSUMER_HEARTBEAT_1) == watched
