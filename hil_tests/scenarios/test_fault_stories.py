"""Stories of faults that a mission can name: what must follow from each of them, on the whole bench."""

import pytest

from emulators.bench.faults import Fault
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.drivers.epos2.serial.fleet import over_serial
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import from_seconds, to_seconds
from firmware_bridge.wire.cia402 import State, state_of
from firmware_bridge.wire.epos2.address import ERROR_HISTORY_COUNT, STATUSWORD, Address
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS: AnyRobot = find("rars")
NAMES = [axis.name for axis in RARS.axes]
DRIVING = (ARMED, step(4.0, speed_mps=0.3))
AGAIN = (step(8.0, speed_mps=0.0), step(8.5, arm=True), step(10.0, speed_mps=0.2))
"""What an operator does after a stop: lets go, arms, drives."""


def driven(rides: Ridden, *faults: Fault, until: float = 7.5, again: bool = False) -> Ride:
    """Drive straight on at 0.3 m/s into these faults."""
    ride = rides(*DRIVING, *(AGAIN if again else ()), seconds=20, faults=faults)
    ride.runs_until(until)
    return ride


def silent(ride: Ride) -> set[str]:
    return {reason.split("(")[0].split()[1] for reason in ride.held("axis silent")}


def codes(ride: Ride, name: str) -> list[int]:
    """The error history of a drive, newest first."""
    store = ride.rig.devices.drives[name].store
    return [
        store.get(Address(0x1003, number + 1)) & 0xFFFF for number in range(store.get(ERROR_HISTORY_COUNT))
    ]


def state(ride: Ride, name: str) -> State | None:
    return state_of(ride.rig.devices.drives[name].store.get(STATUSWORD))


def stands(ride: Ride, by: float) -> bool:
    """Whether the base stands from then on, or before."""
    return ride.stands_from(6.0, slower_than=0.01) <= by


def drives_again(ride: Ride) -> None:
    ride.runs_until(12.5)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)


# The bus


def test_one_frame_in_twenty_damaged_is_sent_again_and_nobody_notices(rides: Ridden) -> None:
    ride = driven(rides, fault("frame_error", 5.0, share=0.05, for_s=2.0))
    assert ride.rig.can_wire.damaged > 10
    assert ride.fastest(5.5, 7.5) == pytest.approx(0.3, rel=0.02)
    assert ride.held_between(5.0, 7.5) == set()


def test_one_frame_in_four_damaged_makes_controllers_passive(rides: Ridden) -> None:
    """Each costs 8 and each good one gives 1 back: above one in nine the counters climb."""
    ride = driven(rides, fault("frame_error", 5.0, share=0.25, for_s=2.0))
    assert any(0x8120 in codes(ride, name) for name in NAMES)
    assert stands(ride, 7.4)


def test_lost_frames_of_the_steering_stop_the_robot_and_name_it(rides: Ridden) -> None:
    ride = driven(rides, fault("frame_loss", 6.0, node=3, for_s=0.4), again=True)
    assert {"axis silent: steer", "not armed"} == ride.held_between(6.0, 7.0)
    assert stands(ride, 6.0 + 0.25 + 0.05 + 0.3 / 1.3)
    assert "axis silent: steer" not in ride.holding, "it is heard again"
    drives_again(ride)


def test_half_of_a_drives_frames_lost_is_no_silence(rides: Ridden) -> None:
    ride = driven(rides, fault("frame_loss", 5.0, node="steer", share=0.3, for_s=2.0))
    assert ride.rig.can_wire.lost > 10
    assert ride.held("axis silent") == []


def test_frames_of_the_bridge_lost_let_every_drive_stop_by_itself(rides: Ridden) -> None:
    ride = driven(rides, fault("frame_loss", 6.0, node="bridge", for_s=0.5))
    assert {name: codes(ride, name) for name in NAMES} == {name: [0x8130] for name in NAMES}
    assert stands(ride, 6.6)


def test_a_bus_on_which_every_frame_is_damaged_stops_everything(rides: Ridden) -> None:
    ride = driven(rides, fault("frame_error", 6.0, for_s=0.4))
    assert silent(ride) == {"1", "2", "3", "4"}
    assert all(set(codes(ride, name)) & {0x8120, 0x8130, 0x81FD} for name in NAMES)
    assert stands(ride, 6.6)
    assert ride.hardest(6.0) < 1.45


