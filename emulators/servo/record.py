"""The fields of one servo axis, declared once: the table behind the Python class and the record in C.

A field's use in a regulator is in `emulators.servo.loops`. `emulators.servo.header` writes the same table as
a C header.
"""

from typing import Final


class ServoRecord:
    """Sixty-four-bit signed integers, in the order of meaning, which is the order of the record in C."""

    # Fixed: the encoder that is mounted, in quadcounts per turn of the shaft.
    encoder_resolution: int
    # The surroundings, sampled from the plant every ms: the supply at the drive, and at its source (0:
    # unknown).
    supply_mv: int
    source_mv: int
    analogue_1_mv: int
    analogue_2_mv: int
    # ... and those that a bench test sets: supply (0: as the plant has it) and rails of the drive, air at its
    # heat sink, wires and motor.
    forced_supply_mv: int
    logic_mv: int
    gate_mv: int
    ambient_mc: int
    sensor_faults: int
    encoder_loss: int
    mounted_pole_pairs: int
    # Levels of the digital inputs, bit 0 is pin 1: sampled every ms where wired, else left alone.
    pins: int
    # The count at the digital position input, a second encoder or steps: set by the wiring that has one.
    master: int
    # Scaling and gains, derived from the objects.
    resolution: int
    fraction: int
    current_p: int
    current_i: int
    velocity_p: int
    velocity_i: int
    velocity_speed_forward: int
    velocity_acceleration_forward: int
    position_p: int
    position_i: int
    position_d: int
    position_filter: int
    position_speed_forward: int
    position_acceleration_forward: int
    # Limits and supervision, derived from the objects.
    continuous_ma: int
    peak_ma: int
    thermal_full: int
    speed_limit: int
    following_limit_qc: int
    position_window_qc: int
    position_window_ms: int
    velocity_window: int
    velocity_window_ms: int
    rest_window: int
    rest_ms: int
    voltage_percent: int
    over_current_ma: int
    under_voltage_mv: int
    over_voltage_mv: int
    square_per_mc: int
    lowest_qc: int
    highest_qc: int
    position_limited: int
    encoder_reversed: int
    encoder_supervised: int
    index_supervised: int
    hall_pole_pairs: int
    hall_angle_supervised: int
    auxiliary_supervised: int
    # Commands.
    powered: int
    regulator: int
    profile: int
    current_setting_ma: int
    target_velocity: int
    target_position: int
    cruise: int
    acceleration: int
    deceleration: int
    stopping_distance: int
    # What bounds a demand that is not planned: positions of the demand.
    lowest: int
    highest: int
    # A sin2 profile: the present leg, and those that come after it (`emulators.servo.sine`).
    shape: int
    leg_from: int
    leg_to: int
    leg_ms: int
    leg_at: int
    leg_spare: int
    leg_2_to: int
    leg_2_ms: int
    leg_3_to: int
    leg_3_ms: int
    leg_4_to: int
    leg_4_ms: int
    # A spline: the present segment from its knot on, and the next one (`emulators.servo.spline`).
    knot: int
    spline_linear: int
    spline_square: int
    spline_cube: int
    spline_ms: int
    spline_at: int
    next_linear: int
    next_square: int
    next_cube: int
    next_ms: int
    splines_done: int
    # Following the digital position input (`emulators.servo.electronic_gear`).
    gear_counted: int
    gear_numerator: int
    gear_denominator: int
    gear_rest: int
    # An analog set-point: which input, 0 for none (`emulators.servo.setpoint`).
    analogue_input: int
    analogue_numerator: int
    analogue_denominator: int
    analogue_offset: int
    call: int
    # What is an event: edges of these pins, an index, an averaged current beyond this one; 0 watches nothing.
    pins_watched: int
    index_watched: int
    current_watched_ma: int
    # Where an output gives a pulse: directions that count (0: none), reference + width x (first .. last), qc.
    compare_direction: int
    compare_reference: int
    compare_width: int
    compare_first: int
    compare_last: int
    compare_pulse_ms: int
    # Levels of the digital outputs and the brake, for the plant: see `emulators.servo.pins`.
    outputs: int
    # State. `turning`: an open winding's voltage is kept up in this ms, JUST_OPENED: and has not been yet;
    # `event`: the last ms raised an event.
    now: int
    flags: int
    encoder: int
    position: int
    step: int
    velocity_average: int
    current_ma: int
    current_average: int
    current_demand_ma: int
    current_limit_ma: int
    current_integral: int
    voltage_mv: int
    turning: int
    # Data of an open winding (`emulators.servo.winding`): constant, 2^-24 V s/rad; the ratios of voltage to
    # current by which the current decays to 0, and turns round, within a tick, 2^-16 Ohm, 0: unknown; the
    # rate at which the constant is learnt, 2^-24 Ohm, 0: given; its last increment, and the current of that,
    # mA; the part of the current that is left as it is, and the ms for which it is left to itself. The
    # shaft's speed a tick before, mrad/s.
    back_emf: int
    decay_resistance: int
    balance_resistance: int
    learning: int
    raised: int
    braking: int
    left: int
    waits: int
    speed_before: int
    velocity_demand: int
    acceleration_demand: int
    position_demand: int
    velocity_integral: int
    position_integral: int
    derivative: int
    thermal: int
    window_ms: int
    still_ms: int
    event: int
    # The pins one ms ago; where the index was passed last, and how often it was since power-on.
    pins_before: int
    index_position: int
    index_passes: int
    # What is left of the present pulse, ms, and how many positions have been met since power-on.
    compare_left: int
    compare_hits: int
    # The shaft's own step, what the count is apart from the shaft, and the rest of a count that gets lost.
    turned: int
    slipped: int
    loss_rest: int
    # Counts at the last index and at the one before it, and how far they have been judged.
    index_count: int
    index_before: int
    index_known: int
    index_judged: int
    # Where the shaft was switched on, and the electrical angle there.
    switched_on_at: int
    hall_zero: int
    contrary_ms: int
    # The current's square, slowly averaged: it heats the power stage.
    heat: int
    # Whether the recorder beside the axis records: see `emulators.servo.recorder`.
    recording: int


FIELDS: Final[tuple[str, ...]] = tuple(ServoRecord.__annotations__)
