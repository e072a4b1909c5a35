"""The proof that motors are released: the board has answered the commands for it, or a request behind them.

A board obeys in order, so an answer stands for all before it; but not for commands before a request that has
no answer, nor before a reset.
"""

from collections.abc import Sequence

from firmware_bridge.families.motor_shield.driver.dialects import BoardMessage
from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor


class Releasing:
    """Of the motors of one board."""

    def __init__(self) -> None:
        self._proved_by: int | None = None
        """The question, counted from 1, whose answer proves it; None where none does."""

    def begin(
        self, motors: Sequence[ShieldMotor], requested: int, commands: Sequence[BoardMessage] = ()
    ) -> None:
        """Note that these commands release motors; so many requests were sent before them."""
        for motor in motors:
            motor.direction = 0
        questions = [command.reads is not None for command in commands]
        # Where the last command has no answer of its own, that of the next request proves it.
        self._proved_by = requested + sum(questions) + (not any(questions[-1:]))

    def forget(self) -> None:
        """Note that commands may not have arrived."""
        self._proved_by = None

    def answered(self, requested: int, motors: Sequence[ShieldMotor]) -> None:
        """Learn that the newest of so many questions was answered."""
        if self._proved_by is not None and requested >= self._proved_by:
            for motor in motors:
                motor.released = motor.direction == 0
