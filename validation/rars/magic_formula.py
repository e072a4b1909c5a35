"""The magic formula (3.45), which [R] mentions without coefficients, beside its own law (3.83).

Y = D sin(C atan(B x - E (B x - atan(B x)))). Coefficients are assumed: through the peak and the end of
(3.83), or nearest to it over all. The independent way is that law, and least squares of its own.
"""

from typing import Final, NamedTuple

import numpy as np

from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot

PEAK: Final = 0.15
"""Slip of the largest friction, (3.83)."""
FALLS: Final = 0.66
"""Friction at a slip of 1 over the largest one, (3.83)."""
SLIPS: Final = np.linspace(0.0, 1.0, 1001)


class Magic(NamedTuple):
    """B, C and E; D is the friction coefficient."""

    b: float
    c: float
    e: float


THROUGH: Final = Magic(10.6454, 1.7474, 0.5796)
"""Assumed: through (3.83)'s peak and end, and flat at the peak."""
NEAREST: Final = Magic(4.4651, 1.5636, -2.8866)
"""Assumed: of least squares over slips from 0 to 1."""


def friction(by: Magic, slip: Floats | float) -> Floats:
    """Return the friction over the largest coefficient, 1."""
    along = by.b * np.asarray(slip)
    found: Floats = np.sin(by.c * np.arctan(along - by.e * (along - np.arctan(along))))
    return found


EVEN: Final = "over evenly spaced slips; which ones the coefficients were found by is not stated"


def law(slip: Floats) -> Floats:
    """Return the same by (3.83), corrected: straight up to the peak, and straight down to the end."""
    return np.where(slip <= PEAK, slip / PEAK, 1.0 - (1.0 - FALLS) * (slip - PEAK) / (1.0 - PEAK))


def fitted(start: Magic = NEAREST) -> Magic:
    """Return the coefficients nearest to (3.83), by Gauss and Newton's steps from somewhere near."""
    found, wanted = np.array(start), law(SLIPS)
    for _ in range(50):
        base = friction(Magic(*found), SLIPS)
        slopes = np.column_stack(
            [(friction(Magic(*(found + one)), SLIPS) - base) for one in 1e-6 * np.eye(3)]
        )
        found = found + np.linalg.lstsq(slopes / 1e-6, wanted - base, rcond=None)[0]
    return Magic(*map(float, found))


def apart(by: Magic) -> float:
    """Return its root mean square distance from (3.83), 1."""
    return float(np.sqrt(np.mean((friction(by, SLIPS) - law(SLIPS)) ** 2)))


def peak(by: Magic) -> float:
    """Return the slip of the largest friction."""
    return float(SLIPS[friction(by, SLIPS).argmax()])


def magic_formula(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    nearest = fitted()
    end = float(friction(THROUGH, 1.0))
    return Findings(
        compared=(
            Compared("slip of the largest friction, through the peak", "1", None, PEAK, peak(THROUGH), 1e-3),
            Compared("friction at a slip of 1 over the largest", "1", None, FALLS, end, 1e-4),
            *(
                Compared(quantity, "1", None, of(nearest), of(NEAREST), within, EVEN)
                for quantity, of, within in (
                    ("root mean square from (3.83), nearest", apart, 2e-3),
                    ("slip of the largest friction, nearest", peak, 0.02),
                )
            ),
        ),
        plots=(
            Plot(
                "Friction over slip: (3.83), and the magic formula (3.45)",
                "slip [1]",
                "friction over the coefficient [1]",
                (
                    Curve("(3.83), corrected", SLIPS, law(SLIPS)),
                    Curve("magic formula through peak and end", SLIPS, friction(THROUGH, SLIPS)),
                    Curve("magic formula nearest to it", SLIPS, friction(NEAREST, SLIPS), "dashed"),
                ),
                "Coefficients are assumed, none is printed. Through peak and end it rises with 18.6 at "
                "first, (3.83) with 6.67: a wheel on it slips a third as much at small forces.",
            ),
        ),
        remarks=(
            (
                "The plant's tyres keep to (3.83), those of `rars_magic` to this. A wheel's steady slip on a "
                "slope may be read off either curve."
            ),
        ),
    )
