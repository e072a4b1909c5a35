"""Time that can be rewound: the state of everything that a world reaches, kept aside and put back."""

from emulators.rewind.engine import Moment, Rewind
from emulators.rewind.kinds import Apart, Outside, RewindError

__all__ = ["Apart", "Moment", "Outside", "Rewind", "RewindError"]
