"""What a bench run leaves in memory beside its table of samples: every hold from its beginning to its end."""

from dataclasses import dataclass

from firmware_bridge.units import Nanoseconds


@dataclass(frozen=True, slots=True)
class HoldRecord:
    """One interlock from the instant at which it held to the instant at which it let go."""

    name: str
    reason: str
    began: Nanoseconds
    ended: Nanoseconds | None = None
    """None where it still held when the run was over."""
