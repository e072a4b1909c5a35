"""A shield's motors in C beside the reference: the same bits, and the same words of one that fails."""

import ctypes
from typing import Any

import numpy as np
import pytest

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.pins import ENCODER_PINS
from emulators.arduino_omni.motors import MotorLoad, Motors
from emulators.arduino_omni.shield.motor_shield import PORTS, MotorShield
from emulators.arduino_omni.shield.pca9685 import AI, ALLCALL, MODE1, SLEEP
from emulators.servo import kernel, terminals
from emulators.servo.axis import TICK
from emulators.servo.seam import ServoError
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds
from fmu.errors import PlantError
from hil_tests.unit.servo import side_by_side

COMMANDS = tuple(library.RunArgument)
NAMES = ("M1", "M2", "M3", "M4")
ANGLE = 1
SUPPLY = 12
"""Index of the plant's output with it."""


class Bench:
    """A shield with direct commands, and motors of the test's plant."""

    def __init__(self, plant: side_by_side.Motors, counts_per_turn: int, supply: int | None) -> None:
        self.plant = plant
        self.shield = MotorShield()
        load = MotorLoad(plant, NAMES, (0.04, 0.03, 0.05, 0.04), supply, counts_per_turn=counts_per_turn)
        self.motors = Motors(self.shield, load)
        self.now: Nanoseconds = 0
        self.write(bytes((MODE1, AI | ALLCALL)))

    def write(self, data: bytes) -> None:
        chip = self.shield.chip
        chip.addressed(chip.address, reading=False, at=self.now)
        for byte in data:
            chip.written(byte, self.now)
        chip.stopped(self.now)

    def drive(self, motor: int, speed: int, command: int) -> None:
        self.write(library.set_speed(PORTS[motor], speed))
        for data in library.run(PORTS[motor], command):
            self.write(data)

    def run(self, duration: Nanoseconds) -> None:
        self.now += duration
        self.motors.advance(self.now)

    def seen(self) -> tuple[Any, ...]:
        motors = self.motors
        levels = [motors.level(pin) for pins in ENCODER_PINS for pin in pins]
        return motors.now, list(motors.edges), bytes(self.plant.outputs), self.plant.record.steps_done, levels


@pytest.fixture
def both(plant_library: ctypes.CDLL, native: kernel.KernelLibrary, monkeypatch: pytest.MonkeyPatch) -> Any:
    def make(counts_per_turn: int = 48, supply: int | None = SUPPLY, fmi: int = 3) -> tuple[Bench, Bench]:
        made = []
        for found in (native, side_by_side.REFERENCE):
            monkeypatch.setattr(terminals, "choose", lambda found=found: found)
            made.append(Bench(side_by_side.Motors(plant_library, fmi), counts_per_turn, supply))
        one, other = made
        return one, other

    return make


# With 48 counts a turn no edge is lost, with 100,000 most are. Without the plant's supply it is constant.
@pytest.mark.parametrize(
    ("counts_per_turn", "supply", "fmi"), [(48, SUPPLY, 3), (100_000, SUPPLY, 2), (48, None, 3)]
)
def test_they_turn_alike_whatever_they_are_reported(
    both: Any, counts_per_turn: int, supply: int | None, fmi: int
) -> None:
    chance = np.random.default_rng(counts_per_turn)
    sides = both(counts_per_turn, supply, fmi)
    for leg in range(400):
        what, motor, speed, command, us = chance.integers([12, 4, 256, 5, 4_000]).tolist()
        for it in sides:
            faults = it.motors.faults
            if what == 0:
                faults.dead ^= {motor % 3}
            elif what == 1:
                faults.cut ^= {motor}
            elif what == 2:  # the oscillator starts again, in the midst of what follows
                it.write(bytes((MODE1, SLEEP | AI)))
                it.write(bytes((MODE1, AI)))
            elif what < 9:
                it.drive(motor, speed, COMMANDS[command % len(COMMANDS)])
            if leg % 40 == 39:
                faults.dead, faults.cut = set(), set()
            it.run(us * MICROSECOND)
        assert sides[0].seen() == sides[1].seen()
    assert all(sides[0].motors.edges)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("failing", "value", "error"),
    [
        (1, 0.0, PlantError),
        (2, 0.0, PlantError),
        (3, 0.0, PlantError),
        (4, float("nan"), ServoError),
        (4, -1e300, ServoError),
    ],
)
def test_a_plant_that_fails_is_named_alike_at_the_same_tick(
    both: Any, fmi: int, failing: int, value: float, error: type[Exception]
) -> None:
    stated = []
    for it in both(fmi=fmi):
        it.drive(0, 200, library.RunArgument.FORWARD)
        it.run(5 * TICK + 30 * MICROSECOND)
        it.plant.breaks(33, failing, ANGLE, value)
        with pytest.raises(error) as refusal:
            it.run(10 * MILLISECOND)
        stated.append((str(refusal.value), it.motors.now, it.motors.edges))
    assert stated[0] == stated[1]
    assert 32 * TICK <= stated[0][1] <= 34 * TICK


def test_the_library_serves_where_it_can(both: Any) -> None:
    steps = []
    for it in both():
        it.plant.step = lambda: steps.append(1)  # what only the reference calls
        it.run(MILLISECOND)
        steps.append(0)
    assert steps == [0, *[1] * 10, 0]
