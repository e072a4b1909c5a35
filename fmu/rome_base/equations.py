"""Three omni wheels that roll without slip along their rims and whose rollers rub across, or spin in the air.

[O] is A. Seleit, MSc thesis, UCF, 2020; the same equations in mathematical writing: README.md.
"""

from collections.abc import Mapping
from typing import Final

import sympy as sp

from fmu.export.model import Expression, Input, Model, Output, StateVariable
from fmu.parts.battery import terminal_voltage
from fmu.parts.motor import Shaft, bristle
from fmu.parts.symbols import HALF, inner, symbol, symbols
from fmu.rome_base.parameters import AXES, PARAMETERS

P: Final = dict(symbols(PARAMETERS))
ANGLES: Final = tuple(sp.Rational(2 * i, 3) * sp.pi for i in range(3))
"""Angles of the wheels' positions, [O] 2.2."""


def rims(turn: Expression, distance: Expression) -> Expression:
    """Return P(psi) of (2.13): (rim speeds) = P (x', y', psi'); wheel i at `turn` + ANGLES[i].

    (2.9)-(2.11) corrected: p_i of (2.7) holds the wheel's angle already; turning it once more by R(psi +
    2 pi (i - 1) / 3) would exchange the wheels two and three.
    """
    return sp.Matrix([[-sp.sin(turn + angle), sp.cos(turn + angle), distance] for angle in ANGLES])


def inverse(turn: Expression, distance: Expression) -> Expression:
    """Return P^-1 of (2.14)."""
    along = [
        [-sp.sin(turn + angle) * 2 / 3 for angle in ANGLES],
        [sp.cos(turn + angle) * 2 / 3 for angle in ANGLES],
    ]
    return sp.Matrix([*along, [1 / (3 * distance)] * 3])


