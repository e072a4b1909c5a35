"""No intermediate result of the regulators leaves 64 bits: a kernel in C computes the same."""

from types import SimpleNamespace
from typing import Self, cast

from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.servo.axis import MOVE, RAMP, TICK, ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.loops import millisecond
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.profile import stopping_distance
from emulators.servo.record import FIELDS
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.servo.winding import DIODES_MV, opened, set_winding, turns
from hil_tests.lanes import examples

LARGEST = 2**63 - 1
S16 = st.integers(-(2**15), 2**15 - 1)
U16 = st.integers(0, 2**16 - 1)
U32 = st.integers(0, 2**32 - 1)
S32 = st.integers(-(2**31), 2**31 - 1)


class Word(int):
    """A whole number that refuses to be wider than 64 bits, signed."""

    def __new__(cls, value: int) -> Self:
        assert -LARGEST - 1 <= value <= LARGEST, f"{int(value).bit_length()} bits"
        return super().__new__(cls, value)

    def __add__(self, other: int) -> "Word":
        return Word(int(self) + int(other))

    def __sub__(self, other: int) -> "Word":
        return Word(int(self) - int(other))

    def __rsub__(self, other: int) -> "Word":
        return Word(int(other) - int(self))

    def __mul__(self, other: int) -> "Word":
        return Word(int(self) * int(other))

    def __lshift__(self, other: int) -> "Word":
        return Word(int(self) << int(other))

    def __rshift__(self, other: int) -> "Word":
        return Word(int(self) >> int(other))

    def __neg__(self) -> "Word":
        return Word(-int(self))

    __radd__ = __add__
    __rmul__ = __mul__


def as_words(axis: ServoAxis) -> ServoAxis:
    """The same axis with Python's unbounded numbers, watched, in place of the record's 64 bits."""
    words: dict[str, int] = {name: Word(getattr(axis, name)) for name in FIELDS}
    words["encoder_resolution"] = axis.encoder_resolution
    return cast("ServoAxis", SimpleNamespace(name=axis.name, node=axis.node, **words))


RAW = st.builds(
    Settings,
    encoder_pulses=st.integers(16, 2_500_000),
    current_p=S16,
    current_i=S16,
    velocity_p=S16,
    velocity_i=S16,
    velocity_speed_forward=U16,
    velocity_acceleration_forward=U16,
    position_p=S16,
    position_i=S16,
    position_d=S16,
    position_speed_forward=U16,
    position_acceleration_forward=U16,
    continuous_current=U16,
    peak_current=U16,
    thermal_time=st.integers(1, 5400),
    max_speed=U32,
    following_error=U32,
    position_window=U32,
    position_window_time=U16,
    velocity_window=U32,
    velocity_window_time=U16,
    standstill_window=U16,
    standstill_time=U16,
)


@settings(max_examples=examples(200))
@given(
    raw=RAW,
    regulator=st.sampled_from((1, 2, 3)),
    profile=st.sampled_from((0, RAMP, MOVE)),
    target=S32,
    speed=U32,
    up=U32,
    down=U32,
    life=st.lists(
        st.tuples(st.integers(-(2**21), 2**21), st.integers(-(2**22), 2**22)), min_size=1, max_size=30
    ),
)
def test_every_millisecond_stays_within_64_bits(
    *,
    raw: Settings,
    regulator: int,
    profile: int,
    target: int,
    speed: int,
    up: int,
    down: int,
    life: list[tuple[int, int]],
) -> None:
    axis = ServoAxis("one", 4 * raw.encoder_pulses)
    configure(axis, raw)
    axis.switch_on()
    axis.regulator, axis.profile = regulator, profile
    axis.target_position = target << axis.fraction
    axis.target_velocity = axis.cruise = speed_units(axis, speed)
    axis.acceleration = acceleration_units(axis, up)
    axis.deceleration = acceleration_units(axis, down)
    axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
    axis.current_setting_ma = target
    axis = as_words(axis)
    encoder = 0
    for step, current in life * 4:
        encoder += step
        axis.current_ma = Word(current)
        millisecond(axis, Word(encoder))
        assert abs(axis.current_demand_ma) <= axis.current_limit_ma
        for name in FIELDS:
            assert abs(getattr(axis, name)) <= LARGEST


@settings(max_examples=examples(50))
@given(S16, S16, st.integers(-(2**16), 2**16))
def test_the_current_loop_stays_within_64_bits_and_its_voltage_within_the_supply(
    gain: int, integral: int, demand: int
) -> None:
    motor = DcMotor(0.1, 1e-4, 0.04, 1e-4)
    plant = DcMotors((motor,))
    axis = ServoAxis("one", 2000)
    configure(axis, Settings(current_p=gain, current_i=integral, peak_current=0xFFFF))
    axis.switch_on()
    axis.regulator = 1
    axis.current_setting_ma = demand
    axis = as_words(axis)
    bank = ServoBank(plant, [axis])
    for tick in range(100):
        bank.advance((tick + 1) * TICK)
        assert abs(axis.voltage_mv) <= 21_600
        assert abs(axis.current_integral) <= LARGEST


@settings(max_examples=examples(200))
@given(
    reported=st.tuples(st.floats(0.0, 300.0), st.floats(0.0, 1e5), st.floats(0.0, 10.0)),
    supply=st.integers(0, 2**30),
    life=st.lists(
        st.tuples(st.integers(-(2**30), 2**30), st.integers(-(2**30), 2**30)), min_size=1, max_size=30
    ),
)
def test_an_open_winding_stays_within_64_bits_whatever_is_reported_and_measured(
    reported: tuple[float, float, float], supply: int, life: list[tuple[int, int]]
) -> None:
    axis = ServoAxis("one", 2000, supply_mv=supply)
    set_winding(axis, *reported)
    axis = as_words(axis)
    for current, speed in life:
        axis.turning = Word(turns(axis, Word(speed)))
        for _ in range(2):
            assert abs(opened(axis, Word(current), Word(speed))) <= supply + DIODES_MV
        for name in FIELDS:
            assert abs(getattr(axis, name)) <= LARGEST
