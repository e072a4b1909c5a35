"""The bits of an EPOS2's values, decoded.

Sources: EPOS Firmware Specification (state machine, modes; by analogy), maxon's command library for the modes
that are the maker's own.
"""

from typing import Final

from firmware_bridge.canopen.cia402 import Status
from firmware_bridge.canopen.drive_words import BIT_12, BIT_13, VOLTAGE_ENABLED, DriveWords
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.families.epos2.wire.power_states import REFERENCED, STATES

WORDS: Final = DriveWords(
    states=STATES,
    modes=Mode,
    no_mode="no mode of the EPOS2",
    bits={
        VOLTAGE_ENABLED: "power stage on",
        Status.REMOTE: "remote (NMT operational)",
        Status.TARGET_REACHED: "target reached",
        Status.INTERNAL_LIMIT: "current limited (I2t)",
        REFERENCED: "position referenced to home",
    },
    bit_12=BIT_12,
    bit_13={**BIT_13, Mode.POSITION: "following error"},
    causes={code: row.cause for code, row in EMERGENCIES.items()},
)
