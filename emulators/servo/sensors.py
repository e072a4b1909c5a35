"""The sensors of an axis, their wires, and what the drive notices when they fail, every millisecond.

Whole numbers only, as in `emulators.servo.loops`. Not known here: which emergency a finding is.

`sensor_faults` and `encoder_loss` say what is wrong with the wires: a bench test sets them, and the drive
sees no more of them than the counts, pulses and levels that come out of this module.
"""

from typing import Final

from emulators.servo.axis import (
    AUXILIARY_AGAINST_MAIN,
    ENCODER_AGAINST_MOTOR,
    ENCODER_BROKEN,
    HALL_ANGLE_APART,
    HALL_IMPOSSIBLE,
    INDEX_DISTANCE_WRONG,
    INDEX_LOST,
    POSITION,
    SWAPPED,
    VELOCITY,
    ServoAxis,
)

# What can be wrong with a wire.
BROKEN: Final = 1 << 0
"""The encoder's cable: no count, no pulse, and no level on its lines."""
INDEX_MISSING: Final = 1 << 2
INDEX_SPURIOUS: Final = 1 << 3
"""A second pulse, an eighth of a turn after the first."""
AUXILIARY_SWAPPED: Final = 1 << 4
"""The channels of the auxiliary encoder, which is taken to turn with the shaft."""
HALL_HIGH: Final = 5
"""First bit of the three hall sensors that always show 1, as without their cable."""
HALL_LOW: Final = 8
"""First bit of the three hall sensors that always show 0."""

PER_MILLE: Final = 1000
SPURIOUS_PART: Final = 8
SECTORS: Final = 6
HALL_LINES: Final = 7
HALL_SEQUENCE: Final = 0o546231
"""The pattern of each sixth of an electrical turn, one octal digit each, the first one leftmost."""
INDEX_TOLERANCE: Final = 7
"""Places: two indexes may lie 2^-7 of a turn from where they should (assumed)."""
INDEX_SOONEST: Final = 2
"""Places: a pulse within 2^-2 of a turn after another is a spurious one (assumed)."""
INDEX_TURNS: Final = 2
"""Turns without an index (EPOS Firmware Specification, by analogy)."""
CONTRARY_MS: Final = 20
"""Time for which full voltage drives one way while the count goes the other way (assumed)."""


def counted(axis: ServoAxis, turned: int) -> int:
    """Return what the drive counts of a step (qc of the mounted encoder), given its wires and polarity."""
    step, faults = turned, axis.sensor_faults
    if faults & BROKEN:
        step = 0
    elif axis.encoder_loss:
        # The part of a count is carried: any rate of loss comes out exactly in the long run.
        rest = axis.loss_rest + (step if step >= 0 else -step) * axis.encoder_loss
        lost = rest // PER_MILLE
        axis.loss_rest = rest - lost * PER_MILLE
        step = max(0, step - lost) if step >= 0 else min(0, step + lost)
    # An inverted polarity (0x2210:4) undoes exchanged channels.
    if bool(faults & SWAPPED) != bool(axis.encoder_reversed):
        step = -step
    axis.turned = turned
    axis.slipped += step - turned
    return step


def passed(axis: ServoAxis, behind: int) -> tuple[bool, int]:
    """Return True if a pulse `behind` the index was passed in this ms; and the shaft's count there."""
    turn, shaft = axis.encoder_resolution, axis.encoder - behind
    after, before = shaft // turn, (shaft - axis.turned) // turn
    return after != before, (after if after > before else after + 1) * turn + behind


def hall_pattern(axis: ServoAxis) -> int:
    """Return the three hall sensors' levels; 0 for a motor that has none."""
    pairs = axis.mounted_pole_pairs or axis.hall_pole_pairs
    if not axis.hall_pole_pairs:
        return 0
    turn = axis.encoder_resolution
    # The sixth of an electrical turn: the mechanical angle times the pole pairs.
    sector = axis.encoder % turn * SECTORS * pairs // turn % SECTORS
    pattern = HALL_SEQUENCE >> 3 * (SECTORS - 1 - sector) & HALL_LINES
    faults = axis.sensor_faults
    return (pattern | faults >> HALL_HIGH & HALL_LINES) & ~(faults >> HALL_LOW) & HALL_LINES


