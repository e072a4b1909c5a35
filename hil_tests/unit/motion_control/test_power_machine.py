"""Every state against every command, and the statuswords that were recorded from maxon drives."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.control.power_states import TRANSITIONS, Delays
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS, state_of
from firmware_bridge.units import MILLISECOND
from hil_tests.rows import every

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive, Make

SLOW = Delays(
    start=2 * MILLISECOND,
    offset=2 * MILLISECOND,
    refresh=2 * MILLISECOND,
    measure=2 * MILLISECOND,
)
REMOTE, REACHED = 0x0200, 0x0400

# EPOS Firmware Specification, state transitions: base value of each state, and where each command leads.
# Columns: shutdown 06, switch on 07, enable 0F, quick stop 02, disable voltage 00, fault reset 80.
TABLE = {
    0x0140: (0x0121, 0x0140, 0x0140, 0x0140, 0x0140, 0x0140),
    0x0121: (0x0121, 0x0123, 0x0137, 0x0140, 0x0140, 0x0121),
    0x0123: (0x0121, 0x0123, 0x0137, 0x0140, 0x0140, 0x0123),
    0x0137: (0x0121, 0x0123, 0x0137, 0x0117, 0x0140, 0x0137),
    0x0117: (0x0117, 0x0117, 0x0137, 0x0117, 0x0140, 0x0117),
    0x0108: (0x0108, 0x0108, 0x0108, 0x0108, 0x0108, 0x0140),
    # A command waits until these states are over: here they end in Switch on disabled, enabled, or Fault.
    0x0100: (0x0121, 0x0140, 0x0140, 0x0140, 0x0140, 0x0140),
    0x4123: (0x0121, 0x0123, 0x0137, 0x0117, 0x0140, 0x0137),
    0x4133: (0x0121, 0x0123, 0x0137, 0x0117, 0x0140, 0x0137),
    0x011F: (0x0108, 0x0108, 0x0108, 0x0108, 0x0108, 0x0108),
}
WORDS = (0x06, 0x07, 0x0F, 0x02, 0x00, 0x80)
CASES = [(state, word, after) for state, row in TABLE.items() for word, after in zip(WORDS, row, strict=True)]


def lead_to(drive: "Drive", state: int) -> None:
    """Bring a drive with slow states into one of them."""
    if state == 0x0100:
        drive.run(3)
        return
    drive.run(10)
    path: dict[int, tuple[int, ...]] = {
        0x0140: (),
        0x0121: (0x06,),
        0x0123: (0x06, 0x07),
        0x4123: (0x06, 0x07, 0x0F),
        0x4133: (0x06, 0x07, 0x0F),
        0x0137: (0x06, 0x07, 0x0F),
        0x0117: (0x06, 0x07, 0x0F),
        0x0108: (),
        0x011F: (0x06, 0x07, 0x0F),
    }
    if state == 0x011F:
        drive.write(od.MODE, 3)
        drive.write(od.TARGET_VELOCITY, 3000)
    drive.command(*path[state])
    if state in (0x0137, 0x0117, 0x4133, 0x011F):
        drive.run(3 if state == 0x4133 else 10)
    if state == 0x0117:
        drive.command(0x02)
    if state == 0x0108:
        drive.control.communication_fault(0x8210)
    if state == 0x011F:
        drive.run(100)
        drive.control.communication_fault(0x8210)


@every(("state", "word", "after"), CASES, ids=hex)
def test_every_command_in_every_state(make: "Make", state: int, word: int, after: int) -> None:
    drive = make(SLOW, boot=False)
    lead_to(drive, state)
    assert STATUSWORDS[drive.state] == state
    assert drive.statusword & 0x417F == state
    drive.command(word)
    drive.run(400)
    assert STATUSWORDS[drive.state] == after
    assert bool(drive.axis.powered) == bool(after & 0x10)


def test_start_is_the_first_state(make: "Make") -> None:
    drive = make(SLOW, boot=False)
    assert STATUSWORDS[drive.state] == 0x0000
    drive.run(10)
    assert [word & 0x417F for word in drive.words] == [0x0100, 0x0140]


def test_the_table_names_each_transition_but_the_node_reset() -> None:
    assert {row.number for row in TRANSITIONS} == set(range(22)) - {19}


def test_recorded_enable_sequence(drive: "Drive") -> None:
    # Recorded from a maxon drive: 182 40 07, then 06 -> 21 07, 07 -> 23 07, 0F -> 37 07, nothing between.
    drive.words.clear()
    drive.command(0x06, 0x07, 0x0F)
    assert drive.words == [0x0721, 0x0723, 0x0737]
    drive.run(100)
    assert drive.words == [0x0721, 0x0723, 0x0737]


def test_recorded_statusword_after_power_on(drive: "Drive") -> None:
    # Recorded: 182 40 07, switch on disabled, remote, target reached.
    assert drive.statusword == 0x0740


def test_bit_12_at_rest_in_profile_velocity_mode(drive: "Drive") -> None:
    # Recorded elsewhere: 0x1740. Assumed: a drive in profile velocity mode, speed = 0.
    drive.write(od.MODE, 3)
    assert drive.statusword == 0x1740


def test_the_remote_bit_follows_the_network_state(drive: "Drive") -> None:
    drive.control.nmt_changed(operational=False)
    assert drive.statusword == 0x0540
    drive.control.nmt_changed(operational=True)
    assert drive.statusword == 0x0740


def test_switch_on_with_bit_3_does_two_transitions(drive: "Drive") -> None:
    drive.command(0x06)
    drive.words.clear()
    drive.command(0x0F)
    assert drive.words == [0x0737]


def test_a_brushless_motor_shows_refresh_and_measure_init(drive: "Drive") -> None:
    drive.write(od.MOTOR_TYPE, 10)
    drive.words.clear()
    drive.command(0x06, 0x0F)
    assert drive.axis.powered == 0
    drive.run(5)
    assert drive.axis.powered == 1
    drive.run(20)
    assert [word & 0x417F for word in drive.words] == [0x0121, 0x4123, 0x4133, 0x0137]


def test_quick_stop_active_stays_until_a_command(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.command(0x02)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    ms = drive.runs_until(lambda: drive.statusword & REACHED == REACHED)
    assert ms == pytest.approx(50, abs=3)  # 3000 rpm at 60 000 rpm/s, 0x6085
    drive.run(2000)
    assert drive.stands_in(PowerState.QUICK_STOP_ACTIVE)
    assert drive.axis.powered
    assert abs(drive.rpm) < 30
    drive.command(0x0F)
    drive.run(300)
    assert drive.rpm == pytest.approx(3000, rel=0.05)


@pytest.mark.parametrize(
    ("option", "word", "at_once"),
    [
        ((od.SHUTDOWN_OPTION, 0), 0x06, True),
        ((od.SHUTDOWN_OPTION, 1), 0x06, False),
        ((od.DISABLE_OPTION, 0), 0x07, True),
        ((od.DISABLE_OPTION, 1), 0x07, False),
        ((od.DISABLE_OPTION, 1), 0x00, True),
    ],
)
def test_option_codes_slow_down_before_power_goes(
    drive: "Drive", option: tuple[Address, int], word: int, *, at_once: bool
) -> None:
    drive.enable(mode=3)
    drive.write(*option)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.command(word)
    assert bool(drive.axis.powered) is not at_once
    if not at_once:
        ms = drive.runs_until(lambda: not drive.axis.powered)
        assert ms == pytest.approx(200, abs=4)  # 3000 rpm at 15 000 rpm/s, 0x6084
        assert abs(drive.rpm) < 100
    assert (
        state_of(drive.statusword)
        is {
            0x06: PowerState.READY_TO_SWITCH_ON,
            0x07: PowerState.SWITCHED_ON,
            0x00: PowerState.SWITCH_ON_DISABLED,
        }[word]
    )


def test_a_command_during_a_slow_down_waits_for_its_end(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.command(0x07, 0x00)
    drive.run(100)
    assert drive.stands_in(PowerState.OPERATION_ENABLED)
    drive.run(150)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)


def test_a_node_reset_leads_back_to_the_start(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.write(od.TARGET_VELOCITY, 3000)
    drive.run(300)
    drive.control.reset()
    assert not drive.axis.powered
    assert drive.read(od.POSITION_ACTUAL) == 0
    drive.run(10)
    assert drive.stands_in(PowerState.SWITCH_ON_DISABLED)