class Base:
    """The body in its own frame: u forwards, q to the left, W counter-clockwise; forces from the wheels.

    `carried` is the mass that stands on it and is not its own, kg.
    """

    def __init__(self, shafts: tuple[Shaft, ...], carried: Expression = sp.S.Zero) -> None:
        self.shafts = shafts
        self.heading = symbol("heading")
        self.rims = rims(sp.S.Zero, P["wheel_distance"])
        rolled = sp.Matrix([P["wheel_radius"] * shaft.speed / shaft.gear for shaft in shafts])
        self.creep = sp.Matrix([symbol(f"creep_{shaft.axis}") for shaft in shafts])
        self.rests = [1 - symbol(f"lifted_{shaft.axis}") for shaft in shafts]
        # A rim in the air runs ahead of the floor by its creep.
        self.velocity = inverse(sp.S.Zero, P["wheel_distance"]) * (rolled - self.creep)
        gear, rotor = P["gear_wheel"], P["rotor_inertia_wheel"]
        # Wheel and rotor as a mass at the rim: their inertia over the radius squared.
        self.rim_mass = (P["wheel_inertia"] + rotor * gear**2) / P["wheel_radius"] ** 2
        self.load = (P["mass"] + carried) * P["gravity"] / 3 * P["roller_friction"]
        self.drive = sp.Matrix([shaft.torque * shaft.gear / P["wheel_radius"] for shaft in shafts])

    def across(self, wheel: int) -> Expression:
        """Return the speed of a wheel's rollers, outwards: a turn of the base does not turn them."""
        u, q, _ = self.velocity
        return u * sp.cos(ANGLES[wheel]) + q * sp.sin(ANGLES[wheel])

    def rubbing(self, wheel: int) -> Expression:
        """Return the rollers' friction in N, outwards."""
        dry = self.load * symbol(f"roller_{self.shafts[wheel].axis}")
        return -self.rests[wheel] * (dry + P["roller_viscous"] * self.across(wheel))

    def slowing(self) -> tuple[Expression, ...]:
        """Return how fast each rim that touches the floor becomes as fast as it is, m/s2."""
        return tuple(
            down * creep / P["touch_down"] for down, creep in zip(self.rests, self.creep, strict=True)
        )

    def change(self) -> Expression:
        """Return the body's accelerations.

        (M + P' j P) v' + W x M v = P' (forces at the rims) + rollers, with P constant in the body's frame;
        a wheel in the air has no part in the sums over the wheels.
        """
        return self._solved(self.force())

    def inertia(self) -> Expression:
        """Return M + P' j P."""
        found = sp.diag(P["mass"], P["mass"], P["yaw_inertia"])
        for wheel, rest in enumerate(self.rests):
            found += rest * self.rim_mass * self.rims.row(wheel).T * self.rims.row(wheel)
        return found

    def force(self) -> Expression:
        """Return what moves the body, N and N m, with what its turning takes of it."""
        u, q, yaw_rate = self.velocity
        pulls = self.drive + self.rim_mass * sp.Matrix(self.slowing())
        pulls = sp.Matrix([down * pull for down, pull in zip(self.rests, pulls, strict=True)])
        # The last term: u and q are those of a frame that turns with the body.
        force = self.rims.T * pulls + P["mass"] * yaw_rate * sp.Matrix([q, -u, 0])
        for wheel, angle in enumerate(ANGLES):
            force += self.rubbing(wheel) * sp.Matrix([sp.cos(angle), sp.sin(angle), 0])
        return force

    def _solved(self, force: Expression) -> Expression:
        """Return force over mass: with all wheels on the floor, less those in the air (Sherman, Morrison)."""
        # P' P = diag(3/2, 3/2, 3 L2), for the wheels are alike.
        mass = P["mass"] + self.rim_mass * 3 / 2
        turning = P["yaw_inertia"] + 3 * P["wheel_distance"] ** 2 * self.rim_mass
        rows = [self.rims.row(wheel) for wheel in range(3)]
        found = [sp.Matrix([it[0] / mass, it[1] / mass, it[2] / turning]) for it in (force, *rows)]
        for wheel, row in enumerate(rows):
            # The wheel's share of the mass is taken out again, as far as it is in the air.
            less = (1 - self.rests[wheel]) * self.rim_mass
            share = less / (1 - less * (row * found[wheel + 1])[0])
            way = found[wheel + 1]
            found = [it + share * (row * it)[0] * way for it in found]
        return found[0]

    def accelerations(self, rims: Expression) -> tuple[Expression, ...]:
        """Return the motors' accelerations, where the floor under the rims has these, in m/s2."""
        return tuple(
            shaft.gear / P["wheel_radius"] * (rims[wheel] + self.creeping(wheel, rims))
            for wheel, shaft in enumerate(self.shafts)
        )

    def creeping(self, wheel: int, rims: Expression) -> Expression:
        """Return by how much a rim gains on the floor, m/s2: in the air it is its motor's alone."""
        alone = self.drive[wheel] / self.rim_mass - rims[wheel]
        return (1 - self.rests[wheel]) * alone - self.slowing()[wheel]

    def states(self, rims: Expression) -> tuple[StateVariable, ...]:
        """Return pose, rollers, and what the rims are ahead of the floor."""
        u, q, yaw_rate = self.velocity
        sine, cosine = sp.sin(self.heading), sp.cos(self.heading)
        rollers = (
            StateVariable(
                f"roller_{shaft.axis}",
                "1",
                sp.S.Zero,
                bristle(self.across(wheel), symbol(f"roller_{shaft.axis}"), P["roller_presliding"]),
            )
            for wheel, shaft in enumerate(self.shafts)
        )
        creeps = (
            StateVariable(f"creep_{shaft.axis}", "m/s", sp.S.Zero, self.creeping(wheel, rims))
            for wheel, shaft in enumerate(self.shafts)
        )
        return (
            StateVariable("x", "m", sp.S.Zero, u * cosine - q * sine),
            StateVariable("y", "m", sp.S.Zero, u * sine + q * cosine),
            StateVariable("heading", "rad", sp.S.Zero, yaw_rate),
            *rollers,
            *creeps,
        )

    def energy(self) -> Expression:
        """Return the energy of body, wheels and rollers in J; the rotors' own is the shafts'."""
        u, q, yaw_rate = self.velocity
        moving = P["mass"] * (u**2 + q**2) + P["yaw_inertia"] * yaw_rate**2
        spin = sum(P["wheel_inertia"] * (shaft.speed / shaft.gear) ** 2 for shaft in self.shafts)
        dry = sum(symbol(f"roller_{shaft.axis}") ** 2 for shaft in self.shafts)
        return HALF * (moving + spin + self.load * P["roller_presliding"] * dry)


