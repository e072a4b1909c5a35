"""Motors below the shield against closed forms: driven, braked, free; counts, and edges that are lost."""

from dataclasses import replace
from itertools import pairwise
from math import exp, tau

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.pins import INPUT_PULLUP, Pins
from emulators.arduino_omni.motors import COUNTS_PER_TURN, MOTOR, SUPPLY_V, Motors, counted, four_motors
from emulators.arduino_omni.shield.motor_shield import PORTS, MotorShield
from emulators.arduino_omni.shield.pca9685 import AI, ALLCALL, MODE1, SLEEP
from emulators.arduino_omni.shield.tb6612 import ON_RESISTANCE
from emulators.servo.axis import TICK
from emulators.servo.motor import DcMotor
from emulators.servo.seam import ServoError
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

FORWARD, BACKWARD, RELEASE = (
    library.RunArgument.FORWARD,
    library.RunArgument.BACKWARD,
    library.RunArgument.RELEASE,
)


class Bench:
    """A shield with direct commands, and its motors."""

    def __init__(self, motor: DcMotor = MOTOR, counts_per_turn: int = COUNTS_PER_TURN) -> None:
        self.shield = MotorShield()
        self.motors = Motors(self.shield, replace(four_motors(motor), counts_per_turn=counts_per_turn))
        self.now: Nanoseconds = 0
        self.write(bytes((MODE1, AI | ALLCALL)))
        self.run(MILLISECOND)

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


@pytest.mark.parametrize("gap", [40 * MICROSECOND, 470 * MICROSECOND, 3 * MILLISECOND])
def test_who_looks_only_at_the_end_sees_what_he_sees_who_looks_at_each_write(gap: Nanoseconds) -> None:
    seldom, often = Bench(), Bench()
    for it in (seldom, often):
        it.drive(0, 200, FORWARD)
        it.run(20 * MILLISECOND)
        # Asleep and awake again: the oscillator starts by itself, and then a speed is commanded.
        for data in (bytes((MODE1, SLEEP)), bytes((MODE1, AI)), library.set_speed(PORTS[0], 90)):
            it.now += gap
            if it is often:
                it.motors.advance(it.now)
            else:
                it.motors.reach(it.now)
            it.write(data)
        it.run(gap)
    assert list(seldom.motors.angles) == list(often.motors.angles)
    assert seldom.motors.edges == often.motors.edges != [0, 0, 0]


def settled(speed: int) -> tuple[float, float]:
    """Return current and speed at which torque and voltage balance: k i = friction + damping w."""
    volts = SUPPLY_V * speed * 16 / 4096
    ohms = MOTOR.resistance + ON_RESISTANCE
    constant, damping = MOTOR.torque_constant, MOTOR.damping
    turning = (constant * volts / ohms - MOTOR.friction) / (constant**2 / ohms + damping)
    return (MOTOR.friction + damping * turning) / constant, turning


@pytest.mark.parametrize("motor", [0, 3])
@pytest.mark.parametrize(("command", "sign"), [(FORWARD, 1), (BACKWARD, -1)])
@pytest.mark.parametrize("speed", [64, 255])
def test_a_motor_settles_where_torque_and_voltage_balance(
    motor: int, command: int, sign: int, speed: int
) -> None:
    it = Bench()
    it.drive(motor, speed, command)
    it.run(SECOND)
    current, turning = settled(speed)
    assert it.motors.currents[motor] == pytest.approx(sign * current, rel=1e-5)
    assert it.motors.speeds[motor] == pytest.approx(sign * turning, rel=1e-5)
    others = [other for other in range(4) if other != motor]
    assert [it.motors.angles[other] for other in others] == [0.0] * 3


def test_the_encoder_counts_its_lines_and_the_fourth_motor_has_none() -> None:
    it = Bench()
    for motor, (speed, command) in enumerate([(80, FORWARD), (200, BACKWARD), (0, FORWARD), (90, FORWARD)]):
        it.drive(motor, speed, command)
    it.run(SECOND)
    turns = [angle / tau * COUNTS_PER_TURN for angle in it.motors.angles]
    assert [edges - turn for edges, turn in zip(it.motors.edges, turns, strict=False)] == pytest.approx(
        [-0.5] * 3, abs=0.5
    )
    assert it.motors.edges[2] == 0
    assert min(it.motors.edges[0], -it.motors.edges[1], turns[3]) > 1000