def electrical_angle(axis: ServoAxis, pattern: int) -> int:
    """Return how far the counted angle is ahead of the pattern's middle: 12 x `resolution` to a turn."""
    sector = 0
    while sector < SECTORS and HALL_SEQUENCE >> 3 * (SECTORS - 1 - sector) & HALL_LINES != pattern:
        sector += 1
    # With the configured resolution: a wrong 0x2210:1 makes the angle drift against the hall sensors.
    counts = (axis.encoder + axis.slipped) % axis.resolution
    return counts * 2 * SECTORS * axis.hall_pole_pairs - (2 * sector + 1) * axis.resolution


def align(axis: ServoAxis) -> None:
    """Take the present hall pattern for the present angle: where a sinus commutation starts from."""
    axis.hall_zero = electrical_angle(axis, hall_pattern(axis)) if axis.hall_pole_pairs else 0
    axis.contrary_ms = 0


def supervise(axis: ServoAxis) -> int:
    """Return the flags of what is wrong with the sensors."""
    flags = 0
    if axis.encoder_supervised:
        if axis.sensor_faults & BROKEN:
            flags = ENCODER_BROKEN
        if axis.index_supervised:
            flags |= _index(axis)
    if axis.powered:
        if axis.hall_pole_pairs:
            flags |= _hall(axis)
        if axis.regulator in (VELOCITY, POSITION):
            flags |= _direction(axis)
        away = axis.encoder - axis.switched_on_at
        if axis.auxiliary_supervised and axis.sensor_faults & AUXILIARY_SWAPPED:
            turn = axis.encoder_resolution
            flags |= AUXILIARY_AGAINST_MAIN if away > turn or -away > turn else 0
    return flags


def _index(axis: ServoAxis) -> int:
    """Judge the count between two indexes, and how long none has come."""
    counts, turn = axis.encoder + axis.slipped, axis.resolution
    if axis.index_passes == axis.index_judged:
        away = counts - axis.index_before
        if -INDEX_TURNS * turn <= away <= INDEX_TURNS * turn:
            return 0
        axis.index_before, axis.index_known = counts, 0
        return INDEX_LOST
    axis.index_judged = axis.index_passes
    before, known = axis.index_before, axis.index_known
    axis.index_before, axis.index_known = axis.index_count, 1
    way = axis.index_count - before if axis.index_count >= before else before - axis.index_count
    tolerance = turn >> INDEX_TOLERANCE
    # A reversal passes the same index twice: a distance near 0 is sound.
    if not known or way <= tolerance or -tolerance <= way - turn <= tolerance:
        return 0
    return INDEX_LOST if way <= turn >> INDEX_SOONEST else INDEX_DISTANCE_WRONG


def _hall(axis: ServoAxis) -> int:
    """Judge the hall pattern, and for a sinus commutation its angle: a quarter of a turn is too far."""
    pattern = hall_pattern(axis)
    # Three sensors 120 degrees apart never show the same level.
    if pattern in (0, HALL_LINES):
        return HALL_IMPOSSIBLE
    if not axis.hall_angle_supervised:
        return 0
    whole = 2 * SECTORS * axis.resolution
    apart = (electrical_angle(axis, pattern) - axis.hall_zero + whole // 2) % whole - whole // 2
    quarter = whole // 4
    return HALL_ANGLE_APART if apart > quarter or -apart > quarter else 0


def _direction(axis: ServoAxis) -> int:
    """Find an encoder that counts against the motor.

    No load does that: where the voltage is at its limit one way, the shaft goes the other way and does not
    slow down, the count is wrong. Assumed: no document gives the drive's own criterion.
    """
    limit = axis.supply_mv * axis.voltage_percent // 100
    voltage, step, average = axis.voltage_mv, axis.step, axis.velocity_average
    if voltage < 0:
        voltage, step, average = -voltage, -step, -average
    contrary = voltage >= limit and step < 0 and -average > axis.rest_window
    # A shaft that slows down may have been driven by its load.
    if not contrary or ((1 - step) << axis.fraction) < -average:
        axis.contrary_ms = 0
        return 0
    axis.contrary_ms += 1
    return ENCODER_AGAINST_MOTOR if axis.contrary_ms >= CONTRARY_MS else 0