def shafts() -> tuple[Shaft, ...]:
    """Return the motors' shafts; what holds a wheel rubs as its own dry friction does."""
    wheel = {name.removesuffix("wheel"): value for name, value in P.items() if name.endswith("_wheel")}
    return tuple(_shaft(axis, wheel) for axis in AXES)


def _shaft(axis: str, wheel: Mapping[str, Expression]) -> Shaft:
    held = {f"coulomb_{axis}": wheel["coulomb_"] + symbol(f"held_{axis}") / wheel["gear_"]}
    return Shaft(axis, P | {name + axis: value for name, value in wheel.items()} | held)


def motors(base: Base, on_floor: Expression) -> tuple[StateVariable, ...]:
    """Return the motors; `on_floor` are the accelerations of the floor under the rims, m/s2."""
    rates = zip(base.shafts, base.accelerations(on_floor), strict=True)
    return tuple(state for shaft, rate in rates for state in shaft.states(rate))


def inputs() -> tuple[Input, ...]:
    """Return the motors' voltages, and what may be wrong with the wheels."""
    return (
        *(Input(f"voltage_{axis}", "V", f"motor voltage, wheel {axis}", 12.0) for axis in AXES),
        *(Input(f"held_{axis}", "N.m", f"what holds wheel {axis} by rubbing", 1.0) for axis in AXES),
        *(Input(f"lifted_{axis}", "1", f"1 where wheel {axis} is in the air", 1.0) for axis in AXES),
    )


def outputs(base: Base) -> tuple[Output, ...]:
    """Return what drives, encoders and eyes see."""
    u, q, yaw_rate = base.velocity
    return (
        *(row for shaft in base.shafts for row in shaft.outputs()),
        Output("x", "m", "base's middle, world x", symbol("x"), 1.0),
        Output("y", "m", "base's middle, world y", symbol("y"), 1.0),
        Output("heading", "rad", "heading, counter-clockwise from world x", base.heading, 1.0),
        Output("speed", "m/s", "speed forwards, along the base's own x", u, 0.1),
        Output("speed_sideways", "m/s", "speed to the left, along the base's own y", q, 0.1),
        Output("yaw_rate", "rad/s", "yaw rate, counter-clockwise", yaw_rate, 1.0),
        Output(
            "battery_voltage",
            "V",
            "battery's terminal voltage",
            terminal_voltage(base.shafts, P),
            12.0,
            least=0.0,
        ),
        *(shaft.dry_friction() for shaft in base.shafts),
        *(
            inner(
                f"roller_{axis}",
                "1",
                f"rollers' dry friction over its level, {axis}",
                symbol(f"roller_{axis}"),
            )
            for axis in AXES
        ),
    )


def model() -> Model:
    """Return the equations of motion of the base with all tables."""
    base = Base(shafts())
    on_floor = base.rims * base.change()
    energy = sum((shaft.energy() for shaft in base.shafts), base.energy())
    return Model(
        name="rome_base",
        description="ROME's base: three omni wheels on DC motors",
        parameters=PARAMETERS,
        inputs=inputs(),
        states=(*motors(base, on_floor), *base.states(on_floor)),
        outputs=(*outputs(base), inner("energy", "J", "energy stored in the whole base", energy, 10.0)),
        inner_step=50e-6,
    )
