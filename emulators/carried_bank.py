"""A base with an arm on it: two boards above one plant, in which each moves the other.

They go on in turns of half a millisecond: first the base's, whose motors take the plant along, then the
arm's, whose pulses count from the next turn on.
"""

from typing import Final

from emulators.arduino_omni.board import Board
from emulators.shield_bank import ShieldBank, ShieldMotor
from emulators.stepper_bank import STEP, StepperBank, StepperMotor
from firmware_bridge.units import Nanoseconds


class CarriedBank:
    """Physics between two events: a base's board with its motors, and an arm's with its joints."""

    def __init__(self, base: ShieldBank, board: Board, arm: StepperBank) -> None:
        self.axes: Final[tuple[ShieldMotor | StepperMotor, ...]] = (*base.axes, *arm.axes)
        self._base: Final = base
        self._motors: Final = board.motors
        self._arm: Final = arm
        self._now: Nanoseconds = 0

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`; the boards ask to be woken when they may have something to say."""
        while self._now < until:
            # On the grid of half a millisecond, whatever the instants of the calls are.
            self._now = min(until, self._now - self._now % STEP + STEP)
            # The base's motors step the plant; the arm's pulses count from the next step on.
            self._base.advance(self._now)
            self._motors.advance(self._now)
            self._arm.advance(self._now)
        return until, ()
