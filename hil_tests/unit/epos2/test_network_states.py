"""Boot-up, network commands, and which services live in which state (CiA 301 v4.02)."""

from dataclasses import replace

import pytest

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.choices import CHOICES
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.epos2.quiet_motion import Desk, operational, powered

STATES = {
    NmtState.PRE_OPERATIONAL: "8001",
    NmtState.OPERATIONAL: "0101",
    NmtState.STOPPED: "0201",
}


def in_state(state: NmtState) -> Desk:
    desk = operational()
    desk.receives(f"000#{STATES[state]}")
    assert desk.drive.nmt_state is state
    desk.waits(10 * MILLISECOND)
    return desk


def test_a_drive_that_is_off_receives_nothing() -> None:
    desk = Desk()
    assert desk.receives("601#4000100000000000") == ["701#00"]


def test_power_on_ends_in_pre_operational_with_a_boot_up() -> None:
    desk = Desk()
    assert desk.powers() == ["701#00"]
    assert desk.drive.nmt_state is NmtState.PRE_OPERATIONAL
    assert desk.motion.resets == 1


def test_booting_can_be_made_to_take_time_and_is_silent() -> None:
    desk = Desk(replace(EPOS2_70_10, boot_time=50 * MILLISECOND))
    assert desk.powers() == []
    for frame in ("601#4000100000000000", "000#0100", "701#R1", "080#"):
        assert desk.receives(frame) == []
    assert desk.waits_until(50 * MILLISECOND) == ["701#00"]
    assert desk.drive.nmt_state is NmtState.PRE_OPERATIONAL


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(
    ("command", "target"),
    [("01", NmtState.OPERATIONAL), ("02", NmtState.STOPPED), ("80", NmtState.PRE_OPERATIONAL)],
)
@pytest.mark.parametrize("node", ["00", "01"])
def test_commands_lead_from_every_state_to_theirs(
    state: NmtState, command: str, target: NmtState, node: str
) -> None:
    desk = in_state(state)
    desk.receives(f"000#{command}{node}")
    assert desk.drive.nmt_state is target
    assert desk.motion.operational == (target is NmtState.OPERATIONAL)


@pytest.mark.parametrize("frame", ["000#0102", "000#01", "000#", "000#0301", "000#0001", "000#R2"])
def test_commands_for_others_and_odd_frames_change_nothing(frame: str) -> None:
    desk = powered()
    assert desk.receives(frame) == []
    assert desk.drive.nmt_state is NmtState.PRE_OPERATIONAL


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(("command", "resets"), [("8101", 2), ("8201", 1)])
def test_both_resets_boot_again(state: NmtState, command: str, resets: int) -> None:
    desk = in_state(state)
    assert desk.receives(f"000#{command}") == ["701#00"]
    assert desk.drive.nmt_state is NmtState.PRE_OPERATIONAL
    assert desk.motion.resets == resets


def test_reset_communication_loads_communication_only() -> None:
    desk = powered()
    desk.writes(0x1017, 0, (500).to_bytes(2, "little"))
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    desk.receives("000#8201")
    assert desk.reads(0x1017) == 0
    assert desk.reads(0x6083) == 777
    desk.receives("000#8101")
    assert desk.reads(0x6083) == 10_000


@pytest.mark.parametrize(
    ("state", "sdo", "emergency", "guarding"),
    [
        (NmtState.PRE_OPERATIONAL, True, True, "7F"),
        (NmtState.OPERATIONAL, True, True, "05"),
        (NmtState.STOPPED, False, False, "04"),
    ],
)
def test_services_live_in_their_states(state: NmtState, *, sdo: bool, emergency: bool, guarding: str) -> None:
    desk = in_state(state)
    assert bool(desk.receives("601#4000100000000000")) is sdo
    assert desk.receives("701#R1") == [f"701#{guarding}"]
    desk.motion.report(0x8611)
    assert ("081#1186200000000000" in desk.receives("701#R1")) is emergency


def test_a_transfer_does_not_survive_the_stopped_state() -> None:
    desk = powered()
    desk.receives("601#4004200000000000")
    desk.receives("000#0201")
    desk.receives("000#8001")
    assert desk.receives("601#6000000000000000") == ["581#8000000001000405"]


@pytest.mark.parametrize(
    "frame", ["602#4000100000000000", "80000601#40001000", "201#0600", "100#", "7E5#0401", "701#05", "77F#05"]
)
def test_frames_that_no_one_here_takes_are_left_alone(frame: str) -> None:
    assert powered().receives(frame) == []


def test_remote_requests_to_data_services_are_left_alone() -> None:
    desk = operational()
    for frame in ("601#R8", "080#R0", "201#R2", "000#R2", "081#R8"):
        assert desk.receives(frame) == []


@pytest.mark.parametrize("node", [128, -1])
def test_a_node_number_that_no_switch_can_give(node: int) -> None:
    with pytest.raises(ValueError, match="between 0 and 127"):
        Epos2(node, ServoAxis("desk", 2000))


def test_identity_comes_from_the_profile() -> None:
    desk = powered(replace(EPOS2_70_10, hardware_version=0x6220, serial_number=0x1122_3344_5566_7788))
    assert desk.reads(0x1018, 2) == 0x6220_0000
    assert desk.reads(0x1018, 3) == 0x2126_0000
    assert desk.reads(0x1018, 4) == 0x5566_7788
    assert desk.reads(0x2003, 2) == 0x6220
    assert desk.reads(0x2009) == 1
    assert desk.reads(0x1400, 1) == 0x201


def test_every_open_choice_names_its_source() -> None:
    assert len(CHOICES) > 10
    assert all(choice.known.source for choice in CHOICES.values())


def test_the_time_stamp_is_latched_at_sync_and_follows_its_master() -> None:
    desk = powered()
    desk.waits_until(5 * MILLISECOND)
    desk.receives("080#")
    assert desk.reads(0x1013) == 5000
    desk.waits(MILLISECOND)
    assert desk.reads(0x1013) == 5000
    assert desk.writes(0x1013, 0, (100_000).to_bytes(4, "little")) == "ok"
    desk.receives("080#")
    assert desk.reads(0x1013) == 101_000
    assert desk.writes(0x1013, 0, (101_007).to_bytes(4, "little")) == "ok"
    desk.receives("080#")
    assert desk.reads(0x1013) == 101_007


def test_a_drive_works_with_its_own_motion_control() -> None:
    drive = Epos2(3, ServoAxis("steer", 2000))
    assert [packet.address for packet in drive.wake(0).sent] == [0x703]
    assert drive.store.get(od.MODE_DISPLAY) == 1
