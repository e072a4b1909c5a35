"""The power machine and the network state, commanded over every way, on drives with motors."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import Ask, CommissioningError, Script, need
from firmware_bridge.families.epos2.commissioning.job import SilentError, WriteJob
from firmware_bridge.families.epos2.commissioning.network_command import NetworkCommand
from firmware_bridge.families.epos2.commissioning.overview import Overview
from firmware_bridge.families.epos2.commissioning.power import PROCEDURES, PowerCommand, Wanted
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.commissioning.rig import FAR, NEAR, OWN_LINE, WAYS, Rig, Way, rig_for

every_way = pytest.mark.parametrize("way", WAYS, ids=str)
S = PowerState
W = Wanted
TO: dict[PowerState, tuple[int, ...]] = {
    S.SWITCH_ON_DISABLED: (),
    S.READY_TO_SWITCH_ON: (0x0006,),
    S.SWITCHED_ON: (0x0006, 0x0007),
    S.OPERATION_ENABLED: (0x0006, 0x000F),
    S.QUICK_STOP_ACTIVE: (0x0006, 0x000F, 0x000B),
}
"""Controlwords that bring a drive into a state."""


def power(rig: Rig, node: int = NEAR) -> PowerState | None:
    word = rig.value(node, od.STATUSWORD)
    assert isinstance(word, int)
    return state_of(word)


def written(address: Address, value: int, size: int) -> Script:
    return (Ask(WriteJob(address, value.to_bytes(size, "little", signed=value < 0)), need(lambda _raw: ())),)


def brought(rig: Rig, state: PowerState) -> Rig:
    for word in TO[state]:
        rig.does(CanAccess(NEAR), written(od.CONTROLWORD, word, 2))
        rig.waits(50 * MILLISECOND)
    assert power(rig) is state
    return rig


@pytest.mark.parametrize(
    ("begin", "wanted", "end"),
    [
        *((begin, W.ENABLE, S.OPERATION_ENABLED) for begin in TO),
        *((begin, W.SHUTDOWN, S.READY_TO_SWITCH_ON) for begin in TO if begin is not S.QUICK_STOP_ACTIVE),
        (S.SWITCH_ON_DISABLED, W.QUICK_STOP, S.SWITCH_ON_DISABLED),
        (S.READY_TO_SWITCH_ON, W.QUICK_STOP, S.SWITCH_ON_DISABLED),
        (S.SWITCHED_ON, W.QUICK_STOP, S.SWITCH_ON_DISABLED),
        (S.OPERATION_ENABLED, W.QUICK_STOP, S.QUICK_STOP_ACTIVE),
        (S.QUICK_STOP_ACTIVE, W.QUICK_STOP, S.QUICK_STOP_ACTIVE),
        *((begin, W.DISABLE, S.SWITCH_ON_DISABLED) for begin in TO),
        *((begin, W.RESET_FAULT, begin) for begin in TO),
    ],
)
def test_every_command_from_every_state(begin: PowerState, wanted: Wanted, end: PowerState) -> None:
    rig = brought(Rig(), begin)
    rig.does(CanAccess(NEAR), PowerCommand(wanted).script())
    assert power(rig) is end


@every_way
def test_enabled_and_disabled_over_every_way(way: Way) -> None:
    rig = rig_for(way)
    rig.does(way.link(), PowerCommand(W.ENABLE).script())
    assert power(rig, way.node) is S.OPERATION_ENABLED
    rig.does(way.link(), PowerCommand(W.QUICK_STOP).script())
    assert power(rig, way.node) is S.QUICK_STOP_ACTIVE
    rig.does(way.link(), PowerCommand(W.DISABLE).script())
    assert power(rig, way.node) is S.SWITCH_ON_DISABLED


def test_quick_stop_active_is_not_left_by_shutdown() -> None:
    rig = brought(Rig(), S.QUICK_STOP_ACTIVE)
    with pytest.raises(CommissioningError, match=r"'shutdown' does not lead out of .* `state disable` first"):
        rig.does(CanAccess(NEAR), PowerCommand(W.SHUTDOWN).script())
    assert power(rig) is S.QUICK_STOP_ACTIVE


def test_what_stops_is_written_before_anything_is_read() -> None:
    for wanted in (W.QUICK_STOP, W.DISABLE):
        assert PROCEDURES[wanted].at_once is not None
        (first, *_) = PowerCommand(wanted).script()
        assert isinstance(first, Ask)
        assert isinstance(first.job, WriteJob)
        assert first.job.address == od.CONTROLWORD


def test_enabling_starts_no_profile_velocity_and_a_quick_stop_brings_a_turning_motor_to_rest() -> None:
    rig = Rig()
    for address, value, size in ((od.MODE, Mode.PROFILE_VELOCITY, 1), (od.TARGET_VELOCITY, 500, 4)):
        rig.does(CanAccess(NEAR), written(address, value, size))
    rig.does(CanAccess(NEAR), PowerCommand(W.ENABLE).script())
    rig.waits(SECOND)
    assert abs(rig.bank.axes[0].position) < 5, "halt is set"
    rig.does(CanAccess(NEAR), written(od.CONTROLWORD, 0x000F, 2))
    rig.waits(SECOND)
    assert rig.bank.axes[0].position > 5_000, "until someone takes it away"
    rig.does(CanAccess(NEAR), PowerCommand(W.QUICK_STOP).script())
    rig.waits(SECOND)
    rests_at = rig.bank.axes[0].position
    rig.waits(SECOND)
    assert rig.bank.axes[0].position == pytest.approx(rests_at, abs=5)


def faulted(rig: Rig) -> Rig:
    """Bring a drive into Fault by a receive PDO that is too short (0x8210)."""
    rig.does(CanAccess(NEAR), NetworkCommand(NmtCommand.START, NEAR).script())
    rig.drives[NEAR].receive(Packet(CAN, 0x200 + NEAR, b"\0"), rig.world.now)
    rig.waits(50 * MILLISECOND)
    assert power(rig) is S.FAULT
    return rig


@pytest.mark.parametrize("way", [way for way in WAYS if way.node != FAR], ids=str)
def test_a_fault_is_reset_and_its_history_kept(way: Way) -> None:
    rig = faulted(rig_for(way))
    rig.does(way.link(), PowerCommand(W.RESET_FAULT).script())
    assert power(rig) is S.SWITCH_ON_DISABLED
    overview = Overview(alone=False)
    rig.does(way.link(), overview.script())
    _, history = overview.readings
    value = history.value(Address(0x1003, 1))
    assert isinstance(value, int)
    assert value & 0xFFFF == 0x8210


def test_a_drive_in_fault_is_not_enabled_and_states_what_to_do() -> None:
    rig = faulted(Rig())
    with pytest.raises(CommissioningError, match=r"state 'fault'; .*`state reset-fault`"):
        rig.does(CanAccess(NEAR), PowerCommand(W.ENABLE).script())
    assert power(rig) is S.FAULT
    for wanted in (W.QUICK_STOP, W.DISABLE):
        rig.does(CanAccess(NEAR), PowerCommand(wanted).script())
        assert power(rig) is S.FAULT


def test_a_fault_whose_cause_stands_is_not_reset() -> None:
    rig = Rig(supply_mv=5_000)
    rig.waits(100 * MILLISECOND)
    assert power(rig) is S.FAULT
    with pytest.raises(CommissioningError, match="within 5 s; the cause of the fault still stands"):
        rig.does(CanAccess(NEAR), PowerCommand(W.RESET_FAULT).script())


@every_way
@pytest.mark.parametrize(
    ("command", "state"),
    [
        (NmtCommand.START, NmtState.OPERATIONAL),
        (NmtCommand.ENTER_PRE_OPERATIONAL, NmtState.PRE_OPERATIONAL),
        (NmtCommand.RESET_NODE, NmtState.PRE_OPERATIONAL),
        (NmtCommand.RESET_COMMUNICATION, NmtState.PRE_OPERATIONAL),
        (NmtCommand.STOP, NmtState.STOPPED),
    ],
)
def test_network_commands_reach_the_drive_that_is_meant(
    way: Way, command: NmtCommand, state: NmtState
) -> None:
    rig = rig_for(way)
    sent = NetworkCommand(command, way.node or None)
    rig.does(way.link(), sent.script())
    rig.waits(200 * MILLISECOND)
    meant = way.node or NEAR
    assert sent.node == meant
    assert rig.drives[meant].nmt_state is state
    assert rig.drives[NEAR + FAR - meant].nmt_state is NmtState.PRE_OPERATIONAL
    assert sent.seen is (command is not NmtCommand.STOP)


@pytest.mark.parametrize("generation", [None, *Generation])
def test_a_command_to_all_reaches_all_and_looks_at_none(generation: Generation | None) -> None:
    rig = Rig(generation)
    link = CanAccess(0) if generation is None else SerialAccess(generation)
    sent = NetworkCommand(NmtCommand.START, 0)
    rig.does(link, sent.script())
    rig.waits(50 * MILLISECOND)
    assert {drive.nmt_state for drive in rig.drives.values()} == {NmtState.OPERATIONAL}
    assert not sent.seen


def test_a_node_that_is_not_there_does_not_come_back_from_its_reset() -> None:
    rig = Rig()
    with pytest.raises(SilentError):
        rig.does(CanAccess(9), NetworkCommand(NmtCommand.RESET_NODE, 9).script())
    assert rig.world.now < 10 * SECOND


def test_a_drive_that_does_not_do_as_it_is_commanded_is_named() -> None:
    rig = Rig()
    rig.does(CanAccess(NEAR), NetworkCommand(NmtCommand.START, NEAR).script())
    with pytest.raises(CommissioningError, match="node 2 is operational after it"):
        # The one that is commanded is not the one that is looked at.
        rig.does(CanAccess(NEAR), NetworkCommand(NmtCommand.ENTER_PRE_OPERATIONAL, FAR).script())


@every_way
def test_the_overview_reports_the_network_states_that_are_possible(way: Way) -> None:
    rig = rig_for(way)
    alone = way.name in {"v1", "v2"}
    overview = Overview(alone=alone)
    rig.does(way.link(), overview.script())
    pre = (NmtState.PRE_OPERATIONAL, NmtState.STOPPED) if alone else (NmtState.PRE_OPERATIONAL,)
    assert (overview.state, overview.mode, overview.network) == (
        S.SWITCH_ON_DISABLED,
        Mode.PROFILE_POSITION,
        pre,
    )
    rig.does(way.link(), NetworkCommand(NmtCommand.START, way.node or None).script())
    overview = Overview(alone=alone)
    rig.does(way.link(), overview.script())
    assert overview.network == (NmtState.OPERATIONAL,)


def test_the_line_works_in_stopped_and_the_bus_does_not() -> None:
    rig = rig_for(OWN_LINE)
    rig.does(OWN_LINE.link(), NetworkCommand(NmtCommand.STOP, None).script())
    rig.does(OWN_LINE.link(), PowerCommand(W.DISABLE).script())
    with pytest.raises(SilentError):
        rig.does(CanAccess(NEAR), PowerCommand(W.DISABLE).script())
