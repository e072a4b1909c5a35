"""Axes and plant together: events, current loop, open winding, and the error for a bad plant."""

from dataclasses import replace
from itertools import pairwise
from math import expm1

import pytest

from emulators.servo.axis import RAMP, TARGET_REACHED, TICK, VELOCITY, ServoAxis
from emulators.servo.bank import ServoBank, ServoError, plant_inputs, plant_outputs
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.servo.winding import set_winding
from firmware_bridge.units import MILLISECOND, SECOND

# maxon RE50 200 W, values from memory of the catalog (assumed), with 80 kg reflected through 26:1.
WHEEL = DcMotor(0.103, 0.072e-3, 0.0385, 2.0e-4, friction=4.5e-3, damping=7e-6)
GAINS = Settings(
    current_p=86,
    current_i=13,
    velocity_p=4000,
    velocity_i=80,
    velocity_acceleration_forward=5000,
    peak_current=20_000,
)


def bank_of(count: int = 1, motor: DcMotor = WHEEL) -> tuple[ServoBank, DcMotors, list[ServoAxis]]:
    plant = DcMotors((motor,) * count)
    axes = [ServoAxis(f"axis{k}", 2000, node=f"drive{k}") for k in range(count)]
    for axis in axes:
        configure(axis, GAINS)
    return ServoBank(plant, axes), plant, axes


def drive(axis: ServoAxis, rpm: int) -> None:
    if not axis.powered:
        axis.switch_on()
    axis.regulator = VELOCITY
    axis.profile = RAMP
    axis.target_velocity = speed_units(axis, rpm)
    axis.acceleration = axis.deceleration = acceleration_units(axis, 6600)


def test_names_of_the_plants_variables() -> None:
    assert plant_inputs(("left", "lift")) == ("voltage_left", "voltage_lift")
    assert plant_outputs(("left", "lift")) == (
        "current_left",
        "current_lift",
        "angle_left",
        "angle_lift",
        "speed_left",
        "speed_lift",
    )


def test_whole_ticks_run_and_time_passes_without_events() -> None:
    bank, plant, axes = bank_of()
    bank.advance(60 * MILLISECOND)
    steps = plant.steps_done
    assert bank.advance(bank.now + TICK - 1) == (bank.now + TICK - 1, ())
    assert plant.steps_done == steps
    until = bank.now + 7 * TICK
    assert bank.advance(until) == (until, ())
    assert plant.steps_done == steps + 7
    assert axes[0].now == bank.now == until


def test_an_event_ends_the_advance_at_its_tick_and_names_the_node() -> None:
    bank, plant, axes = bank_of(2)
    bank.advance(60 * MILLISECOND)
    drive(axes[1], 659)
    seen = []
    now = bank.now
    while now < 400 * MILLISECOND:
        now, nodes = bank.advance(400 * MILLISECOND)
        assert now == plant.steps_done * TICK or not nodes
        if nodes:
            seen.append((now, nodes, bool(axes[1].flags & TARGET_REACHED)))
    # Not at rest any more in the first ms; there after 100 ms of ramp.
    assert seen == [
        (60 * MILLISECOND + TICK, ("drive1",), False),
        (60 * MILLISECOND + 99 * MILLISECOND + TICK, ("drive1",), True),
    ]


def test_a_call_wakes_the_node_in_the_next_millisecond() -> None:
    bank, _, axes = bank_of()
    axes[0].call = 1
    assert bank.advance(SECOND) == (TICK, ("drive0",))


def test_the_current_follows_its_demand_as_a_first_order_with_half_the_error_each_tick() -> None:
    # Gains chosen to cancel the winding's pole; the shaft is held by its inertia.
    bank, plant, axes = bank_of(motor=replace(WHEEL, inertia=1e3, friction=0.0))
    axes[0].switch_on()
    axes[0].regulator = 1
    axes[0].current_setting_ma = 5000
    errors = []
    for tick in range(8):
        bank.advance((tick + 1) * TICK)
        errors.append(5.0 - plant.outputs[0])
    for before, after in pairwise(errors):
        assert after == pytest.approx(before / 2, abs=0.1)


