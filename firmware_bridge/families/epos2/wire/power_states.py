"""The EPOS2's power states in its Statusword: maxon's bits 8 and 14 beside those of CiA 402, and more states.

Sources: EPOS Firmware Specification, section on the state machine (by analogy for the EPOS2), names as in
maxon's command library.
"""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.canopen.cia402 import PowerState, StatePattern, StateTable

STATE_BITS: Final = 0x417F
"""The Statusword bits of the state: 14, 8 and 6 to 0; 9 to 13 and 15 have other meanings, 7 none."""

REFERENCED: Final = 1 << 15
"""Statusword bit of a drive whose position is referenced to home."""
STATES: Final = StateTable(
    tuple(
        StatePattern(state, STATE_BITS, word)
        for state, word in (
            (PowerState.START, 0x0000),
            # Bit 8: the current offset is measured.
            (PowerState.NOT_READY_TO_SWITCH_ON, 0x0100),
            (PowerState.SWITCH_ON_DISABLED, 0x0140),
            (PowerState.READY_TO_SWITCH_ON, 0x0121),
            (PowerState.SWITCHED_ON, 0x0123),
            (PowerState.REFRESH, 0x4123),
            (PowerState.MEASURE_INIT, 0x4133),
            (PowerState.OPERATION_ENABLED, 0x0137),
            (PowerState.QUICK_STOP_ACTIVE, 0x0117),
            (PowerState.FAULT_REACTION_DISABLED, 0x010F),
            (PowerState.FAULT_REACTION_ENABLED, 0x011F),
            (PowerState.FAULT, 0x0108),
        )
    )
)
STATUSWORDS: Final[Mapping[PowerState, int]] = STATES.words
"""The Statusword of each state, without any other bit."""


def state_of(statusword: int) -> PowerState | None:
    """Return the state in an EPOS2's Statusword; None for a pattern that is no state."""
    return STATES.state_of(statusword)
