"""A body on two driven wheels and two castors; README.md has the equations in mathematical writing."""

from typing import Final

import sympy as sp
from fmu.export.model import Input, Model, Output
from fmu.parts.battery import terminal_voltage
from fmu.parts.castor import Castor, CastorFriction
from fmu.parts.motor import Shaft
from fmu.parts.planar import PlanarBody
from fmu.parts.symbols import HALF, inner, symbols
from fmu.parts.wheel import DrivenWheel

from diff_drive.plant.parameters import LEFT, NAME, PARAMETERS, RIGHT

P: Final = symbols(PARAMETERS)
SIDES: Final = {"left": 1, "right": -1}


def model() -> Model:
    """Return the diff_drive's equations with all tables."""
    shafts = {"left": Shaft(LEFT, P), "right": Shaft(RIGHT, P)}
    mass, offset_mass = P["body_mass"] + 2 * P["wheel_mass"], P["body_mass"] * P["centre_offset"]
    body = PlanarBody(
        mass=mass,
        offset_mass=offset_mass,
        inertia=P["yaw_inertia"]
        + offset_mass * P["centre_offset"]
        + 2 * P["wheel_yaw_inertia"]
        + 2 * P["wheel_mass"] * (P["track"] / 2) ** 2,
        downhill=P["gravity"] * sp.sin(P["slope"]),
    )
    weight = P["gravity"] * sp.cos(P["slope"])
    castor_load = weight * offset_mass / P["castor_ahead"] * HALF
    wheel_load = weight * mass * HALF - castor_load
    wheels = [
        DrivenWheel(
            f"wheel_{side}",
            P,
            shafts[side],
            body,
            left=sign * P["track"] / 2,
            radius=P["wheel_radius"],
            spin_inertia=P["wheel_spin_inertia"],
            resistance=P["rolling_resistance"] * wheel_load * P["wheel_radius"],
        )
        for side, sign in SIDES.items()
    ]
    castors = [
        Castor(
            f"castor_{side}",
            body,
            CastorFriction(
                rolling=P["castor_resistance"] * castor_load,
                swivel=P["swivel_torque"],
                rolling_presliding=P["castor_rolling_way"],
                swivel_presliding=P["swivel_way"],
            ),
            ahead=P["castor_ahead"],
            left=sign * P["castor_track"] / 2,
            trail=P["castor_trail"],
        )
        for side, sign in SIDES.items()
    ]
    # What the wheels pull at the floor, the body's height turns into load: from the castors, or to them.
    pull = sum(wheel.tyre.spring_ahead for wheel in wheels)
    for wheel in wheels:
        wheel.tyre.bears(wheel_load + P["centre_height"] / P["castor_ahead"] * HALF * pull)
    energy = body.energy() + sum(shaft.energy() for shaft in shafts.values())
    energy += sum(wheel.energy() for wheel in wheels) + sum(castor.energy() for castor in castors)
    left, right = (wheel.rim for wheel in wheels)
    pushes = [*(wheel.push() for wheel in wheels), *(castor.push() for castor in castors)]
    return Model(
        name=NAME,
        description="Two driven wheels and two castors, two DC motors",
        parameters=PARAMETERS,
        inputs=tuple(Input(f"voltage_{axis}", "V", f"motor voltage, {axis}", 24.0) for axis in (LEFT, RIGHT)),
        states=(
            *(state for wheel in wheels for state in wheel.shaft.states(wheel.acceleration())),
            *body.states(pushes, ((left + right) * HALF, (right - left) / P["track"])),
            *(state for wheel in wheels for state in wheel.tyre.states((sp.S.Zero, sp.S.Zero), wheel_load)),
            *(state for castor in castors for state in castor.states()),
        ),
        outputs=(
            *(output for shaft in shafts.values() for output in shaft.outputs()),
            *body.outputs("axle's middle"),
            Output(
                "battery_voltage",
                "V",
                "battery's terminal voltage",
                terminal_voltage(shafts.values(), P),
                24.0,
                least=0.0,
            ),
            *(shaft.dry_friction() for shaft in shafts.values()),
            *(output for wheel in wheels for output in wheel.tyre.readings()),
            *(output for castor in castors for output in castor.readings()),
            inner("energy", "J", "energy stored in the whole robot", energy, 10.0),
        ),
        inner_step=100e-6,
    )
