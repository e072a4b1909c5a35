"""The shape of an emergency's row: code, error register, reaction, recovery; the codes of CiA 301.

Source: CiA 301 v4.02, emergency object and 0x1001. The codes of a product are in its own table.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final

from firmware_bridge.canopen.object_row import Provenance

NO_ERROR: Final = 0x0000
"""Emergency error code after the last error has gone."""


class FaultReaction(Enum):
    """Reaction of the drive to the error that appears."""

    NONE = "none"
    DISABLE = "power stage off at once"
    QUICK_STOP = "ramp down with 0x6085, then power stage off"


class Recovery(Enum):
    """Action that lets the drive leave the fault once the cause is gone."""

    FAULT_RESET = "controlword bit 7, rising edge"
    RESET_COMMUNICATION = "network management: reset communication"
    RESET_NODE = "network management: reset node"


class RegisterBit:
    """Bits of the error register 0x1001."""

    GENERIC: Final = 1 << 0
    CURRENT: Final = 1 << 1
    VOLTAGE: Final = 1 << 2
    TEMPERATURE: Final = 1 << 3
    COMMUNICATION: Final = 1 << 4
    PROFILE: Final = 1 << 5
    MANUFACTURER: Final = 1 << 7


@dataclass(frozen=True, slots=True)
class Emergency:
    """One error that a device can report."""

    code: int
    register: int
    """Bits of 0x1001 that are set while the error stands."""
    reaction: FaultReaction
    cause: str
    recovery: Recovery = Recovery.FAULT_RESET
    provenance: Provenance = Provenance.BY_ANALOGY
    source: str = ""