def test_a_bad_plug_makes_its_drive_passive_and_then_deaf(rides: Ridden) -> None:
    ride = driven(rides, fault("reception_error", 6.0, node="left", for_s=0.5))
    assert codes(ride, "left") == [0x8130, 0x8120]
    assert codes(ride, "right") == []
    assert stands(ride, 6.5)


def test_a_drive_that_is_too_slow_for_its_frames_says_so_and_stops(rides: Ridden) -> None:
    ride = driven(rides, fault("receive_overrun", 6.0, node="left", for_s=0.1), again=True)
    assert codes(ride, "left") == [0x8110]
    assert "0x8110" in ride.held("axis fault")[0]
    assert stands(ride, 6.5)
    drives_again(ride)


def test_a_controller_off_the_bus_is_silence_and_it_tells_when_it_is_back(rides: Ridden) -> None:
    ride = driven(rides, fault("bus_off", 6.0, node="right", for_s=0.5))
    assert ride.rig.can_wire.damaged == 32
    assert silent(ride) == {"2"}
    assert codes(ride, "right") == [0x8130, 0x81FD, 0x8120]
    assert stands(ride, 7.1)
    assert ride.hardest(6.0) < 1.45


def test_a_cut_cable_takes_away_all_that_lies_behind_the_cut(rides: Ridden) -> None:
    ride = driven(rides, fault("can_cut", 6.0, between=["left", "right"], for_s=0.5), again=True)
    assert silent(ride) == {"2", "3", "4"}
    assert [codes(ride, name) for name in NAMES] == [[], [0x8130], [0x8130], [0x8130]]
    assert stands(ride, 7.0)
    drives_again(ride)


def test_a_drive_alone_behind_the_cut_gets_no_acknowledgement(rides: Ridden) -> None:
    ride = driven(rides, fault("can_cut", 6.0, between=[4, "steer"], until_s=6.5))
    assert codes(ride, "lift") == [0x8130, 0x8120]
    assert silent(ride) == {"4"}
    assert stands(ride, 6.6)


def test_swapped_wires_at_one_drive_silence_the_whole_bus(rides: Ridden) -> None:
    ride = driven(rides, fault("can_swapped", 6.0, node="lift", for_s=0.5))
    assert silent(ride) == {"1", "2", "3", "4"}
    assert ride.rig.can_wire.damaged > 1000
    assert stands(ride, 6.6)


def test_a_babbler_that_fills_the_bus_stops_the_robot_and_a_slower_one_does_not(rides: Ridden) -> None:
    slow = driven(rides, fault("babbling_node", 5.0, every_us=200, for_s=1.0))
    assert slow.held_between(5.0, 7.5) == set()
    full = driven(rides, fault("babbling_node", 6.0, every_us=100, for_s=0.5))
    assert silent(full) == {"1", "2", "3", "4"}
    assert stands(full, 6.6)


def test_a_silent_bridge_is_missed_by_every_drive(rides: Ridden) -> None:
    ride = driven(rides, fault("node_silent", 6.0, node="bridge", for_s=0.7), again=True)
    assert {name: codes(ride, name) for name in NAMES} == {name: [0x8130] for name in NAMES}
    assert "operator silent" in ride.held_between(6.0, 7.0), "its link to the operator is cut, too"
    assert stands(ride, 6.6)
    drives_again(ride)


# Strangers


@pytest.mark.long(keeps=["stop", "reset_node"])
@pytest.mark.parametrize("command", ["stop", "enter_pre_operational", "reset_node", "reset_communication"])
def test_a_strangers_network_command_is_held_against_its_drive(rides: Ridden, command: str) -> None:
    ride = driven(rides, fault("nmt_stranger", 6.0, command=command, node="left"))
    held = {"axis not enabled: left", "another master: drives", "not armed"}
    # One that only does not listen any more is told to listen again before it is silent for too long.
    held |= {"axis silent: left"} if command.startswith("reset") else set()
    assert held <= ride.held_between(6.0, 6.5)


