"""RARS as one model: its parts joined, the table of outputs, the battery.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018; the same equations in mathematical writing: README.md.
"""

from collections.abc import Sequence

from fmu.export.model import Input, Model, Output, Parameter
from fmu.parts.motor import Shaft
from fmu.parts.symbols import inner
from fmu.rars import interface
from fmu.rars.lift import Lift
from fmu.rars.parameters import PARAMETERS
from fmu.rars.platform import Platform
from fmu.rars.readings import readings_of
from fmu.rars.steering import Steering
from fmu.rars.symbols import P

NOMINAL = {
    "V": 24.0,
    "A": 1.0,
    "rad": 1.0,
    "rad/s": 100.0,
    "m": 1.0,
    "m/s": 0.1,
}


LEAST = {"battery_voltage": 0.0}


def model() -> Model:
    """Return the equations of motion of RARS with all tables."""
    return model_of(
        "rars",
        "RARS: four wheels that slip, Davis steering, scissor lift, four DC motors",
        PARAMETERS,
        Platform,
    )


def model_of(name: str, description: str, parameters: Sequence[Parameter], made_of: type[Platform]) -> Model:
    """Return RARS on a platform of this kind, with these parameters."""
    left, right, steer, lift_motor = shafts = tuple(Shaft(axis, P) for axis in interface.AXES)
    steering = Steering(steer)
    platform = made_of(left, right, steering)
    lift = Lift(lift_motor)
    # The order is that of the FMU's states: importers and the reference trajectories count on it.
    states = (
        *left.states(platform.shaft_acceleration("left"), platform.friction_start("left")),
        *right.states(platform.shaft_acceleration("right"), platform.friction_start("right")),
        *steer.states(steering.acceleration()),
        *lift_motor.states(lift.acceleration(), lift.friction_start()),
        *platform.states(),
    )
    energy = sum(shaft.energy() for shaft in shafts) + platform.energy() + steering.energy() + lift.energy()
    readings = readings_of(platform.body, steering, lift, shafts)
    outputs = [
        Output(name, unit, readings[name][1], readings[name][0], NOMINAL[unit], least=LEAST.get(name))
        for name, unit in interface.OUTPUTS.items()
    ]
    local = [shaft.dry_friction() for shaft in shafts]
    for tyre in platform.tyres():
        local += tyre.readings()
    local.append(
        inner("drift", "m/s", "speed of the rear axle's middle to the left", platform.body.drift, 0.1)
    )
    local.append(inner("energy", "J", "energy stored in the whole robot", energy, 10.0))
    return Model(
        name=name,
        description=description,
        parameters=tuple(parameters),
        inputs=tuple(
            Input(name, unit, f"motor voltage, {name.removeprefix('voltage_')}", 24.0)
            for name, unit in interface.INPUTS.items()
        ),
        states=states,
        outputs=(*outputs, *local, *platform.readings()),
        inner_step=100e-6,
        events=(*steering.events(), *lift.events(), *platform.events()),
    )
