"""The arm's links and the base move each other: one mass matrix of three ways and six joints; README.md.

The arm's foot stands at the base's middle, upright, and the base stays level on its wheels, whose loads show
when it would not.
"""

from collections.abc import Sequence
from typing import Any, Final

import sympy as sp

from fmu.ar2 import equations as arms
from fmu.ar2.equations import Arm, Ground, line, lines, solved
from fmu.ar2.parameters import AXES
from fmu.export.model import Expression, Model, Output
from fmu.parts.symbols import inner, symbol, symbols
from fmu.rome_arm.parameters import PARAMETERS
from fmu.rome_base import equations as bases
from fmu.rome_base.equations import ANGLES, Base
from fmu.rome_base.parameters import AXES as WHEELS

P: Final = dict(symbols(PARAMETERS))
LINKS: Final = (*(P[f"mass_{axis}"] for axis in AXES), P["payload"])


class Rome:
    """The base with the arm on it."""

    def __init__(self) -> None:
        self.base: Final = Base(bases.shafts(), carried=sum(LINKS))
        # Lines of their own first: every link uses them, and SymPy would write them out each time.
        self.base.velocity = lines(self.base.velocity)
        self.arm: Final = Arm(Ground(*self.base.velocity))
        self.links: Final = self.arm.inertia()
        pushed = self.base.force()
        pulled = (*pushed, *map(arms.torque, AXES))
        forces = [line(it - load) for it, load in zip(pulled, self.arm.loads(), strict=True)]
        self.rates: Final = solved(self._inertia(), forces)

    def _inertia(self) -> list[list[Expression]]:
        """Return the lower half of the mass matrix: of the base, and of what stands on it."""
        own, found = self.base.inertia(), [list(row) for row in self.links]
        for row in range(self.arm.first):
            # The arm's matrix begins with the ground's three
            # speeds, the base's own: both inertias add up there.
            for column in range(row + 1):
                found[row][column] = line(found[row][column] + own[row, column])
        return found

    def energy(self) -> Expression:
        """Return all that is stored, J."""
        shafts = sum((shaft.energy() for shaft in self.base.shafts), self.base.energy())
        return shafts + self.arm.energy(self.links) + arms.bent()

    def loads(self) -> Sequence[Expression]:
        """Return what each wheel carries, N; below 0 it would be lifted.

        From where weight and all that is accelerated meet the floor, for the base stays level.
        """
        turn = (*self.base.velocity,)[2]
        ahead, left, _ = self.base.velocity
        rates = self.rates[: self.arm.first]
        swing = lines(self.arm.in_frame(rates[0] - turn * left, rates[1] + turn * ahead))
        pressed = P["mass"] * P["gravity"]
        tilting = -P["mass"] * P["mass_height"] * swing
        for mass, point, own, columns in zip(
            LINKS, self.arm.points, self.arm.swings, self.arm.columns, strict=True
        ):
            felt = lines(
                own
                + sum(
                    (column * rate for column, rate in zip(columns, self.rates, strict=False)), sp.zeros(3, 1)
                )
            )
            down = line(mass * (felt[2] + P["gravity"]))
            pressed = line(pressed + down)
            tilting = lines(tilting + down * point - mass * (point[2] + P["foot_height"]) * felt)
        cosine, sine = self.arm.turned
        ways = lines(
            sp.Matrix([tilting[0] * cosine - tilting[1] * sine, tilting[0] * sine + tilting[1] * cosine])
        )
        return [
            pressed / 3
            + sp.Rational(2, 3) / P["wheel_distance"] * (ways[0] * sp.cos(angle) + ways[1] * sp.sin(angle))
            for angle in ANGLES
        ]

    def outputs(self) -> tuple[Output, ...]:
        """Return the tool in the world, and what the wheels carry."""
        x, y, z = self.arm.origins[-1]
        turned = symbol(f"angle_{AXES[0]}") + self.base.heading
        velocity: Any = sum(
            (column * speed for column, speed in zip(self.arm.columns[-1], self.arm.speeds, strict=True)),
            sp.zeros(3, 1),
        )
        return (
            Output("tool_x", "m", "tool, world x", symbol("x") + x * sp.cos(turned) - y * sp.sin(turned)),
            Output("tool_y", "m", "tool, world y", symbol("y") + x * sp.sin(turned) + y * sp.cos(turned)),
            Output("tool_z", "m", "tool, above the floor", z + P["foot_height"]),
            Output("tool_speed", "m/s", "tool, how fast it moves", sp.sqrt(velocity.dot(velocity))),
            *(
                Output(f"load_{axis}", "N", f"what wheel {axis} carries", load, 50.0)
                for axis, load in zip(WHEELS, self.loads(), strict=True)
            ),
            inner("energy", "J", "energy stored in base and arm", self.energy(), 10.0),
        )


def model() -> Model:
    """Return the equations of motion of base and arm with all tables."""
    rome = Rome()
    on_floor = rome.base.rims * sp.Matrix(rome.rates[: rome.arm.first])
    return Model(
        name="rome_arm",
        description="ROME: the arm AR2 on a base on three omni wheels",
        parameters=PARAMETERS,
        inputs=(*bases.inputs(), *arms.inputs()),
        states=(
            *bases.motors(rome.base, on_floor),
            *rome.base.states(on_floor),
            *arms.states(rome.rates[rome.arm.first :]),
        ),
        outputs=(*bases.outputs(rome.base), *arms.outputs(), *rome.outputs()),
        inner_step=50e-6,
    )