def test_a_stranger_who_resets_a_drive_takes_its_power(rides: Ridden) -> None:
    ride = driven(rides, fault("nmt_stranger", 6.0, command="reset_node", node="left"), again=True)
    assert state(ride, "left") is State.SWITCH_ON_DISABLED
    assert stands(ride, 7.0)
    drives_again(ride)


@pytest.mark.long(keeps=["enter_pre_operational-left"])
@pytest.mark.parametrize("node", ["left", None])
@pytest.mark.parametrize("command", ["stop", "enter_pre_operational", "reset_communication"])
def test_a_robot_whose_drive_obeys_a_stranger_stands(rides: Ridden, command: str, node: str | None) -> None:
    ride = driven(rides, fault("nmt_stranger", 6.0, command=command, node=node), until=9.0)
    assert ride.fastest(8.0, 9.0) < 0.002


# Drives


def test_a_drive_that_restarts_is_not_enabled_before_it_is_armed_again(rides: Ridden) -> None:
    ride = driven(rides, fault("drive_restart", 6.0, node="left", for_s=0.2), again=True)
    assert "axis not enabled: left" in ride.held_between(6.0, 6.5)
    assert state(ride, "left") is State.SWITCH_ON_DISABLED
    assert stands(ride, 7.2)
    drives_again(ride)


def test_a_drive_without_supply_is_gone_for_good(rides: Ridden) -> None:
    ride = driven(rides, fault("drive_restart", 6.0, node="steer"), until=9.0)
    assert "axis silent: steer" in ride.holding
    assert ride.rig.faults.records[-1].ended is None
    assert ride.fastest(8.0, 9.0) < 0.002


def with_a_restarted_lift(rides: Ridden, *steps: Step) -> Ride:
    """Raise the lift, and cut its drive's power for a moment: it counts from 0 where it stands."""
    return rides(
        ARMED,
        step(4.0, lift_m=0.05),
        *steps,
        step(12.5, speed_mps=0.2),
        seconds=20,
        faults=[fault("drive_restart", 9.0, node="lift", for_s=0.2)],
    )


def test_a_lift_whose_drive_has_restarted_is_not_taken_for_retracted(rides: Ridden) -> None:
    ride = with_a_restarted_lift(rides, step(10.0, disarm=True), step(10.5, arm=True), step(11.5, arm=True))
    ride.runs_until(14.0)
    assert ride.now["lift_m"] > 0.01
    assert ride.fastest(12.0, 14.0) < 0.002, "the lift is up"
    assert "axis zero lost: lift" in ride.holding


def test_a_lift_that_says_it_is_not_where_it_was_sent_is_not_armed(rides: Ridden) -> None:
    """Its target is still 50 mm, and its drive says 0: to arm now would move it."""
    ride = with_a_restarted_lift(rides, step(10.0, arm=True), step(11.0, arm=True))
    ride.runs_until(14.0)
    answers = [
        (entry.at, entry.text) for entry in ride.operator.diary.entries if entry.at >= from_seconds(11)
    ]
    assert (from_seconds(11), "arm: temporarily rejected") in answers
    assert any("its zero is lost" in text for _, text in answers)
    assert ride.now["lift_m"] == pytest.approx(0.05, abs=2e-4), "it has not moved"
    assert ride.fastest(9.0, 14.0) < 0.002


def test_a_supply_below_the_limit_switches_every_drive_off_and_the_robot_rolls_out(rides: Ridden) -> None:
    ride = driven(rides, fault("supply_sag", 6.0, to_v=9.0, for_s=0.2))
    assert {name: codes(ride, name) for name in NAMES} == {name: [0x3220] for name in NAMES}
    assert not any(axis.powered for axis in ride.rig.devices.bank.axes)
    assert 0.15 < ride.now["speed_mps"] < 0.25, "nothing brakes it but friction"
    ride.runs_until(12.0)
    assert stands(ride, 11.0)


def test_a_supply_above_the_limit_is_enough_at_this_speed(rides: Ridden) -> None:
    ride = driven(rides, fault("supply_sag", 5.0, to_v=14.0, for_s=2.0))
    assert ride.held_between(5.0, 7.5) == set()
    assert ride.now["speed_mps"] == pytest.approx(0.3, rel=0.02)


