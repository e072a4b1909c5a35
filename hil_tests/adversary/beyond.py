"""Excess of a robot over a bound of its file: the worst amount, and the reason; the adversary's bounds.

The worst was measured on the plant, over whole random runs with honest and lying devices.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from emulators.arduino_omni.mega.mega import BOOT, KEPT
from firmware_bridge.units import to_seconds
from validation.pages.pages import table


@dataclass(frozen=True, slots=True)
class Beyond:
    """One rule, on the robots that it is measured on."""

    robots: frozenset[str]
    rule: str
    bound: float
    unit: str
    """Unit of bound and worst, as text."""
    worst: float
    why: str


RIM: Final = Beyond(
    frozenset({"rome", "rome_arm"}),
    "a wheel's speed",
    0.043,
    "m/s above `rim_mps`",
    0.0429,
    "over MWProtocol the bridge regulates wheels at 10 Hz: one that speeds up while the base begins to turn "
    "overshoots",
)
SPEEDS_UP: Final = Beyond(
    frozenset({"rome", "rome_arm"}),
    "speeding up",
    1.4,
    "times `acceleration_mps2` of the base",
    1.37,
    "under the arm the loops on the board lag behind while the base turns back, and catch up as it passes 0; "
    "of the base alone 0.96 is measured where nothing fails",
)
LOADER: Final = Beyond(
    frozenset({"rome", "rome_arm"}),
    "a board in its boot loader, with its line cut, keeps running",
    to_seconds(KEPT + BOOT),
    "s",
    3.47,
    "no sketch runs, so none stops its motors: a byte in the loader's second keeps it there for 9 s more. It "
    "takes a board that hangs, a second reset just then, and a line that is cut",
)
ROWS: Final = (RIM, SPEEDS_UP, LOADER)
HEADINGS: Final = ("rule", "bound", "worst measured", "reason")
TEXT: Final = "No other excess over the limits above by more than the regulators' rounding was found."


def rows(robot: str) -> Iterator[tuple[str, ...]]:
    """Yield what is beyond a bound on a robot."""
    for row in ROWS:
        if robot in row.robots:
            yield (row.rule, f"{row.bound:g} {row.unit}", f"{row.worst:g}", row.why)


def sections(robot: str) -> tuple[str, ...]:
    """Return the part of the page on safety, in Markdown."""
    found = tuple(rows(robot))
    return ("### Known excesses", TEXT, table(HEADINGS, found)) if found else ()
