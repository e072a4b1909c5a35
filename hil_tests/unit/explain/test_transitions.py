"""The states that commands lead to are those of the emulated drive's table."""

from emulators.canopen.power_states import CIA_402, leaving
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.explain.drive_state import REACHED

SHOWN = frozenset({PowerState.READY_TO_SWITCH_ON, PowerState.SWITCHED_ON})


def test_each_transition_by_a_command_is_that_of_the_drive() -> None:
    table = leaving(CIA_402)
    for state in PowerState:
        for command in ControlwordCommand:
            row = table[state].get(command)
            expected = None if row is None else row.target
            # Switch on with bit 3 goes on to operation enabled.
            if row is not None and row.goes_on:
                expected = table[row.target][command].target
            assert REACHED.get(state, {}).get(command) is expected, (state, command)
