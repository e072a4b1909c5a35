"""Scaling from the drive's raw objects to the fixed-point numbers of the regulators, and back."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from emulators.servo.axis import FASTEST_RPM, FOREVER, LARGEST_SPEED, OFF, ServoAxis
from emulators.servo.record import ServoRecord

MILLISECONDS_PER_MINUTE: Final = 60_000
SWITCHED_OFF: Final = 0xFFFF_FFFF

# Binary places of the multipliers; chosen so that each product below stays within 63 bits (see `loops`).
VELOCITY_PLACES: Final = 38
POSITION_P_PLACES: Final = 32
POSITION_I_PLACES: Final = 40
POSITION_D_PLACES: Final = 36
SPEED_FORWARD_PLACES: Final = 38
ACCELERATION_FORWARD_PLACES: Final = 32
FILTER_PLACES: Final = 16

_TWO_PI_PLACES: Final = 40
_TWO_PI: Final = 6_908_435_304_715
"""2 pi in 40 binary places."""


@dataclass(slots=True)
class Settings:
    """The raw objects that shape an axis; defaults of the 70/10 EDS. Units: qc, rpm, mA, ms."""

    encoder_pulses: int = 500
    current_p: int = 300
    current_i: int = 100
    velocity_p: int = 1000
    velocity_i: int = 100
    velocity_speed_forward: int = 0
    velocity_acceleration_forward: int = 0
    position_p: int = 150
    position_i: int = 10
    position_d: int = 200
    position_speed_forward: int = 0
    position_acceleration_forward: int = 0
    continuous_current: int = 10_000
    peak_current: int = 25_000
    thermal_time: int = 40
    max_speed: int = 25_000
    following_error: int = 2000
    position_window: int = SWITCHED_OFF
    position_window_time: int = 0
    velocity_window: int = SWITCHED_OFF
    velocity_window_time: int = 0
    standstill_window: int = 30
    standstill_time: int = 50


def nearest(numerator: int, denominator: int) -> int:
    """Return the integer nearest to a fraction with a positive denominator, halves up."""
    return (2 * numerator + denominator) // (2 * denominator)


def fraction_of(resolution: int) -> int:
    """Return the binary places of demands at `resolution` qc per turn: 25 000 rpm fills 29 bits."""
    return LARGEST_SPEED.bit_length() - 1 - (FASTEST_RPM * resolution // MILLISECONDS_PER_MINUTE).bit_length()


def speed_units(axis: ServoAxis, rpm: int) -> int:
    """Return a speed in velocity units; what is faster than 25 000 rpm counts as 25 000 rpm."""
    return _speed(rpm, axis.resolution << axis.fraction)


@lru_cache(maxsize=1024)
def _speed(rpm: int, turn: int) -> int:
    bounded = max(-FASTEST_RPM, min(FASTEST_RPM, rpm))
    return nearest(bounded * turn, MILLISECONDS_PER_MINUTE)


def speed_rpm(axis: ServoRecord, units: int) -> int:
    """Return velocity units in rpm, nearest."""
    return nearest(units * MILLISECONDS_PER_MINUTE, axis.resolution << axis.fraction)


def raw_speed_rpm(axis: ServoRecord) -> int:
    """Return the last ms's quadcounts in rpm, to nearest: 0x606C as recorded of two drives, 59, 117, 410 ...

    Assumed: halves, and negative speeds, which no recording has, away from zero.
    """
    rpm = nearest(abs(axis.step) * MILLISECONDS_PER_MINUTE, axis.resolution)
    return rpm if axis.step >= 0 else -rpm


def acceleration_units(axis: ServoAxis, rpm_per_second: int) -> int:
    """Return an acceleration in units; at least 1, at most from rest to the fastest speed in one ms."""
    return _acceleration(rpm_per_second, axis.resolution << axis.fraction)


@lru_cache(maxsize=1024)
def _acceleration(rpm_per_second: int, turn: int) -> int:
    units = nearest(rpm_per_second * turn, MILLISECONDS_PER_MINUTE * 1000)
    return max(1, min(units, LARGEST_SPEED))


def configure(axis: ServoAxis, raw: Settings) -> None:
    """Derive every multiplier and limit of an axis from its raw objects. Demands restart if units change."""
    resolution = 4 * raw.encoder_pulses
    fraction = fraction_of(resolution)
    if (resolution, fraction) != (axis.resolution, axis.fraction):
        axis.resolution = resolution
        axis.fraction = fraction
        # An average in the former unit means nothing in the new one.
        axis.velocity_average = axis.step << fraction
        axis.index_before, axis.index_known = axis.encoder + axis.slipped, 0
        axis.clear_demand()
    _gains(axis, raw, resolution << fraction)
    _limits(axis, raw)


def _gains(axis: ServoAxis, raw: Settings, turn: int) -> None:
    """Convert the gains; `turn` is one turn of the shaft in position units."""
    axis.current_p = raw.current_p
    axis.current_i = raw.current_i
    # A/(16000 pi) per rad/s is 125/N mA per qc/ms.
    axis.velocity_p = nearest(raw.velocity_p * 125 << VELOCITY_PLACES, turn)
    # A/s/(64 pi) per rad/s is 31.25/N mA per qc/ms and ms.
    axis.velocity_i = nearest(raw.velocity_i * 125 << (VELOCITY_PLACES - 2), turn)
    # A/(32 pi) per rad is 62.5/N mA per qc.
    axis.position_p = nearest(raw.position_p * 125 << (POSITION_P_PLACES - 1), turn)
    # A/s/(4.096 pi) per rad is 0.48828125/N mA per qc and ms.
    axis.position_i = nearest(raw.position_i * 125 << (POSITION_I_PLACES - 8), turn)
    # A s/(4000 pi) per rad is 500/N mA per qc/ms.
    axis.position_d = nearest(raw.position_d * 500 << POSITION_D_PLACES, turn)
    axis.position_filter = _filter(raw)
    axis.velocity_speed_forward = _speed_forward(raw.velocity_speed_forward, turn)
    axis.velocity_acceleration_forward = _acceleration_forward(raw.velocity_acceleration_forward, turn)
    axis.position_speed_forward = _speed_forward(raw.position_speed_forward, turn)
    axis.position_acceleration_forward = _acceleration_forward(raw.position_acceleration_forward, turn)


def _filter(raw: Settings) -> int:
    """Return the weight of the new sample in the derivative's low-pass, in 16 binary places.

    Thesis (4.5): K_D s / (1 + K_D s / (10 K_P)). In raw objects K_D/K_P is 8 ms times their ratio, so
    the time constant is 0.8 ms times that ratio; sampled at 1 ms as Euler backwards (assumed).
    """
    if raw.position_p <= 0 or raw.position_d <= 0:
        return 1 << FILTER_PLACES
    return nearest(10 * raw.position_p << FILTER_PLACES, 10 * raw.position_p + 8 * raw.position_d)


def _speed_forward(raw: int, turn: int) -> int:
    """1 uA/(rad/s) is 2 pi/N mA per qc/ms."""
    return nearest(raw * _TWO_PI, turn << (_TWO_PI_PLACES - SPEED_FORWARD_PLACES))


def _acceleration_forward(raw: int, turn: int) -> int:
    """1 uA/(rad/s2) is 2000 pi/N mA per qc/ms2."""
    return nearest(raw * _TWO_PI * 1000, turn << (_TWO_PI_PLACES - ACCELERATION_FORWARD_PLACES))


def _limits(axis: ServoAxis, raw: Settings) -> None:
    axis.continuous_ma = min(raw.continuous_current, raw.peak_current)
    axis.peak_ma = raw.peak_current
    # At the output current limit the thermal budget lasts for 1/20 of the time constant, which is 5 ms for
    # each unit of 100 ms (EPOS Firmware Specification, by analogy). Samples are 1 ms apart.
    above = axis.peak_ma**2 - axis.continuous_ma**2
    axis.thermal_full = above * raw.thermal_time * 5 if above > 0 else FOREVER
    axis.speed_limit = speed_units(axis, raw.max_speed)
    axis.following_limit_qc = _supervised(raw.following_error)
    axis.position_window_qc = _supervised(raw.position_window)
    axis.position_window_ms = raw.position_window_time
    window = _supervised(raw.velocity_window)
    axis.velocity_window = window if window == OFF else speed_units(axis, window)
    axis.velocity_window_ms = raw.velocity_window_time
    axis.rest_window = speed_units(axis, raw.standstill_window)
    axis.rest_ms = raw.standstill_time


def _supervised(limit: int) -> int:
    return OFF if limit == SWITCHED_OFF else limit
