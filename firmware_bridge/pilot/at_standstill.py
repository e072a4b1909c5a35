"""The controls that count: after the robot was armed only those that were seen at neutral since.

Before that all count, so that the bridge sees the deflected ones, and refuses to arm. The meaning of a
control is not known here.
"""

from collections.abc import Mapping


class SeenAtStandstill:
    """A check of all controls at every message."""

    def __init__(self) -> None:
        self._armed = False
        self._arm_requested = False
        """Arming was requested here, and has not been seen yet."""
        self._at_standstill: set[str] = set()

    def arm_requested(self) -> None:
        """Note a request to arm; controls at neutral from now on count after it. An armed robot goes on."""
        if not self._armed:
            self._arm_requested = True
            self._at_standstill.clear()

    def look(self, resting: Mapping[str, bool], *, armed: bool) -> None:
        """Learn which controls rest, by their names."""
        # Armed by another station: what is deflected here must be neutral first.
        if armed and not self._armed and not self._arm_requested:
            self._at_standstill.clear()
        self._arm_requested = self._arm_requested and not armed
        self._armed = armed
        self._at_standstill |= {name for name, rests in resting.items() if rests}

    def counts(self, *names: str) -> bool:
        """Return whether what these controls say counts."""
        return not self._armed or self._at_standstill.issuperset(names)