@pytest.mark.parametrize(("command", "steps"), [(FORWARD, 1), (BACKWARD, -1)])
def test_the_channels_are_levels_on_their_pins_a_before_b_forwards(command: int, steps: int) -> None:
    it = Bench()
    pins = Pins(it.motors)
    pins.configure(18, INPUT_PULLUP)
    order = [(0, 0), (1, 0), (1, 1), (0, 1)]
    it.drive(1, 20, command)
    seen = [order.index((pins.read(18), pins.read(19)))]
    for _ in range(600):
        it.run(TICK)
        now = order.index((pins.read(18), pins.read(19)))
        if now != seen[-1]:
            seen.append(now)
    assert len(seen) > 8
    assert {(new - old) % 4 for old, new in pairwise(seen)} == {steps % 4}
    assert pins.read(22) == 0  # no one's


# Without friction: shorted by winding and half bridge its speed falls within J (R + Ron) / k2; open it stays.
SMOOTH = replace(MOTOR, friction=0.0, damping=0.0, inductance=1e-5)


def test_with_a_duty_of_zero_it_brakes_through_winding_and_half_bridge() -> None:
    it = Bench(SMOOTH)
    it.drive(0, 255, FORWARD)
    it.run(2 * SECOND)
    it.drive(0, 0, FORWARD)
    before = it.motors.speeds[0]
    it.run(50 * MILLISECOND)
    time_constant = SMOOTH.inertia * (SMOOTH.resistance + ON_RESISTANCE) / SMOOTH.torque_constant**2
    assert it.motors.speeds[0] / before == pytest.approx(exp(-0.05 / time_constant), rel=5e-3)
    assert it.motors.currents[0] < 0


def test_released_it_coasts_without_current() -> None:
    it = Bench(SMOOTH)
    it.drive(0, 255, FORWARD)
    it.run(2 * SECOND)
    it.drive(0, 0, RELEASE)
    before = it.motors.speeds[0]
    it.run(SECOND)
    assert it.motors.speeds[0] == pytest.approx(before, rel=1e-6)
    assert it.motors.currents[0] == pytest.approx(0.0, abs=1e-9)


def test_a_shield_that_wakes_drives_from_the_instant_at_which_its_oscillator_runs() -> None:
    early, late = Bench(), Bench()
    for it in (early, late):
        it.write(bytes((MODE1, SLEEP | AI)))
        it.drive(0, 255, FORWARD)
        it.run(100 * MILLISECOND)
        it.write(bytes((MODE1, AI)))
    early.run(20 * MILLISECOND)  # in one go
    for _ in range(200):
        late.run(TICK)
    assert early.motors.angles[0] == late.motors.angles[0] > 0.0
    asleep = Bench()
    asleep.write(bytes((MODE1, SLEEP | AI)))
    asleep.drive(0, 255, FORWARD)
    asleep.write(bytes((MODE1, AI)))
    asleep.run(500 * MICROSECOND)
    assert asleep.motors.angles[0] == 0.0


@given(st.lists(st.integers(0, 10 * MILLISECOND), max_size=6))
def test_it_does_not_matter_how_often_it_is_requested(steps: list[int]) -> None:
    many, one = Bench(), Bench()
    for it in (many, one):
        it.drive(1, 150, BACKWARD)
    for step in steps:
        many.run(step)
    one.run(sum(steps))
    assert list(many.motors.angles) == list(one.motors.angles)
    assert many.motors.edges == one.motors.edges


@pytest.mark.parametrize(
    ("turned", "seen"),
    [
        ([10, 0, 0], [10, 0, 0]),
        ([3, -4, 3], [3, -4, 3]),
        ([11, 0, 0], [10, 0, 0]),
        ([-20, 0, 0], [-10, 0, 0]),
        ([10, -10, 20], [2, -2, 5]),
        ([1000, 0, 1], [9, 0, 0]),
    ],
)
def test_what_comes_faster_than_the_processor_counts_is_lost(turned: list[int], seen: list[int]) -> None:
    assert counted(turned) == seen


# 12 V / 0.013 V s/rad is 147 turns a second: 75 kHz with 512 counts a turn, 301 kHz with 2048.
@pytest.mark.parametrize(("counts_per_turn", "rate"), [(512, 12 / 0.013 / tau * 512), (2048, 100_000)])
def test_a_fine_encoder_loses_edges_and_a_coarse_one_none(counts_per_turn: int, rate: float) -> None:
    it = Bench(SMOOTH, counts_per_turn)
    it.drive(0, 255, FORWARD)
    it.run(3 * SECOND)
    before = it.motors.edges[0]
    it.run(SECOND)
    assert it.motors.edges[0] - before == pytest.approx(rate * 4080 / 4096 if rate < 100_000 else rate, abs=1)


def test_a_plant_that_gives_no_number_is_named() -> None:
    it = Bench()
    it.motors._plant.outputs[4] = float("nan")  # noqa: SLF001 - a plant that fails
    it.drive(0, 255, FORWARD)
    with pytest.raises(ServoError, match="angle of 'M1' is not finite"):
        it.run(SECOND)
