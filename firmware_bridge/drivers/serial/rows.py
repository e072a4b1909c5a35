"""What the bridge reads from every drive over a serial line, and how often: one row for each object.

A serial line carries one command at a time. What safety and odometry hang on is read in every cycle; the rest
takes turns, so that no cycle has more of it than one object.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import DataType


@dataclass(frozen=True, slots=True)
class ReadRow:
    """One object, read once in so many cycles."""

    address: Address
    type: DataType
    name: str
    every: int = 1
    """Cycles."""
    phase: int = 0
    """The cycle of the first drive's turn."""
    step: int = 0
    """So many cycles later it is the next drive's."""

    def due(self, cycle: int, place: int) -> bool:
        """Tell whether the drive at this place, from 0, is read in this cycle."""
        return (cycle - self.phase - place * self.step) % self.every == 0


POSITION: Final = ReadRow(at.POSITION_ACTUAL, DataType.INTEGER32, "position")
STATUSWORD: Final = ReadRow(at.STATUSWORD, DataType.UNSIGNED16, "statusword")
CURRENT: Final = ReadRow(at.CURRENT_AVERAGED, DataType.INTEGER16, "current", every=8, step=2)
ERROR_REGISTER: Final = ReadRow(
    at.ERROR_REGISTER, DataType.UNSIGNED8, "error register", every=20, phase=1, step=2
)

IN_EVERY_CYCLE: Final = (POSITION, STATUSWORD)
"""All drives' positions first, so that they are of nearly one instant; the statuswords are newer."""
IN_TURN: Final = (CURRENT, ERROR_REGISTER)
