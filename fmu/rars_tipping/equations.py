"""RARS that can tip over as one model: the parts of fmu/rars on a platform that lifts off its wheels.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018; the same equations in mathematical writing: README.md.
"""

from typing import Final

from fmu.export.model import Input, Model, Output
from fmu.parts.motor import Shaft
from fmu.parts.symbols import inner
from fmu.rars.equations import LEAST, NOMINAL
from fmu.rars.lift import Lift
from fmu.rars.readings import Readings, readings_of
from fmu.rars.steering import Steering
from fmu.rars_tipping import interface
from fmu.rars_tipping.parameters import PARAMETERS
from fmu.rars_tipping.platform import TippingPlatform
from fmu.rars_tipping.symbols import P

_NOMINAL: Final = {**NOMINAL, "N": 100.0, "1": 1.0}
_RATES: Final = {"roll_rate": 1.0, "pitch_rate": 1.0}


def model() -> Model:
    """Return the equations of motion with all tables."""
    left, right, steer, lift_motor = shafts = tuple(Shaft(axis, P) for axis in interface.AXES)
    steering, lift = Steering(steer), Lift(lift_motor)
    platform = TippingPlatform(left, right, steering, lift)
    # The order is that of the FMU's states: importers and the reference trajectories count on it.
    states = (
        *left.states(platform.shaft_acceleration("left"), platform.friction_start("left")),
        *right.states(platform.shaft_acceleration("right"), platform.friction_start("right")),
        *steer.states(steering.acceleration()),
        *lift_motor.states(lift.acceleration(), lift.friction_start()),
        *platform.states(),
    )
    energy = sum(shaft.energy() for shaft in shafts) + platform.energy() + steering.energy() + lift.energy()
    readings = readings_of(platform.body, steering, lift, shafts) | _standing(platform)
    local = [shaft.dry_friction() for shaft in shafts]
    for tyre in platform.tyres().values():
        local += [row for row in tyre.readings() if row.name not in readings]
    drift = platform.body.drift
    local.append(inner("drift", "m/s", "speed of the rear axle's middle to the left", drift, 0.1))
    local.append(inner("energy", "J", "energy stored in the whole robot", energy, 10.0))
    return Model(
        name="rars_tipping",
        description="RARS that can tip over: payload, any slope, wheel loads by the ZMP, roll and pitch",
        parameters=PARAMETERS,
        inputs=tuple(
            Input(name, unit, f"motor voltage, {name.removeprefix('voltage_')}", 24.0)
            for name, unit in interface.INPUTS.items()
        ),
        states=states,
        outputs=(*_outputs(readings), *local, *platform.sensed()),
        inner_step=100e-6,
        events=(*steering.events(), *lift.events(), *platform.events()),
    )


def _outputs(readings: Readings) -> tuple[Output, ...]:
    return tuple(
        Output(
            name,
            unit,
            readings[name][1],
            readings[name][0],
            _RATES.get(name, _NOMINAL[unit]),
            switch=name == interface.TIPPED,
            least=LEAST.get(name),
        )
        for name, unit in interface.OUTPUTS.items()
    )


def _standing(platform: TippingPlatform) -> Readings:
    """Return the readings of what it stands on."""
    readings: Readings = {
        f"load_{name}": (tyre.load, f"load of the wheel, {name.replace('_', ' ')}")
        for name, tyre in platform.tyres().items()
    }
    return readings | {
        "zmp_margin": (platform.margin(), "zero-moment point to the nearest edge, negative outside"),
        "roll": (platform.roll.angle, "roll from the slope's plane, left side up"),
        "pitch": (platform.pitch.angle, "pitch from the slope's plane, nose up"),
        "roll_rate": (platform.roll.rate, "roll rate, left side up"),
        "pitch_rate": (platform.pitch.rate, "pitch rate, nose up"),
        "centre_height": (platform.masses.height, "centre of mass over the floor, of the standing robot"),
        interface.TIPPED: (platform.tipped, "1 from the tip-over on, until reset"),
    }
