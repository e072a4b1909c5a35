"""State of a robot whose bridge ends before the robot's stop has, and the user's right to end it so."""

from collections.abc import Callable
from typing import Final

from firmware_bridge.drivers.all_drivers import alone
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, to_seconds

AGAIN_WITHIN: Final[Nanoseconds] = 5 * SECOND
"""Time for a second command to end, after which the robot is left in its reported state."""


class Leaving:
    """One robot, link by link: what stops its devices without the bridge."""

    def __init__(self, machine: AnyRobot, say: Callable[[str, Nanoseconds], None]) -> None:
        self._say = say
        names = [name for name in machine.links if machine.axes_on(name)]
        self._stops: Final = {name: alone(machine, name) for name in names}
        self._reported_at: Nanoseconds = NEVER

    @property
    def unattended(self) -> str:
        """The state of each link's devices after the bridge's end, in one line."""
        return "; ".join(
            f"link '{name}': {states}"
            if states
            else f"link '{name}': nothing stops it: its motors may turn on, switch their supply off"
            for name, states in self._stops.items()
        )

    def may_leave(self, now: Nanoseconds) -> bool:
        """Take one more command to end while the robot is stopped; return whether it is left as it is.

        Only where some device would go on without the bridge, and the user was warned; else the stop goes on.
        """
        if all(self._stops.values()):
            self._say("the stop goes on, and ends the program: each of its steps lasts a bounded time", now)
            return False
        if self._reported_at != NEVER and now - self._reported_at <= AGAIN_WITHIN:
            return True
        self._reported_at, within = now, f"{to_seconds(AGAIN_WITHIN):g} s"
        self._say(f"the stop goes on. {self.unattended}. Once more within {within} leaves it so", now)
        return False
