"""Transition of a drive to a state of CiA 402, Controlword by Controlword, checked until it is reached.

The Controlwords are those of maxon's command library; enabling ends with halt set, as its library does, so
that in the profile modes nothing moves until the Controlword is written without it. In the modes that follow
a set value at once (position, velocity, current, and analog or encoder set-points) halt does not count.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import (
    FAULT_RESET_WORDS,
    PASSING,
    TOWARDS,
    ControlwordBit,
    ControlwordCommand,
    PowerState,
    word_of,
)
from firmware_bridge.families.epos2.commissioning.client import Ask, CommissioningError, Script, Wait, need
from firmware_bridge.families.epos2.commissioning.job import ReadJob, WriteJob
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

LOOK_EVERY: Final[Nanoseconds] = 10 * MILLISECOND
LOOKS: Final = 500
"""So many looks, 5 s, as maxon's command library does."""

ENABLE_WITH_HALT: Final = word_of(ControlwordCommand.ENABLE_OPERATION) | ControlwordBit.HALT
_WORDS: Final[Mapping[ControlwordCommand, int]] = {
    # Enabling while only ready switches on first: transition 3, then 4.
    ControlwordCommand.DISABLE_OPERATION: ENABLE_WITH_HALT,
    ControlwordCommand.ENABLE_OPERATION: ENABLE_WITH_HALT,
}
"""Controlwords that are not the plainest ones of their commands."""
_HINTS: Final = {
    PowerState.FAULT: "read `state` for the cause, then `state reset-fault`",
    PowerState.QUICK_STOP_ACTIVE: "`state disable` first",
}
_OFF: Final = frozenset({PowerState.SWITCH_ON_DISABLED, PowerState.FAULT})


class Wanted(Enum):
    """The state that an engineer requests of the drive."""

    ENABLE = "enable"
    SHUTDOWN = "shutdown"
    QUICK_STOP = "quick-stop"
    DISABLE = "disable"
    RESET_FAULT = "reset-fault"


@dataclass(frozen=True, slots=True)
class Procedure:
    """Procedure for a state: the Controlwords to write in each state, and the states in which it is done."""

    words: Mapping[PowerState, tuple[int, ...]]
    done: frozenset[PowerState]
    leaves: str
    """State in which it leaves the drive."""
    at_once: int | None = None
    """A Controlword that is written before anything is read: a stop must not wait."""
    may_move: bool = False


def _words_towards(wanted: PowerState) -> Mapping[PowerState, tuple[int, ...]]:
    return {state: (_WORDS.get(command, word_of(command)),) for state, command in TOWARDS[wanted].items()}


PROCEDURES: Final[Mapping[Wanted, Procedure]] = {
    Wanted.ENABLE: Procedure(
        _words_towards(PowerState.OPERATION_ENABLED),
        frozenset({PowerState.OPERATION_ENABLED}),
        "the power stage is on and stays on when this program ends; halt is set where this command "
        "enabled it; `state disable` switches it off",
        may_move=True,
    ),
    Wanted.SHUTDOWN: Procedure(
        _words_towards(PowerState.READY_TO_SWITCH_ON),
        frozenset({PowerState.READY_TO_SWITCH_ON}),
        "the power stage is off; what turned is slowed down or runs out, by 0x605B",
    ),
    Wanted.QUICK_STOP: Procedure(
        {},
        frozenset({PowerState.QUICK_STOP_ACTIVE}) | _OFF,
        "an enabled drive ramps down with 0x6085 and then holds with power; `state disable` switches it off",
        at_once=word_of(ControlwordCommand.QUICK_STOP),
    ),
    Wanted.DISABLE: Procedure(
        {},
        _OFF,
        "the power stage is off; a motor that turned runs out, and only a brake holds a load",
        at_once=word_of(ControlwordCommand.DISABLE_VOLTAGE),
    ),
    Wanted.RESET_FAULT: Procedure(
        {PowerState.FAULT: FAULT_RESET_WORDS},
        frozenset(PowerState) - PASSING - {PowerState.FAULT},
        "the power stage is as it was, off after a fault; the error history is kept, "
        "`write number-of-errors 0` clears it",
    ),
}


class PowerCommand:
    """One procedure, carried out."""

    def __init__(self, wanted: Wanted) -> None:
        self.wanted: Final = wanted
        self.procedure: Final = PROCEDURES[wanted]
        self._looks_left = LOOKS
        self._written_in: PowerState | None = None

    def script(self) -> Script:
        """Write what has to be written, and look until the drive is where it is wanted."""
        word = self.procedure.at_once
        return self._looks() if word is None else (*_writes((word,)), *self._looks())

    def _looks(self) -> Script:
        return (Ask(ReadJob(od.STATUSWORD), need(partial(self._look))),)

    def _look(self, raw: bytes) -> Script:
        statusword = int.from_bytes(raw, "little")
        state = state_of(statusword)
        if state is None:
            raise CommissioningError(
                f"the statusword 0x{statusword:04X} is no known state; is this an EPOS2?"
            )
        if state in self.procedure.done:
            return ()
        # Once in each state: a drive that does not follow it needs time, or another command.
        words = () if state is self._written_in else self.procedure.words.get(state, ())
        if words:
            self._written_in = state
            return (*_writes(words), *self._looks())
        # Passing states end by themselves, and a drive may brake before it follows a Controlword.
        waits = state in PASSING or state is self._written_in or self.procedure.at_once is not None
        if not waits:
            raise CommissioningError(f"{self._stuck(state)}; {_HINTS.get(state, 'see `state`')}")
        self._looks_left -= 1
        if self._looks_left == 0:
            waited = to_seconds(LOOKS * LOOK_EVERY)
            raise CommissioningError(f"{self._stuck(state)} within {waited:g} s; {self._cause(state)}")
        return (Wait(LOOK_EVERY), *self._looks())

    def _stuck(self, state: PowerState) -> str:
        return f"'{self.wanted.value}' does not lead out of the state '{state.title}'"

    def _cause(self, state: PowerState) -> str:
        if state is PowerState.FAULT:
            return "the cause of the fault still stands, see `state`; some need `nmt reset-node`"
        return "see `state`; a second controller may write the controlword, too"


def _writes(words: tuple[int, ...]) -> Script:
    return tuple(
        Ask(WriteJob(od.CONTROLWORD, word.to_bytes(2, "little")), need(lambda _raw: ())) for word in words
    )
