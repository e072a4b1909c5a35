"""Pins, index and current threshold: the events of an axis, their millisecond, and their receivers."""

from math import tau

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.servo import kernel
from emulators.servo.axis import CURRENT_REACHED, RAMP, TICK, VELOCITY, ServoAxis
from emulators.servo.bank import ServoBank, ServoError
from emulators.servo.loops import millisecond
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.pins import BRAKE_CLOSED, PinWire, input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.scaling import acceleration_units, configure, speed_units
from firmware_bridge.units import MILLISECOND, SECOND
from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.single_axis.parameters import SETS
from hil_tests.unit.servo.side_by_side import SANE

TURN = 2000
HOME = 1 << 3


def turned(*counts: int) -> ServoAxis:
    """An axis whose encoder has stood at these counts, one after the other."""
    axis = ServoAxis("one", TURN)
    axis.encoder = counts[0]
    for count in counts[1:]:
        millisecond(axis, count)
    return axis


@pytest.mark.parametrize(
    ("counts", "passes", "position"),
    [
        ((1, 1999), 0, 0),
        ((1998, 1999, 2000), 1, 2),
        ((1990, 2005), 1, 10),
        ((2000, 2001), 0, 0),
        ((2005, 1990), 1, -5),
        ((2000, 1999), 1, 0),
        ((1, 0), 0, 0),
        ((1, -1), 1, -1),
        ((-3, 4000, 3999), 2, 4003),
        ((5, -4001), 1, -4005),
    ],
)
def test_the_index_is_latched_at_its_own_count_whichever_way_it_is_passed(
    counts: tuple[int, ...], passes: int, position: int
) -> None:
    axis = turned(*counts)
    assert (axis.index_passes, axis.index_position) == (passes, position)


@given(start=st.integers(-10_000, 10_000), steps=st.lists(st.integers(-1500, 1500), max_size=30))
def test_the_latched_position_is_always_that_of_a_whole_turn(start: int, steps: list[int]) -> None:
    axis = turned(start)
    for step in steps:
        before = axis.index_passes
        millisecond(axis, axis.encoder + step)
        if axis.index_passes != before:
            assert (start + axis.index_position) % TURN == 0
            assert abs(axis.position - axis.index_position) <= abs(step)


def test_only_a_watched_index_is_an_event() -> None:
    axis = turned(1990, 1991)
    assert not millisecond(axis, 2001)
    axis.index_watched = 1
    assert not millisecond(axis, 2002)
    assert millisecond(axis, 1995)
    assert axis.index_passes == 2


def test_the_averaged_current_is_watched_on_both_sides() -> None:
    axis = turned(0)
    axis.current_watched_ma = 500
    for current, reached in (
        (500 << 16, 0),
        ((500 << 16) + 1, CURRENT_REACHED),
        (-(501 << 16), CURRENT_REACHED),
    ):
        axis.current_average = current
        millisecond(axis, 0)
        assert axis.flags & CURRENT_REACHED == reached
    axis.current_watched_ma = 0
    millisecond(axis, 0)
    assert not axis.flags & CURRENT_REACHED


def test_names_of_the_plants_switches() -> None:
    names = pin_outputs(("left", "lift"))
    assert len(set(names)) == len(names) == 24
    assert names[:2] == ("pin_1_left", "pin_2_left")
    found = input_lines(("current_lift", "home_lift", "negative_limit_left", "pin_9_lift"), ("left", "lift"))
    assert found == (PinWire(0, 1 << 5, 2), PinWire(1, 1 << 8, 3), PinWire(1, HOME, 1))
    assert "brake_lift" in pin_inputs(("lift",))
    assert output_lines(("voltage_lift", "output_2_lift", "brake_lift"), ("lift",)) == (
        PinWire(0, 1 << 1, 1),
        PinWire(0, BRAKE_CLOSED, 2),
    )


class Bench(DcMotors):
    """A motor with one more output, a switch in the hand of the test, and one more input."""

    def __init__(self) -> None:
        super().__init__((DcMotor(1.0, 1e-3, 0.04, 1e-4),))
        self.inputs.append(0.0)
        self.outputs.append(0.0)

    def bank(self, axis: ServoAxis) -> ServoBank:
        return ServoBank(self, [axis], input_lines=(PinWire(0, HOME, 3),), output_lines=(PinWire(0, 2, 1),))


def test_a_watched_edge_ends_the_advance_in_the_millisecond_that_samples_it() -> None:
    plant, axis = Bench(), ServoAxis("one", TURN)
    bank = plant.bank(axis)
    axis.pins = 1 << 8
    bank.advance(4 * MILLISECOND + 3 * TICK)
    plant.outputs[3] = 1.0
    assert bank.advance(10 * MILLISECOND) == (10 * MILLISECOND, ())
    assert axis.pins == HOME | 1 << 8, "a pin without a wire is left alone"
    axis.pins_watched = HOME
    plant.outputs[3] = 0.0
    assert bank.advance(SECOND) == (10 * MILLISECOND + TICK, ("one",))
    assert axis.pins == 1 << 8
    assert bank.advance(SECOND) == (SECOND, ())


def test_the_plant_sees_the_drives_outputs() -> None:
    plant, axis = Bench(), ServoAxis("one", TURN)
    bank = plant.bank(axis)
    axis.outputs = 2
    bank.advance(MILLISECOND)
    assert plant.inputs[1] == 1.0
    axis.outputs = 1
    bank.advance(2 * MILLISECOND)
    assert plant.inputs[1] == 0.0


@pytest.mark.parametrize("value", [float("nan"), 1e9])
def test_a_switch_that_gives_no_number_is_refused(value: float) -> None:
    plant = Bench()
    bank = plant.bank(ServoAxis("one", TURN))
    plant.outputs[3] = value
    with pytest.raises(ServoError, match="the plant's pin of 'one' is"):
        bank.advance(MILLISECOND)


def single_axis(found: kernel.KernelLibrary) -> tuple[FmuPlant, ServoAxis, ServoBank]:
    plant = FmuPlant(
        ensure("single_axis"),
        ("voltage_axis",),
        ("current_axis", "angle_axis", "speed_axis"),
        SETS["between_stops"],
        optional_inputs=pin_inputs(("axis",)),
        optional_outputs=pin_outputs(("axis",)),
    )
    axis = ServoAxis("axis", TURN)
    lines = input_lines(plant.output_names, ("axis",))
    return plant, axis, ServoBank(plant, [axis], input_lines=lines, servo=found)


@pytest.mark.parametrize("native", [False, True])
def test_the_fmus_switches_reach_the_pins_where_its_load_stands(*, native: bool) -> None:
    found = kernel.find() if native else kernel.KernelLibrary(None, "the reference")
    plant, axis, bank = single_axis(found)
    with plant:
        assert bank.native == native
        axis.pins_watched = 0x3F
        configure(axis, SANE)
        axis.switch_on()
        axis.acceleration = acceleration_units(axis, 3000)
        axis.target_velocity, axis.profile, axis.regulator = speed_units(axis, 500), RAMP, VELOCITY
        edges = []
        while bank.now < 3 * SECOND // 2:
            pins = axis.pins
            bank.advance(bank.now + MILLISECOND)
            if axis.pins != pins:
                edges.append((axis.pins, round(axis.position / TURN * tau / 26.0, 1)))
        assert edges == [(HOME, 0.4), (0, 0.6), (1 << 4, 1.9)]