def test_the_current_loop_does_not_wind_up_at_the_voltage_limit() -> None:
    bank, plant, axes = bank_of(motor=replace(WHEEL, resistance=10.0, inertia=1e3, friction=0.0))
    axes[0].switch_on()
    axes[0].regulator = 1
    axes[0].current_setting_ma = 5000
    bank.advance(2 * MILLISECOND)
    bank.advance(100 * MILLISECOND)
    assert plant.outputs[0] == pytest.approx(2.16)
    axes[0].current_setting_ma = -2000
    bank.advance(185 * MILLISECOND)
    assert plant.outputs[0] == pytest.approx(-2.0, abs=0.1)


def test_a_wheel_follows_its_ramp_and_holds_its_speed() -> None:
    bank, plant, axes = bank_of()
    drive(axes[0], 2000)
    while bank.now < SECOND:
        bank.advance(min(SECOND, bank.now + MILLISECOND))
        ms = plant.steps_done * TICK / MILLISECOND
        wanted = min(2000.0, 6.6 * ms)
        assert plant.outputs[2] * 9.5493 == pytest.approx(wanted, abs=25)


def test_the_voltage_stays_below_nine_tenths_of_the_supply() -> None:
    bank, plant, axes = bank_of()
    drive(axes[0], 12_000)
    while bank.now < 2 * SECOND:
        bank.advance(2 * SECOND)
    assert plant.inputs[0] == pytest.approx(21.6)


def test_an_open_winding_carries_no_current_though_the_shaft_turns() -> None:
    bank, plant, axes = bank_of()
    drive(axes[0], 3000)
    while bank.now < SECOND:
        bank.advance(SECOND)
    axes[0].switch_off()
    while bank.now < SECOND + 40 * MILLISECOND:
        bank.advance(SECOND + 40 * MILLISECOND)
    for _ in range(400):
        bank.advance(bank.now + MILLISECOND)
        assert abs(plant.outputs[0]) < 0.03
    assert plant.outputs[2] * 9.5493 > 2000
    assert axes[0].back_emf / 2**24 == pytest.approx(WHEEL.torque_constant, rel=0.01)


@pytest.mark.parametrize(("reported", "near"), [(True, 0.001), (False, 0.03)])
def test_a_shaft_that_was_never_powered_turns_freely(near: float, *, reported: bool) -> None:
    bank, plant, axes = bank_of()
    if reported:
        set_winding(axes[0], WHEEL.torque_constant, WHEEL.resistance, WHEEL.inductance)
    plant.load[0] = 0.1
    while bank.now < SECOND:
        bank.advance(SECOND)
    assert abs(plant.outputs[0]) < 0.05
    # Free fall: 0.1 N m less friction on 2e-4 kg m2, against the damping.
    freely = (0.1 - WHEEL.friction) / WHEEL.damping * -expm1(-WHEEL.damping / WHEEL.inertia)
    assert plant.outputs[2] == pytest.approx(freely, rel=near)


def test_a_drive_without_power_applies_no_voltage_at_rest() -> None:
    bank, plant, _ = bank_of(4)
    for _ in range(100):
        bank.advance(bank.now + MILLISECOND)
        assert list(plant.inputs) == [0.0] * 4


def test_the_encoder_counts_whole_quadcounts_downwards() -> None:
    bank, plant, axes = bank_of()
    plant.outputs[1] = -1e-6
    bank.advance(TICK)
    assert axes[0].position == -1
    plant.outputs[1] = 6.2831854
    bank.advance(TICK * 11)
    assert axes[0].position == 2000


def test_the_supply_and_an_analog_input_come_from_the_plant() -> None:
    plant = DcMotors((WHEEL, WHEEL))
    axes = [ServoAxis("left", 2000), ServoAxis("right", 2000)]
    # The speed of the second motor stands in for a battery.
    plant.outputs[5] = 23.5
    bank = ServoBank(plant, axes, supply=5, analogue=("left", 6.0))
    bank.advance(TICK)
    assert [axis.supply_mv for axis in axes] == [23_500, 23_500]
    assert [axis.analogue_1_mv for axis in axes] == [3916, 0]


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_plant_that_breaks_down_is_named(bad: float) -> None:
    bank, plant, _ = bank_of()
    plant.outputs[1] = bad
    with pytest.raises(ServoError, match=r"not finite at 0\.0000 s"):
        bank.advance(MILLISECOND)


def test_two_runs_give_the_same_bits() -> None:
    def run() -> list[float]:
        bank, plant, axes = bank_of(2)
        drive(axes[0], 1234)
        drive(axes[1], -777)
        while bank.now < SECOND:
            bank.advance(SECOND)
        return list(plant.outputs)

    assert run() == run()
