"""The holding brake of a drive as its power sequence uses it; a product's subclass has the pin."""

from firmware_bridge.units import NEVER, Nanoseconds


class Brake:
    """No brake: nothing is released, and nothing is waited for."""

    def __init__(self) -> None:
        self.due: Nanoseconds = NEVER
        """Next time to check."""

    @property
    def fitted(self) -> bool:
        """True if there is one."""
        return False

    def release(self) -> bool:
        """Release the brake; say whether it takes time, until `due`."""
        return False

    def released(self) -> bool:
        """Return whether the brake is open, or there is none; then there is nothing to wait for."""
        return True

    def interrupt(self) -> None:
        """Wait for the brake no longer, whatever it does."""

    def close(self) -> None:
        """Close the brake at once: power is gone."""

    def closes(self) -> bool:
        """Continue to close the brake, shaft at standstill first; return True if it holds or is absent."""
        return True
