"""No intermediate result of a planned demand leaves 64 bits, whatever the objects hold."""

from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.servo import sine, spline
from emulators.servo.axis import CURRENT, DIRECT, ELECTRONIC_GEAR, MOVE, POSITION, RAMP, ServoAxis
from emulators.servo.loops import millisecond
from emulators.servo.profile import stopping_distance
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.servo.spline import Knot
from hil_tests.lanes import examples
from hil_tests.unit.servo.test_word_size import S32, U32, Word, as_words

PULSES = st.sampled_from((16, 500, 6400, 2_500_000))
RPM = st.integers(-25_000, 25_000)
COUNTS = st.lists(st.integers(-(2**52), 2**52), min_size=1, max_size=20)


def axis_for(pulses: int, speed: int = 25_000, up: int = 2**32 - 1, down: int = 2**32 - 1) -> ServoAxis:
    axis = ServoAxis("one", 4 * pulses)
    configure(axis, Settings(encoder_pulses=pulses))
    axis.switch_on()
    axis.regulator = POSITION
    axis.cruise = speed_units(axis, speed)
    axis.acceleration = acceleration_units(axis, up)
    axis.deceleration = acceleration_units(axis, down)
    axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
    return axis


def lives(axis: ServoAxis, milliseconds: int = 30) -> None:
    words = as_words(axis)
    for _ in range(milliseconds):
        millisecond(words, Word(0))


@settings(max_examples=examples(80))
@given(PULSES, st.sampled_from((MOVE, RAMP)), S32, RPM, RPM, U32, U32, st.integers(0, 2**31))
def test_sine_legs(  # noqa: PLR0917 - what the objects may hold
    pulses: int, profile: int, target: int, speed: int, present: int, up: int, down: int, later: int
) -> None:
    axis = axis_for(pulses, abs(speed), up, down)
    axis.profile, axis.target_position = profile, target << axis.fraction
    axis.target_velocity = speed_units(axis, speed)
    axis.velocity_demand = speed_units(axis, present)
    sine.load(axis)
    # In the midst of the longest leg, too.
    axis.leg_at = min(later, max(0, axis.leg_ms - 1))
    lives(axis)


@settings(max_examples=examples(80))
@given(PULSES, S32, st.integers(1, 255), RPM, RPM, RPM)
def test_a_spline_as_fast_as_may_be(  # noqa: PLR0917 - what the objects may hold
    pulses: int, start: int, ms: int, mean: int, first: int, last: int
) -> None:
    axis = axis_for(pulses)
    here = Knot(start << axis.fraction, speed_units(axis, first))
    there = Knot(here.position + speed_units(axis, mean) * ms, speed_units(axis, last))
    axis.position_demand = here.position
    spline.begin(axis, spline.segment(here, there, ms))
    spline.prepare(axis, spline.segment(there, here, ms))
    lives(axis, 2 * ms + 2)


@settings(max_examples=examples(80))
@given(PULSES, COUNTS, st.integers(-0xFFFF, 0xFFFF), st.integers(1, 0xFFFF), U32, S32, S32)
def test_following(  # noqa: PLR0917 - what the objects may hold
    pulses: int, counts: list[int], numerator: int, denominator: int, slope: int, low: int, high: int
) -> None:
    axis = axis_for(pulses, up=slope, down=slope)
    axis.profile = ELECTRONIC_GEAR
    axis.gear_numerator, axis.gear_denominator = numerator, denominator
    axis.lowest, axis.highest = min(low, high) << axis.fraction, max(low, high) << axis.fraction
    words = as_words(axis)
    for count in counts:
        words.master = Word(count)
        millisecond(words, Word(0))
        assert abs(words.velocity_demand) <= axis.cruise


@settings(max_examples=examples(80))
@given(
    PULSES,
    st.sampled_from((CURRENT, 2, POSITION)),
    st.integers(-(2**30), 2**30),
    st.integers(-(2**15), 2**15 - 1),
    st.integers(-9, 9),
    S32,
)
def test_analog_set_points(  # noqa: PLR0917 - what the objects may hold
    pulses: int, regulator: int, millivolts: int, scaling: int, notation: int, offset: int
) -> None:
    axis = axis_for(pulses)
    axis.profile, axis.regulator, axis.analogue_input = DIRECT, regulator, 2
    axis.analogue_2_mv = millivolts
    axis.analogue_numerator = scaling * 10 ** max(0, notation)
    axis.analogue_denominator = 1000 * 10 ** max(0, -notation)
    axis.analogue_offset = offset
    lives(axis, 3)
