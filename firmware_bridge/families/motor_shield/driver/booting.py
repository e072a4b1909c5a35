"""Timing of commands to a board that may be starting again, and of its reset.

A byte in the first second after a reset keeps the boot loader of a Mega, stk500v2, until it has received none
for 9 s: a host that repeats its request is never answered. So nothing is sent until the firmware must run.
"""

from typing import Final

from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.node import DTR_DOWN, DTR_UP
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

FOUND_EVERY: Final[Nanoseconds] = 250 * MILLISECOND
"""Time for an answer of a board that may be booting, before the request is repeated."""
TRIES: Final = 3
"""Questions without an answer until it is reset, or a task is given up."""
QUIET: Final[Nanoseconds] = 60 * MILLISECOND
"""Time for a found board to answer the requests sent while it booted; then it is set up."""
QUIET_WITHIN: Final[Nanoseconds] = 300 * MILLISECOND
"""Longest delay of its set-up, whatever it sends: a board may print without end."""
MISSED: Final[Nanoseconds] = 2_900 * MILLISECOND
"""A board that has not answered by then is reported as missing, whatever time it is given to boot."""
NO_BUS: Final = "is the shield on it, powered, and its I2C free? else the sketch hangs in AFMS.begin()"
KEPT: Final = 64
"""Newest bytes that are searched for the firmware's banner."""


class Booting:
    """Of one board on the link of this name."""

    def __init__(self, name: str, table: ShieldLink, begins: bytes) -> None:
        """Take `begins`, the banner that its firmware sends when it has begun again."""
        self._name: Final = name
        self._causes: Final = (
            f"is the board powered? is it this port, at {table.rate} Bd, and flashed with "
            f"{table.protocol.value}? {NO_BUS}"
        )
        self._sought_at: Nanoseconds = 0
        self._boots: Final = table.boots * MILLISECOND
        self._within: Final = table.boots_within_ms * MILLISECOND
        self._shown = False
        """True where it has sent its banner."""
        self.speaks_at: Nanoseconds = 0
        """Time before which nothing is sent."""
        self.seeks_at: Nanoseconds = 0
        """Time when a board that is lost is reset, for any task."""
        self._begins: Final = begins
        self._pulsed_at: Nanoseconds | None = None
        self._received = b""
        """Since the last reset, as long as it is not set up."""
        self._answers_after: Nanoseconds | None = None
        """From the first reset of the bridge's until its motors were released."""
        self.found_until: Nanoseconds = 0
        """Time by which a board that is looked for must have answered."""
        self.quiet_until: Nanoseconds = 0
        """Time when set-up goes on, unless the board sends a byte before."""
        self._quiet_at_most: Nanoseconds = 0

    def begun(self, now: Nanoseconds) -> None:
        """Learn that it may have been reset now."""
        self.speaks_at = now + self._boots

    def pulse(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return what resets it."""
        self.begun(now)
        self._pulsed_at, self._received, self._shown = now, b"", False
        # DTR down and up: the USB chip pulls the reset through a capacitor when DTR is asserted.
        return Packet(self._name, DTR_DOWN, b""), Packet(self._name, DTR_UP, b"")

    def identified(self, now: Nanoseconds) -> None:
        """Note a request for its identity: it may be answering older requests still."""
        self.quiet_until, self._quiet_at_most = now + QUIET, now + QUIET_WITHIN

    def receives(self, now: Nanoseconds) -> None:
        """Note a received byte; endless output does not put off the set-up."""
        if now < self.quiet_until:
            # Each byte puts it off, up to a bound: a board may print without end.
            self.quiet_until = min(now + QUIET, self._quiet_at_most)

    def take_bytes(self, data: bytes) -> None:
        """Take the bytes that it sends while it is not set up."""
        # The banner may come in two pieces.
        self._received = self._received[-KEPT:] + data
        self._shown = self._shown or (bool(self._begins) and self._begins in self._received)

    def released(self, now: Nanoseconds) -> str:
        """Learn that it has been set up, which begins by releasing its motors.

        Return the result of its reset, as text; empty where that was not tried.
        """
        if self._answers_after is None and self._pulsed_at is not None:
            self._answers_after = now - self._pulsed_at
        if self._answers_after is None:
            return ""
        seconds = f"{to_seconds(self._answers_after):.1f} s"
        if self._shown:
            return (
                f"{self._name}: the line's reset works: the board has begun again, and released its motors, "
                f"within {seconds}; where it hangs they run on for so long once that is noticed"
            )
        return (
            f"{self._name}: nothing shows that the line's reset works: the board answered {seconds} later, "
            "and did not say that it has started; where it hangs its motors may run on: keep a switch near"
        )

    def looked_for(self, now: Nanoseconds) -> None:
        """Learn that it is looked for from now on."""
        self._sought_at, self.found_until = now, now + self._within

    def hint(self, now: Nanoseconds) -> str:
        """Return what to check, the likeliest cause first, where it is looked for in vain; else nothing."""
        if now - self._sought_at < MISSED:
            return ""
        boots = f" (it answers {to_seconds(self._boots):g} s after a reset)" if self._boots > MISSED else ""
        return f"{self._name}: no answer within {to_seconds(MISSED):g} s{boots}: {self._causes}"

    def unanswered(self, what: str, *, found: bool) -> str:
        """Return why a task failed for a question that has no answer; `found`: it has answered before."""
        return f"no answer to '{what}': {NO_BUS if found else self._causes}"

    def lost(self, now: Nanoseconds) -> None:
        """Learn that it is silent, or has not been found; it is given time before the next reset."""
        self.seeks_at = now + self._within
