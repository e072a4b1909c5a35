"""The inputs of a drive as its control uses them; a product's subclass has the pins.

Masks: a bit for each function, by its number; the first three are those of `homing_methods.Switch`.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from firmware_bridge.canopen.cia402 import ControlwordCommand


class DriveInputs:
    """Inputs of a drive that has none."""

    def __init__(self) -> None:
        self.active = 0
        """Functions whose signal is there."""
        self.executed = 0
        """Active functions that act by themselves."""
        self.risen = 0
        """Functions that have begun to act since the refresh before the last one."""
        self.restriction: ControlwordCommand | None = None
        """The command that the inputs give in place of a master's weaker one."""
        self.fitted = 0
        """Functions that an input has."""

    def refresh(self) -> None:
        """Take in the inputs as the axis has sampled them last."""

    def limits_met(self, heading: int, sought: int) -> tuple[int, ...]:
        """Return the emergencies of the limit switches that have just been met, or are headed into.

        `heading` is the sign of the demanded motion; `sought` are functions that a homing looks for.
        """
        del heading, sought
        return ()
