"""An open winding whose motor nobody knows: it may brake a little while it learns, but it never drives."""

from math import copysign

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from emulators.servo.axis import CURRENT, TICK, ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.scaling import Settings, configure
from firmware_bridge.units import MILLISECOND

GAINS = Settings(current_p=180, current_i=60, peak_current=20_000, continuous_current=20_000)
MOTOR = DcMotor(1.0, 0.5e-3, 0.04, 2e-4)


def loaded(motor: DcMotor, speed: float, current_ma: int) -> tuple[ServoBank, DcMotors, ServoAxis]:
    """Return a motor that turns at `speed` (rad/s) while its current balances a load."""
    plant = DcMotors((motor,))
    axis = ServoAxis("one", 2000)
    configure(axis, GAINS)
    bank = ServoBank(plant, [axis])
    axis.switch_on()
    axis.regulator, axis.current_setting_ma = CURRENT, current_ma
    plant.outputs[0] = current_ma / 1000
    plant.outputs[2] = speed
    plant.load[0] = -motor.torque_constant * current_ma / 1000
    while bank.now < 20 * MILLISECOND:
        bank.advance(20 * MILLISECOND)
    return bank, plant, axis


def driven(bank: ServoBank, plant: DcMotors, motor: DcMotor, milliseconds: int) -> float:
    """Return the work in J that the winding does on the shaft from now on, braking left aside."""
    work, until = 0.0, bank.now + milliseconds * MILLISECOND
    while bank.now < until:
        bank.advance(bank.now + TICK)
        current, _, speed = plant.outputs[:3]
        work += max(0.0, motor.torque_constant * current * speed) * TICK / 1e9
    return work


def stored(motor: DcMotor, plant: DcMotors) -> float:
    """Return the energy of winding and rotor in J; where little resists it swings between the two."""
    current, _, speed = plant.outputs[:3]
    return (motor.inductance * current**2 + motor.inertia * speed**2) / 2


@pytest.mark.parametrize("speed", [-60.0, -6.0, -3.0, 0.5, 3.0, 6.0, 60.0])
@pytest.mark.parametrize("current_ma", [-5000, -50, 0, 50, 5000])
def test_power_off_under_load_never_leaves_a_winding_that_drives(speed: float, current_ma: int) -> None:
    bank, plant, axis = loaded(MOTOR, speed, current_ma)
    axis.switch_off()
    held = MOTOR.inductance * plant.outputs[0] ** 2 / 2
    plant.load[0] = 0.0
    before = abs(plant.outputs[2])
    assert driven(bank, plant, MOTOR, 300) <= 1.5 * held + 1e-4
    assert abs(plant.outputs[2]) <= before + 0.05


def test_a_load_that_pulls_meets_no_help_from_the_winding() -> None:
    bank, plant, axis = loaded(MOTOR, 6.0, 5000)
    axis.switch_off()
    for _ in range(200):
        bank.advance(bank.now + MILLISECOND)
        assert plant.outputs[0] * copysign(1.0, plant.outputs[2]) < 0.05 or bank.now < 25 * MILLISECOND


@settings(max_examples=40, deadline=None)
@given(
    resistance=st.floats(0.06, 15.0),
    delay=st.floats(1e-5, 1e-3),
    constant=st.floats(0.005, 0.2),
    inertia=st.floats(1e-5, 1e-3),
    speed=st.floats(-100.0, 100.0),
    share=st.floats(-1.0, 1.0),
)
def test_no_motor_draws_energy_from_an_open_winding(
    *, resistance: float, delay: float, constant: float, inertia: float, speed: float, share: float
) -> None:
    motor = DcMotor(resistance, resistance * delay, constant, inertia)
    room = max(0.0, 20.0 - constant * abs(speed)) / resistance
    current_ma = round(1000 * share * min(15.0, room))
    bank, plant, axis = loaded(motor, speed, current_ma)
    # Gains that do not fit the motor make the current hunt, and its voltage tells nothing of the motor then.
    steady = resistance * plant.outputs[0] + constant * plant.outputs[2]
    assume(abs(1000 * plant.outputs[0] - current_ma) <= 0.02 * abs(current_ma) + 20)
    assume(abs(plant.inputs[0] - steady) <= 0.02 * abs(steady) + 0.05)
    axis.switch_off()
    plant.load[0] = 0.0
    before, until = stored(motor, plant), bank.now + 100 * MILLISECOND
    while bank.now < until:
        bank.advance(bank.now + TICK)
        assert stored(motor, plant) <= 1.01 * before + 1e-4
