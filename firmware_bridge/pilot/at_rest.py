"""Which controls count: after the robot was armed only those that were seen at rest since.

Before that all count, so that the bridge sees what is deflected, and refuses to arm. It refuses to know what
the controls are.
"""

from collections.abc import Mapping


class SeenAtRest:
    """Looks at all controls whenever something is said."""

    def __init__(self) -> None:
        self._armed = False
        self._arm_requested = False
        """Arming was asked for here, and has not been seen yet."""
        self._rested: set[str] = set()

    def arm_requested(self) -> None:
        """Learn that arming is asked for; what rests from now on rests after it. An armed robot goes on."""
        if not self._armed:
            self._arm_requested = True
            self._rested.clear()

    def look(self, resting: Mapping[str, bool], *, armed: bool) -> None:
        """Learn which controls rest, by their names."""
        if armed and not self._armed and not self._arm_requested:
            self._rested.clear()
        self._arm_requested = self._arm_requested and not armed
        self._armed = armed
        self._rested |= {name for name, rests in resting.items() if rests}

    def counts(self, *names: str) -> bool:
        """Return whether what these controls say counts."""
        return not self._armed or self._rested.issuperset(names)
