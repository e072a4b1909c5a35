"""The emergencies against the states of the power machine: what each does where, and what ends it.

Computed from the tables that the emulation works with.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from emulators.canopen.power_states import Happening
from emulators.epos2.control.power_states import TRANSITIONS
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.emergency import Emergency, FaultReaction, Recovery
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES

HEADINGS: Final = (
    "code",
    "cause",
    "0x1001",
    "not enabled",
    "enabled",
    "recovery",
    "known",
    "tests",
)
_RECOVERY: Final = {
    Recovery.FAULT_RESET: "fault reset",
    Recovery.RESET_COMMUNICATION: "reset communication, then fault reset",
    Recovery.RESET_NODE: "reset node",
}
_ENABLED: Final = {
    FaultReaction.NONE: "reported only",
    FaultReaction.DISABLE: "power off at once, Fault",
    FaultReaction.QUICK_STOP: "by 0x605E, by default ramp with 0x6085; power off, Fault",
}
CONNECTION: Final = 0x8130
UNTESTED: Final = "no cause in the emulation yet"

Tests = Mapping[int, Sequence[str]]
"""Names of the tests that reach an emergency by its cause, by its code."""


def cells(row: Emergency, tests: Tests) -> tuple[str, ...]:
    """Return the texts of one line, as `HEADINGS` names them."""
    reported_only = row.reaction is FaultReaction.NONE
    powered = _ENABLED[row.reaction]
    if row.code == CONNECTION:
        powered = "by 0x6007, by default ramp with 0x6085; power off, Fault"
    return (
        f"0x{row.code:04X}",
        row.cause,
        f"0x{row.register:02X}",
        "reported only" if reported_only else "Fault",
        powered,
        "none needed" if reported_only else _RECOVERY[row.recovery],
        row.provenance.value,
        ", ".join(tests.get(row.code, ())) or UNTESTED,
    )


def table(tests: Tests) -> list[tuple[str, ...]]:
    """Return every line, in the order of the codes."""
    return [cells(EMERGENCIES[code], tests) for code in sorted(EMERGENCIES)]


def states_not_enabled() -> tuple[PowerState, ...]:
    """Return the states that a fault leaves by way of the reaction while disabled (transition 13)."""
    return _faulting(PowerState.FAULT_REACTION_DISABLED)


def states_enabled() -> tuple[PowerState, ...]:
    """Return the states that a fault leaves by way of the reaction while enabled (transition 17)."""
    return _faulting(PowerState.FAULT_REACTION_ENABLED)


def _faulting(target: PowerState) -> tuple[PowerState, ...]:
    return tuple(row.source for row in TRANSITIONS if row.trigger is Happening.FAULT and row.target is target)