@pytest.mark.long(keeps=["encoder_cut-how5-65290"])
@pytest.mark.parametrize(
    ("kind", "how", "code"),
    [
        ("supply_sag", {"to_v": 9.9}, 0x3220),
        ("supply_surge", {"to_v": 80.0}, 0x3210),
        ("logic_supply_sag", {"to_v": 4.0}, 0x5113),
        ("gate_supply_sag", {"to_v": 4.0}, 0x5114),
        ("overheating", {"to_celsius": 120.0}, 0x4210),
        ("encoder_cut", {}, 0xFF0A),
        ("encoder_swapped", {}, 0xFF03),
        ("encoder_counts_lost", {"share": 0.05}, 0xFF03),
        ("index_missing", {}, 0xFF02),
        ("index_spurious", {}, 0xFF02),
    ],
)
def test_one_drive_that_fails_stops_the_robot_by_name_and_code(
    rides: Ridden, kind: str, how: dict[str, float], code: int
) -> None:
    ride = driven(rides, fault(kind, 6.0, node="right", for_s=0.3, **how), again=True)
    assert codes(ride, "right")[-1] == code
    assert f"0x{code:04X}" in ride.held("axis fault: right")[0]
    assert stands(ride, 7.3)
    assert all(codes(ride, name) == [] for name in NAMES if name != "right")
    drives_again(ride)


# The operator's link


def test_a_link_that_loses_everything_is_a_silent_operator(rides: Ridden) -> None:
    ride = driven(rides, fault("datagram_loss", 6.0, for_s=1.0), until=7.9, again=True)
    assert "operator silent" in ride.held_between(6.4, 6.6)
    assert abs(ride.rows(6.95, 7.05)[0]["speed_mps"]) < 0.002
    assert "controls deflected" in ride.holding
    assert abs(ride.now["speed_mps"]) < 0.002, "his old motion does not return by itself"
    drives_again(ride)


def test_late_datagrams_are_a_silent_operator_until_the_first_has_come(rides: Ridden) -> None:
    ride = driven(rides, fault("datagram_late", 6.0, by_ms=700, sender="operator", for_s=1.0), until=9.0)
    (hold,) = [
        hold for hold in ride.rig.holds if hold.name == "operator silent" and hold.began > from_seconds(4)
    ]
    assert to_seconds(hold.began) == pytest.approx(6.45, abs=0.06)
    assert hold.ended is not None
    assert to_seconds(hold.ended) == pytest.approx(6.95, abs=0.06)


def test_doubled_datagrams_change_nothing(rides: Ridden) -> None:
    ride = driven(rides, fault("datagram_doubled", 5.0, after_ms=20, for_s=8.0), again=True)
    assert ride.held_between(5.0, 7.5) == set()
    drives_again(ride)


def test_an_unplugged_adapter_is_named_and_its_drives_stop_by_themselves(rides: Ridden) -> None:
    ride = rides(
        *DRIVING, seconds=20, robot=over_serial(RARS), faults=[fault("serial_unplugged", 6.0, for_s=1.0)]
    )
    ride.runs_until(8.0)
    assert "link lost: drives" in ride.held_between(6.0, 6.5)
    assert ride.fastest(7.5) < 0.002


# The record


def test_the_record_says_which_faults_were_on_and_when(rides: Ridden) -> None:
    ride = driven(
        rides,
        fault("frame_loss", 5.0, node="steer", share=0.1, for_s=0.5, title="a loose contact"),
        fault("nmt_stranger", 5.5, command="start"),
        fault("datagram_late", 6.0, by_ms=10),
    )
    told = [(one.kind, one.title, to_seconds(one.began), one.ended) for one in ride.rig.faults.records]
    assert told == [
        ("frame_loss", "a loose contact", 5.0, from_seconds(5.5)),
        ("nmt_stranger", "", 5.5, from_seconds(5.5)),
        ("datagram_late", "", 6.0, None),
    ]
    assert ride.rig.faults.records[0].nodes == ("steer",)
