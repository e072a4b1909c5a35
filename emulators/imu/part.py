"""A cheap MEMS part of six axes: noise, bias, range, quantisation. Figures of the class of the MPU-6050.

Source of the class: InvenSense PS-MPU-6000A-00 (product specification), recalled; every figure is assumed, to
be verified:
* noise of the gyro 0.05 deg/s rms behind its filter, of the accelerometer 0.4 mg/sqrt(Hz), 3.3 mg at 44 Hz.
* bias after a calibration: gyro 0.3 deg/s, accelerometer 3 mg, each the standard deviation of parts; the
  specification's 20 deg/s and 50 mg are before one. The bias stays for a run: no drift by temperature.
* range 4 g and 500 deg/s; beyond them the value stays at the end, and the frame's status reports it.
* no error of scale, no crosstalk between axes.
"""

import math
from dataclasses import dataclass
from typing import Final

from numpy.random import Generator

from emulators.imu.truth import GRAVITY, Felt, Matrix, Vector, inverse, turned
from firmware_bridge.families.imu.wire import Counts, Status

COUNTS_PER_MPS2: Final = 8192.0 / GRAVITY
COUNTS_PER_RAD_S: Final = 65.5 * 180.0 / math.pi
HIGHEST: Final = 32_767
LOWEST: Final = -32_768
DRAWN: Final = 256
"""Frames whose noise is drawn at once."""
_AXES: Final = 6


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of a part; standard deviations."""

    force_noise: float = 0.0033 * GRAVITY
    """m/s2."""
    rate_noise: float = math.radians(0.05)
    """rad/s."""
    force_bias: float = 0.003 * GRAVITY
    rate_bias: float = math.radians(0.3)


class MemsPart:
    """One part; its biases are drawn once, its noise for every frame."""

    def __init__(self, generator: Generator, mounted: Matrix, errors: Errors | None = None) -> None:
        """Take its rotation on the body, from its own axes into the body's."""
        self.errors: Final = Errors() if errors is None else errors
        self._generator: Final = generator
        self._into: Final = inverse(mounted)
        one = self.errors
        self._noise: Final = (*[one.force_noise] * 3, *[one.rate_noise] * 3)
        spread = (*[one.force_bias] * 3, *[one.rate_bias] * 3)
        drawn = generator.standard_normal(_AXES).tolist()
        self.biases: Final = tuple(float(share) * most for share, most in zip(drawn, spread, strict=True))
        """Of specific force and rates, in the part's own axes."""
        self._drawn: list[float] = []

    def counts(self, truth: Felt) -> tuple[Counts, Counts, Status]:
        """Return specific force and rate in counts of the part's own axes, and what was clipped."""
        if not self._drawn:
            self._drawn = self._generator.standard_normal(DRAWN * _AXES).tolist()
        noise, self._drawn = self._drawn[:_AXES], self._drawn[_AXES:]
        force, rate = turned(self._into, truth.force), turned(self._into, truth.rate)
        errors = [
            bias + share * most for bias, share, most in zip(self.biases, noise, self._noise, strict=True)
        ]
        forces, force_clipped = _quantised(force, errors[:3], COUNTS_PER_MPS2)
        rates, rate_clipped = _quantised(rate, errors[3:], COUNTS_PER_RAD_S)
        status = Status(0)
        if force_clipped:
            status |= Status.FORCE_CLIPPED
        if rate_clipped:
            status |= Status.RATE_CLIPPED
        return forces, rates, status


def _quantised(truth: Vector, errors: list[float], per_unit: float) -> tuple[Counts, bool]:
    """Return counts within 16 bits, and whether one was beyond."""
    wanted = [round((value + error) * per_unit) for value, error in zip(truth, errors, strict=True)]
    x, y, z = (min(max(value, LOWEST), HIGHEST) for value in wanted)
    return (x, y, z), [x, y, z] != wanted
