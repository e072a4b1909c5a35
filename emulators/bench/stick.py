"""The operator's hand: where the stick stands at an instant, with its ramps and its tremor."""

import math
from typing import Final

import numpy as np

from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

TREMOR_TIME_S: Final = 0.2
"""Correlation time of the hand's tremor. Assumed."""


class Ramp:
    """A value that goes to its target at once or at a slope; computed from its last change, not summed."""

    def __init__(self) -> None:
        self.target = 0.0
        self._start = 0.0
        self._slope = math.inf
        self._since: Nanoseconds = 0

    def go(self, target: float, slope: float | None, now: Nanoseconds) -> None:
        """Set out for a target with a slope per second; None goes there at once."""
        self._start = self.at(now)
        self._since = now
        self.target = target
        self._slope = math.inf if slope is None else slope

    def at(self, now: Nanoseconds) -> float:
        """Return the value at an instant."""
        if math.isinf(self._slope):
            return self.target
        # From the last change on, not step by step: the value does not depend on how often it is read.
        gone = self._slope * to_seconds(now - self._since)
        left = self.target - self._start
        return self.target if gone >= abs(left) else self._start + math.copysign(gone, left)


class Tremor:
    """Noise of a hand that returns to its place: an Ornstein-Uhlenbeck process, sampled once a message."""

    def __init__(self, deviation: float, period: Nanoseconds, generator: np.random.Generator) -> None:
        # Exact for any message rate: the correlation over one period.
        self._keeps = math.exp(-period / SECOND / TREMOR_TIME_S)
        # What keeps the variance at the given deviation.
        self._kicks = deviation * math.sqrt(1.0 - self._keeps * self._keeps)
        self._generator = generator
        self._value = 0.0

    def step(self) -> float:
        """Return the next value, as a share of full stick; without noise no random number is drawn."""
        if self._kicks:
            self._value = self._keeps * self._value + self._kicks * float(self._generator.standard_normal())
        return self._value
