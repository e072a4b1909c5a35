"""The limit that an agreed delay brings: where commands may be older than usual, the robot is slower.

The law: top speed times the permitted age of a command is constant. This is how far the robot drives on a
command between its sending and its expiry, whatever stands there by now: the operator knows that distance,
and no agreement makes it longer. The stopping distance beyond it grows with the speed, so that of a slower
robot is only shorter.
"""

from collections.abc import Callable
from typing import Final, TypeAlias, TypeVar

from firmware_bridge.robot.table import Table
from firmware_bridge.safety.interlock import Limit, View
from firmware_bridge.units import MILLISECOND, Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

Slow: TypeAlias = Callable[[View[G, M, S], float], tuple[M, str | None]]
"""Return `view.allowed` with its speeds within a share of their top, and the reason where they were not."""

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
"""It is reported for at least so long, so that a stick at its edge does not flicker."""


def delay_limit(slowed: Slow[G, M, S]) -> Limit[G, M, S]:
    """Return the limit for a robot type that can be slowed."""

    def clip(view: View[G, M, S]) -> tuple[M, str | None]:
        limit = view.facts.age_limit
        if limit.most <= limit.usual:
            return view.allowed, None
        allowed, reason = slowed(view, limit.usual / limit.most)
        if reason is None:
            return allowed, None
        agreed = f"{limit.most // MILLISECOND} ms instead of {limit.usual // MILLISECOND} ms"
        return allowed, f"{reason} while commands may be {agreed} old"

    return Limit(
        "delay limit",
        clip,
        "reduce the speed, or agree on a shorter delay",
        clear_after=CLEARS_AFTER,
    )
