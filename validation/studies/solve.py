"""Plain numerical ways, for what is solved independently: a root by bisection, Runge and Kutta's steps."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Rates: TypeAlias = Callable[[float, Floats], Floats]


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where the function is 0 between these; ValueError where it has one sign at both."""
    at_low, at_high = function(low), function(high)
    if at_low * at_high > 0.0:
        raise ValueError(f"no change of sign between {low:g} and {high:g}: {at_low:g} and {at_high:g}")
    for _ in range(200):
        middle = (low + high) / 2.0
        if (function(middle) > 0.0) == (at_low > 0.0):
            low = middle
        else:
            high = middle
    return (low + high) / 2.0


def integrate(rates: Rates, start: Floats, times: Floats, substeps: int = 1) -> Floats:
    """Return the state at each time, a row each, by Runge-Kutta of fourth order between them."""
    found = np.empty((times.size, start.size))
    found[0] = state = np.array(start, dtype=float)
    for place in range(1, times.size):
        step = (times[place] - times[place - 1]) / substeps
        for part in range(substeps):
            at = times[place - 1] + part * step
            first = rates(at, state)
            second = rates(at + step / 2.0, state + step / 2.0 * first)
            third = rates(at + step / 2.0, state + step / 2.0 * second)
            fourth = rates(at + step, state + step * third)
            state = state + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        found[place] = state
    return found
