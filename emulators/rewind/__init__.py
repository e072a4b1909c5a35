"""Time that can be rewound: the state of everything that a world reaches, kept aside and put back."""

from emulators.rewind.capture import External, NotCaptured, RewindError
from emulators.rewind.engine import Checkpoint, Rewind

__all__ = ["Checkpoint", "External", "NotCaptured", "Rewind", "RewindError"]
