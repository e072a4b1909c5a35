"""One object of a drive that is read or written beside its tasks."""

from dataclasses import dataclass

from firmware_bridge.canopen.sdo_client import Outcome, Transfer
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import Nanoseconds


@dataclass(slots=True, eq=False)
class ObjectRequest:
    """One object to read or to write. Over without an outcome: it was dropped, and may not have left."""

    transfer: Transfer
    over: bool = False
    outcome: Outcome | None = None
    ended_at: Nanoseconds = NEVER_RECEIVED

    def end(self, outcome: Outcome, now: Nanoseconds) -> None:
        """Take the outcome."""
        self.over, self.outcome, self.ended_at = True, outcome, now
