"""Fault confinement of one CAN controller: the two error counters, and what they make of it.

Source: ISO 11898-1, fault confinement; Bosch CAN 2.0, part B, section 8. Not known here: what damages
frames.
"""

from enum import Enum
from typing import Final

PASSIVE_FROM: Final = 128
OFF_FROM: Final = 256
SENDING_FAILED: Final = 8
HEARING_FAILED: Final = 1
FIRST_TO_NOTICE: Final = 8
"""Added by the receiver whose own error flag the others only echo."""
BACK_FROM_PASSIVE: Final = 119
"""Value of a receive counter above 127 after the first good frame: 119 to 127 are allowed."""
RECOVERY_BITS: Final = 128 * 11
"""A controller that is off comes back after so many recessive bits; on a busy bus it takes longer."""


class Condition(Enum):
    """Error state of a controller."""

    ACTIVE = "error active"
    PASSIVE = "error passive"
    """It cannot destroy others' frames any more."""
    OFF = "bus off"
    """It neither sends nor receives."""


class Confinement:
    """Transmit and receive error counter (TEC, REC) of one controller."""

    __slots__ = ("condition", "receive", "transmit")

    def __init__(self) -> None:
        self.transmit = 0
        self.receive = 0
        self.condition = Condition.ACTIVE

    def sent(self) -> bool:
        """Count a frame that went well; whether the condition has changed."""
        # Bosch CAN 2.0 B, section 8, rule 7.
        self.transmit -= self.transmit > 0
        return self._judge()

    def received(self) -> bool:
        """Count a frame that was received well; return True if the condition has changed."""
        # Rule 8: one good frame brings a passive receiver back below the limit.
        if self.receive >= PASSIVE_FROM:
            self.receive = BACK_FROM_PASSIVE
        else:
            self.receive -= self.receive > 0
        return self._judge()

    def failed_to_send(self) -> bool:
        """Count a damaged frame of its own; whether the condition has changed."""
        # Rule 3: 8 for a sender, so that a node that spoils its own frames is off the bus after 32 of them.
        self.transmit += SENDING_FAILED
        return self._judge()

    def failed_to_receive(self, *, first: bool) -> bool:
        """Count a damaged frame of another's; whether the condition has changed."""
        if self.receive < PASSIVE_FROM:
            self.receive += HEARING_FAILED + FIRST_TO_NOTICE * first
        return self._judge()

    def recover(self) -> None:
        """Come back from bus off with empty counters."""
        self.transmit = self.receive = 0
        self.condition = Condition.ACTIVE

    def _judge(self) -> bool:
        before = self.condition
        if self.transmit >= OFF_FROM:
            self.condition = Condition.OFF
        elif self.transmit >= PASSIVE_FROM or self.receive >= PASSIVE_FROM:
            self.condition = Condition.PASSIVE
        else:
            self.condition = Condition.ACTIVE
        return self.condition is not before
