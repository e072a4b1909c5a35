"""A plant's second encoder and analog voltages reach the axes, in kernel and reference alike."""

import ctypes

import pytest

from emulators.servo import kernel
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, ServoError
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.pins import PinWire
from emulators.servo.sensor_lines import ANALOGUE_1, ANALOGUE_2, MASTER, sensor_lines, sensor_outputs
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.servo.planned_orders import obey_planned
from hil_tests.unit.servo.side_by_side import (
    COUNT,
    REFERENCE,
    SANE,
    Leg,
    Motors,
    Order,
    Side,
    difference,
)


class Bench(DcMotors):
    """A motor with three more outputs."""

    def __init__(self) -> None:
        super().__init__((DcMotor(1.0, 1e-3, 0.04, 1e-4),))
        self.outputs.extend((0.0, 0.0, 0.0))

    def bank(self, axis: ServoAxis) -> ServoBank:
        names = ("current_one", "angle_one", "speed_one", *sensor_outputs(("one",)))
        return ServoBank(self, [axis], input_lines=sensor_lines(names, ("one",)))


def test_the_names_and_what_they_are_wired_to() -> None:
    assert sensor_outputs(("left", "lift")) == (
        *("master_left", "analogue_1_left", "analogue_2_left"),
        *("master_lift", "analogue_1_lift", "analogue_2_lift"),
    )
    found = sensor_lines(("current_lift", "analogue_2_left", "master_lift"), ("left", "lift"))
    assert found == (PinWire(0, ANALOGUE_2, 1), PinWire(1, MASTER, 2))


def test_counts_are_whole_and_volts_are_millivolts() -> None:
    plant, axis = Bench(), ServoAxis("one", 2000)
    bank = plant.bank(axis)
    for outputs, read in (((-0.5, 1.2345, -3.0), (-1, 1234, -3000)), ((7.9, -0.0009, 0.5), (7, 0, 500))):
        for place, value in enumerate(outputs, 3):
            plant.outputs[place] = value
        bank.advance(bank.now + MILLISECOND)
        assert (axis.master, axis.analogue_1_mv, axis.analogue_2_mv) == read
        assert axis.pins == 0


@pytest.mark.parametrize("place", [3, 4, 5])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e17])
def test_what_is_no_measurement_is_refused(place: int, value: float) -> None:
    plant = Bench()
    bank = plant.bank(ServoAxis("one", 2000))
    plant.outputs[place] = value
    with pytest.raises(ServoError, match="the plant's sensor of 'one' is"):
        bank.advance(MILLISECOND)


def sides(library: ctypes.CDLL) -> tuple[Side, Side]:
    """Axis 0 is geared to the angle of axis 1, and axis 2 driven by volts that are the speed of axis 1."""
    lines = (
        PinWire(0, MASTER, COUNT + 1),
        PinWire(2, ANALOGUE_2, 2 * COUNT + 1),
        PinWire(3, ANALOGUE_1, COUNT + 1),
    )
    made = []
    for found in (REFERENCE, kernel.find()):
        side = Side(Motors(library), (SANE,) * COUNT, found)
        side.bank = ServoBank(side.plant, side.axes, supply=3 * COUNT, input_lines=lines, servo=found)
        made.append(side)
    assert [side.bank.native for side in made] == [False, True]
    return made[0], made[1]


def test_kernel_and_reference_sample_the_same_bits(plant_library: ctypes.CDLL) -> None:
    reference, one = sides(plant_library)
    power = Leg(tuple(Order(axis, 0, 0, 0, 1000, 1000) for axis in range(COUNT)), 30)
    turns = Leg((Order(1, 1, 0, 600, 3000, 3000),), 4000)
    for leg in (power, turns, turns):
        for side in (reference, one):
            if leg is turns:
                obey_planned(side.axes[0], 13, 1_000_000, 3000, (999, 7))
                obey_planned(side.axes[2], 14, 4, 25, (9, 1))
        assert reference.lives(leg) == one.lives(leg)
        assert not difference(reference, one)
    assert one.axes[0].master > 5
    assert one.axes[0].position_demand > 0
    assert one.axes[2].analogue_2_mv > 1000
    assert one.axes[3].analogue_1_mv > 1000


def test_the_kernel_refuses_what_the_reference_refuses(plant_library: ctypes.CDLL) -> None:
    stated = []
    for side in sides(plant_library):
        side.plant.breaks(at=20, failing=4, replaced=1, replacement=1e30)
        side.bank = ServoBank(
            side.plant, side.axes, input_lines=(PinWire(2, MASTER, COUNT),), servo=one_of(side.bank.native)
        )
        stated.append(side.lives(Leg((), 100)))
    assert stated[0] == stated[1]
    assert isinstance(stated[0], str)
    assert "sensor of 'axis2'" in stated[0]


def one_of(native: bool) -> kernel.KernelLibrary:  # noqa: FBT001 - which of the two
    return kernel.find() if native else REFERENCE
