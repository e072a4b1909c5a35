"""RARS as one model: its parts joined, the table of outputs, the battery.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018; the same equations in mathematical writing: README.md.
"""

import sympy as sp

from fmu import interface
from fmu.export.functions import positive_part
from fmu.export.model import Expression, Input, Model, Output
from fmu.rars.lift import Lift
from fmu.rars.parameters import PARAMETERS
from fmu.rars.platform import LEFT, RIGHT, Platform
from fmu.rars.shaft import HALF, P, Shaft
from fmu.rars.steering import Steering

NOMINAL = {
    "V": 24.0,
    "A": 1.0,
    "rad": 1.0,
    "rad/s": 100.0,
    "m": 1.0,
    "m/s": 0.1,
}


def model() -> Model:
    """Return the equations of motion of RARS with all tables."""
    left, right, steer, lift_motor = shafts = tuple(Shaft(axis) for axis in interface.AXES)
    steering = Steering(steer)
    platform = Platform(left, right, steering)
    lift = Lift(lift_motor)
    left_rate, right_rate = platform.accelerations()
    states = (
        *left.states(left_rate),
        *right.states(right_rate),
        *steer.states(steering.acceleration()),
        *lift_motor.states(lift.acceleration(), lift.friction_start()),
        *platform.states(),
    )
    energy = sum(shaft.energy() for shaft in shafts) + platform.energy() + steering.energy() + lift.energy()
    readings: dict[str, tuple[Expression, str]] = {
        "x": (sp.Symbol("x", real=True), "rear axle's middle, world x"),
        "y": (sp.Symbol("y", real=True), "rear axle's middle, world y"),
        "heading": (sp.Symbol("heading", real=True), "heading, counter-clockwise from world x"),
        "speed": (platform.speed, "speed of the rear axle's middle, forwards"),
        "yaw_rate": (platform.yaw_rate, "yaw rate, counter-clockwise"),
        "rack": (steering.rack, "rack, positive steers left"),
        "steer_left": (steering.angle(LEFT), "left front wheel's angle, positive to the left"),
        "steer_right": (steering.angle(RIGHT), "right front wheel's angle, positive to the left"),
        "steer": (steering.inner_angle(), "inner front wheel's angle, positive to the left"),
        "lift_height": (lift.height, "lift above its collapsed height"),
        "battery_voltage": (_battery(shafts), "battery's terminal voltage"),
    }
    for shaft in shafts:
        readings[f"current_{shaft.axis}"] = (shaft.current, f"motor current, {shaft.axis}")
        readings[f"angle_{shaft.axis}"] = (shaft.angle, f"motor shaft's angle, {shaft.axis}")
        readings[f"speed_{shaft.axis}"] = (shaft.speed, f"motor shaft's speed, {shaft.axis}")
    outputs = [
        Output(name, unit, readings[name][1], readings[name][0], NOMINAL[unit])
        for name, unit in interface.OUTPUTS.items()
    ]
    inner = (
        *(
            _inner(f"friction_{s.axis}", "1", f"dry friction over its level, {s.axis}", s.friction, 1.0)
            for s in shafts
        ),
        _inner("slip_left", "rad", "left front wheel's slip angle", platform.slip_angle(LEFT), 0.1),
        _inner("slip_right", "rad", "right front wheel's slip angle", platform.slip_angle(RIGHT), 0.1),
        _inner("force_left", "N", "left front tyre's side force", platform.side_force(LEFT), 10.0),
        _inner("force_right", "N", "right front tyre's side force", platform.side_force(RIGHT), 10.0),
        _inner("energy", "J", "energy stored in the whole robot", energy, 10.0),
    )
    return Model(
        name="rars",
        description="RARS: two driven rear wheels, Davis steering, scissor lift, four DC motors",
        parameters=PARAMETERS,
        inputs=tuple(
            Input(name, unit, f"motor voltage, {name.removeprefix('voltage_')}", 24.0)
            for name, unit in interface.INPUTS.items()
        ),
        states=states,
        outputs=(*outputs, *inner),
        inner_step=50e-6,
    )


def _inner(name: str, unit: str, description: str, expression: Expression, nominal: float) -> Output:
    return Output(name, unit, description, expression, nominal, local=True)


def _battery(shafts: tuple[Shaft, ...]) -> Expression:
    """Return the terminal voltage V with V = E - R I and V I = the motors' power; E / 2 where none fits."""
    power = sum((shaft.voltage * shaft.current for shaft in shafts), sp.S.Zero)
    emf = P["battery_emf"]
    root = emf**2 - 4 * P["battery_resistance"] * power
    return (emf + sp.sqrt(positive_part(root))) * HALF
