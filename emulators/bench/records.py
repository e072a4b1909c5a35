"""Events of a bench run beside its table of samples: each interlock event and fault, with begin and end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from firmware_bridge import renamed
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import Nanoseconds, to_seconds


@dataclass(frozen=True, slots=True)
class FaultRecord:
    """One fault from the instant at which it was put on to the instant at which it was taken off."""

    kind: str
    title: str
    nodes: tuple[str, ...]
    """Stations that it could concern."""
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """The same instant for a fault that has no length; None where it was still on when the run was over."""


@dataclass(frozen=True, slots=True)
class InterlockEvent:
    """One interlock event, from the instant at which it became active to the one at which it cleared."""

    name: str
    reason: str
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """End of the event; None where it was still active when the run was over."""
    remedy: str = ""
    """Remedy for the operator."""

    @property
    def began_s(self) -> float:
        """The same in seconds."""
        return to_seconds(self.began)

    @property
    def ended_s(self) -> float | None:
        """The same in seconds."""
        return None if self.ended is None else to_seconds(self.ended)


class InterlockLog:
    """The holds of a run from beginning to end; one shorter than a look may pass unseen."""

    def __init__(self, standing: Sequence[ActiveInterlock] = ()) -> None:
        self.records: Final[list[InterlockEvent]] = []
        self._noted = standing
        """The holds as they were noted last."""

    def note(self, events: Sequence[ActiveInterlock], now: Nanoseconds) -> None:
        """Note which hold now."""
        if events is self._noted:
            return
        self._noted = events
        standing = {event.name: event for event in events}
        for index, record in enumerate(self.records):
            if record.ended is None:
                event = standing.pop(record.name, None)
                # Cleared and tripped again between two looks: two events, not one.
                if event is None or event.since != record.began:
                    self.records[index] = replace(record, ended=now)
                    if event is not None:
                        standing[event.name] = event
        for event in standing.values():
            self.records.append(InterlockEvent(event.name, event.reason, event.since, remedy=event.remedy))


__getattr__ = renamed.module(__name__, __name__, HoldRecord="InterlockEvent", Holds="InterlockLog")
