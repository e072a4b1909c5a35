"""The ways through the power states, against the transitions of CiA 402 as they stand in the standard."""

import pytest

from firmware_bridge.canopen.cia402 import (
    FAULT_RESET_WORDS,
    PASSING,
    STATES,
    TOWARDS,
    ControlwordBit,
    ControlwordCommand,
    PowerState,
    command_of,
    towards,
    word_of,
)
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS

S = PowerState
# Where each command leads at last, once the states that end by themselves have ended, or None where it does
# nothing: CiA 402, transitions 2 to 12 and 16.
COLUMNS = (
    ControlwordCommand.SHUTDOWN,
    ControlwordCommand.DISABLE_OPERATION,
    ControlwordCommand.ENABLE_OPERATION,
    ControlwordCommand.QUICK_STOP,
    ControlwordCommand.DISABLE_VOLTAGE,
)
LEADS = {
    S.SWITCH_ON_DISABLED: (S.READY_TO_SWITCH_ON, None, None, None, None),
    S.READY_TO_SWITCH_ON: (None, S.SWITCHED_ON, None, S.SWITCH_ON_DISABLED, S.SWITCH_ON_DISABLED),
    S.SWITCHED_ON: (
        S.READY_TO_SWITCH_ON,
        None,
        S.OPERATION_ENABLED,
        S.SWITCH_ON_DISABLED,
        S.SWITCH_ON_DISABLED,
    ),
    S.OPERATION_ENABLED: (
        S.READY_TO_SWITCH_ON,
        S.SWITCHED_ON,
        None,
        S.QUICK_STOP_ACTIVE,
        S.SWITCH_ON_DISABLED,
    ),
    S.QUICK_STOP_ACTIVE: (None, None, S.OPERATION_ENABLED, None, S.SWITCH_ON_DISABLED),
}
WAYS = [(wanted, state) for wanted, way in TOWARDS.items() for state in way]


@pytest.mark.parametrize(("wanted", "begin"), WAYS)
def test_every_way_ends_where_it_is_wanted(wanted: PowerState, begin: PowerState) -> None:
    state, passed = begin, []
    while state is not wanted:
        assert state not in passed, "it goes in a circle"
        passed.append(state)
        command = towards(state, wanted)
        assert command is not None, f"it ends in {state.title}"
        after = LEADS[state][COLUMNS.index(command)]
        assert after is not None, f"{command.value} does nothing in {state.title}"
        state = after


@pytest.mark.parametrize("wanted", TOWARDS)
def test_a_way_ends_at_its_end_and_begins_neither_in_a_fault_nor_in_a_passing_state(
    wanted: PowerState,
) -> None:
    for state in (wanted, S.FAULT, *PASSING, None):
        assert towards(state, wanted) is None


def test_only_the_way_to_operation_enabled_gives_power() -> None:
    for wanted, way in TOWARDS.items():
        assert (ControlwordCommand.ENABLE_OPERATION in way.values()) is (wanted is S.OPERATION_ENABLED)


def test_a_drive_without_power_is_never_sent_to_its_quick_stop() -> None:
    assert set(TOWARDS[S.QUICK_STOP_ACTIVE]) == {S.OPERATION_ENABLED}


def test_quick_stop_active_is_left_with_power_or_by_disable_voltage_alone() -> None:
    assert {wanted: way.get(S.QUICK_STOP_ACTIVE) for wanted, way in TOWARDS.items()} == {
        S.OPERATION_ENABLED: ControlwordCommand.ENABLE_OPERATION,
        S.READY_TO_SWITCH_ON: None,
        S.QUICK_STOP_ACTIVE: None,
        S.SWITCH_ON_DISABLED: ControlwordCommand.DISABLE_VOLTAGE,
    }


@pytest.mark.parametrize(
    ("command", "word"),
    [
        (ControlwordCommand.SHUTDOWN, 0x06),
        (ControlwordCommand.DISABLE_OPERATION, 0x07),
        (ControlwordCommand.ENABLE_OPERATION, 0x0F),
        (ControlwordCommand.QUICK_STOP, 0x02),
        (ControlwordCommand.DISABLE_VOLTAGE, 0x00),
    ],
)
def test_the_plainest_word_of_each_command(command: ControlwordCommand, word: int) -> None:
    assert word_of(command) == word
    assert command_of(word) is command


def test_a_fault_is_reset_by_a_rising_edge() -> None:
    before, after = FAULT_RESET_WORDS
    assert after & ~before & ControlwordBit.FAULT_RESET
    assert command_of(before) is ControlwordCommand.DISABLE_VOLTAGE


@pytest.mark.parametrize(
    "statusword", [0x0000, 0x0240, 0x0260, 0x0631, 0x1233, 0x1637, 0x0217, 0x020F, 0x0228]
)
def test_each_pattern_of_the_standard_is_one_state_whatever_the_other_bits(statusword: int) -> None:
    state = STATES.state_of(statusword)
    assert state is not None
    assert STATES.words[state] & 0x4F == statusword & 0x4F


@pytest.mark.parametrize("statusword", [0x0067, 0x002B, 0x0001, 0x0003])
def test_other_patterns_are_no_state(statusword: int) -> None:
    assert STATES.state_of(statusword) is None


OTHERWISE = {
    S.START: S.NOT_READY_TO_SWITCH_ON,
    S.REFRESH: S.SWITCHED_ON,
    S.MEASURE_INIT: S.SWITCHED_ON,
    S.FAULT_REACTION_DISABLED: S.FAULT_REACTION_ENABLED,
}


@pytest.mark.parametrize("state", STATUSWORDS)
def test_a_client_of_the_standard_reads_the_states_of_an_epos2(state: PowerState) -> None:
    assert STATES.state_of(STATUSWORDS[state]) is OTHERWISE.get(state, state)
