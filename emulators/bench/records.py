"""What a bench run leaves in memory beside its table of samples: every hold from its beginning to its end."""

from dataclasses import dataclass

from firmware_bridge.units import Nanoseconds


@dataclass(frozen=True, slots=True)
class FaultRecord:
    """One fault from the instant at which it was put on to the instant at which it was taken off."""

    kind: str
    title: str
    nodes: tuple[str, ...]
    """Whom it could meet."""
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """The same instant for a fault that has no length; None where it was still on when the run was over."""


@dataclass(frozen=True, slots=True)
class HoldRecord:
    """One interlock from the instant at which it held to the instant at which it let go."""

    name: str
    reason: str
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """None where it still held when the run was over."""
    remedy: str = ""
    """What whoever drives can do."""
