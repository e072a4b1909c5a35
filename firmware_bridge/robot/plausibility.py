"""Plausibility limits of an axis: `[axes.plausibility]` in a robot file. An omitted key is computed."""

from typing import Annotated, Final

from pydantic import Field

from firmware_bridge.robot.table import Positive, Table

STANDSTILL: Final = 1.0 / 80.0
"""Share of its top speed below which an axis stands."""
RUBS: Final = 1.0 / 20.0
"""Share of its motor's continuous current that friction may take."""


class Plausibility(Table):
    """Bounds on an axis' deviation from its set-point, in its unit behind the gear."""

    standstill_below: Positive | None = None
    """In a second: slower than this it is at standstill. Without it an 80th of its top speed."""
    speed: Positive | None = None
    """In a second: a speed so far outside its range is no deviation yet. Twice as much."""
    position: Positive | None = None
    """The same of positions. The way at top speed in 25 ms."""
    ramp: Positive | None = None
    """In a second squared: it changes its speed at least so fast. Half the gentlest of its drive's."""
    cruise: Positive | None = None
    """In a second: it approaches a position at least so fast. Half of its drive's set-point."""
    friction: Positive | None = None
    """In A: what friction alone may hold. One that stands with more would move without power. A 20th of what
    its drive may give for ever: a motor without load takes 2 to 3 % of it, gear and wheels a little."""
    holds_with: Positive | None = None
    """In A: more it does not take to stand where it is. What its drive may give for ever."""
    lag_ms: Annotated[int, Field(ge=10, le=10_000)] | None = None
    """Time constant of all that lags beside ramp and cruise. 100 ms, and two cycles of its link."""
    within_ms: Annotated[int, Field(ge=10, le=10_000)] | None = None
    """It deviates when it does so at every sample for so long. The silence that its link allows."""
