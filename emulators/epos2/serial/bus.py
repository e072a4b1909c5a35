"""What the serial port needs of the drive that it belongs to."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Bus:
    """The drive's own side, and the CAN bus that it is on."""

    node: Callable[[], int]
    """The drive's own node number."""
    send: Callable[[int, bytes], None]
    """Put a frame on the bus."""
    hear: Callable[[int, bytes], None]
    """Let the drive hear a frame as if it came from the bus: a command to all is one to itself, too."""
    written: Callable[[], None]
    """Tell the drive that an object has a new value."""
