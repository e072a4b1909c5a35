"""RARS on four springs: heave, roll and pitch, loads by the springs, and a floor with a step, [R] 2.3.

A wheel rises as a disc over an edge: z = sqrt(r2 - d2) - (r - h) with the axle d before the edge; the edge
pushes back by the load times dz/dx. No wheel has mass; a wheel off the floor has no load, and turns free.
"""

from typing import Final

import sympy as sp

from fmu.export.functions import named, passed, positive_part, reciprocal, shared
from fmu.export.model import Event, Expression, Model, Output, StateVariable
from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import HALF, inner, symbol, symbols
from fmu.parts.tyre import Tyre
from fmu.rars.equations import model_of
from fmu.rars.platform import SIDES, Platform
from validation.plants.rars_sprung.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)
WAYS: Final = ("heave", "roll", "pitch")


class SwayingBody(PlanarBody):
    """A body whose floor lies Z_cg below its centre: pitch and roll move what touches it."""

    def velocity(self, ahead: Expression, left: Expression) -> tuple[Expression, Expression]:
        """Return the speed ahead and to the left of a contact."""
        forwards, sideways = super().velocity(ahead, left)
        height = P["cg_height"]
        return forwards + height * symbol("pitch_rate"), sideways + height * symbol("roll_rate")


class Corner:
    """A wheel on its spring: `ahead` and `left` of the rear axle's middle, which of both sides it is on."""

    def __init__(self, axle: str, side: str, platform: "SprungPlatform") -> None:
        self.name, body = f"{axle}_{side}", platform.body
        front = axle == "front"
        self.ahead = P["wheelbase"] if front else sp.S.Zero
        self.left = SIDES[side] * P[f"{axle}_track"] / 2
        self._from_centre = self.ahead - P["centre_offset"]
        radius, height = P["front_radius" if front else "wheel_radius"], P[f"step_{side}"]
        self._sine, self._cosine = shared(sp.sin(body.heading)), shared(sp.cos(body.heading))
        ahead = self.ahead + P["cg_height"] * symbol("pitch")
        x = symbol("x") + ahead * self._cosine - (self.left + P["cg_height"] * symbol("roll")) * self._sine
        contact = shared(sp.sqrt(radius**2 - (radius - height) ** 2))
        before = shared(positive_part(P["edge_x"] - x))
        self.meets = contact - before
        # The axle's way before the edge, at most where the wheel meets it; 0 on the step.
        on = shared(contact - positive_part(self.meets))
        root = shared(sp.sqrt(radius**2 - on**2))
        self.floor = root - (radius - height)
        self.steep = shared(on * reciprocal(root) * passed(self.meets))
        forwards, sideways = body.velocity(self.ahead, self.left)
        self._rising = self.steep * (forwards * self._cosine - sideways * self._sine)
        self.hangs = sp.S.Zero if front else P["wheel_mass"] * P["gravity"] * sp.cos(P["slope"])

    def load(self, standing: Expression) -> Expression:
        """Return what it pushes at the floor in N, by its load on the level."""
        return named(positive_part(self._pressed(standing) + P["spring_damping"] * self._closing()))

    def push(self, load: Expression) -> Push:
        """Return what the edge does to the platform: against x of the world."""
        ahead, left = -load * self.steep * self._cosine, load * self.steep * self._sine
        return Push(ahead, left, self.ahead * left - self.left * ahead)

    def turning(self, load: Expression) -> tuple[Expression, Expression, Expression]:
        """Return force up in N, moments left side up and nose up in N.m, on the body."""
        up = load - self.hangs
        return up, self.left * up, self._from_centre * up

    def energy(self, standing: Expression) -> Expression:
        """Return the energy of the spring, and of the wheel's weight on it, in J."""
        spring = HALF * positive_part(self._pressed(standing)) ** 2 / P["spring_stiffness"]
        return spring + self.hangs * self._risen()

    def _pressed(self, standing: Expression) -> Expression:
        return standing + P["spring_stiffness"] * (self.floor - self._risen())

    def _risen(self) -> Expression:
        heave, roll, pitch = map(symbol, WAYS)
        return heave + self.left * roll + self._from_centre * pitch

    def _closing(self) -> Expression:
        heave, roll, pitch = (symbol(f"{way}_rate") for way in WAYS)
        return self._rising - heave - self.left * roll - self._from_centre * pitch


class SprungPlatform(Platform):
    """RARS's platform, whose loads are those of its springs."""

    body_type = SwayingBody

    def tyres_by_name(self) -> dict[str, Tyre]:
        """Return all four by their names."""
        return {tyre.name: tyre for tyre in self.tyres()}

    def states(self) -> tuple[StateVariable, ...]:
        """Return those of the platform, and heave, roll and pitch; it starts as it stands on the level."""
        units = {"heave": "m", "roll": "rad", "pitch": "rad"}
        rows = [StateVariable(way, unit, sp.S.Zero, symbol(f"{way}_rate")) for way, unit in units.items()]
        rows += [
            StateVariable(f"{way}_rate", f"{unit}/s", sp.S.Zero, rate)
            for (way, unit), rate in zip(units.items(), self._rates(), strict=True)
        ]
        return (*super().states(), *rows)

    def pushes(self) -> list[Push]:
        """Return what the floor does to the platform, the step's edge included."""
        return [*super().pushes(), *(corner.push(self._loads[corner.name]) for corner in self._corners)]

    def readings(self) -> tuple[Output, ...]:
        """Return body and floor, for people and tests."""
        return (
            inner("heave", "m", "centre of mass over its standing height", symbol("heave"), 0.01),
            inner("roll", "rad", "roll, left side up", symbol("roll"), 0.1),
            inner("pitch", "rad", "pitch, nose up", symbol("pitch"), 0.1),
            *(
                inner(f"floor_{it.name}", "m", f"axle over the level, {it.name.replace('_', ' ')}", it.floor)
                for it in self._corners
            ),
        )

    def events(self) -> tuple[Event, ...]:
        """Return where a wheel meets the edge."""
        return tuple(
            Event(f"meets_{it.name}", "m", f"past the edge's touch, {it.name.replace('_', ' ')}", it.meets)
            for it in self._corners
        )

    def energy(self) -> Expression:
        """Return the platform's energy, its motion up and its springs included, in J."""
        heave, roll, pitch = (symbol(f"{way}_rate") for way in WAYS)
        moving = P["platform_mass"] * heave**2 + P["roll_inertia"] * roll**2 + P["pitch_inertia"] * pitch**2
        weight = P["platform_mass"] * P["gravity"] * sp.cos(P["slope"])
        springs = sum(corner.energy(self._standing(corner)) for corner in self._corners)
        return super().energy() + HALF * moving + weight * symbol("heave") + springs

    def _load_tyres(self) -> None:
        self._corners = [Corner(axle, side, self) for axle in ("rear", "front") for side in SIDES]
        self._loads = {corner.name: corner.load(self._standing(corner)) for corner in self._corners}
        for name, tyre in self.tyres_by_name().items():
            tyre.bears(self._loads[name])

    def _standing(self, corner: Corner) -> Expression:
        return self.rear_load if corner.name.startswith("rear") else self.front_load

    def _rates(self) -> tuple[Expression, Expression, Expression]:
        """Return heave, roll and pitch acceleration; forces at the floor act Z_cg below the centre."""
        weight = P["platform_mass"] * P["gravity"] * sp.cos(P["slope"])
        parts = [corner.turning(self._loads[corner.name]) for corner in self._corners]
        up, aside, along = (sum(part[place] for part in parts) for place in range(3))
        pushes = self.pushes()
        ahead, left = (sum(getattr(push, way) for push in pushes) for way in ("ahead", "left"))
        return (
            (up - weight) / P["platform_mass"],
            (aside + P["cg_height"] * left) / P["roll_inertia"],
            (along + P["cg_height"] * ahead) / P["pitch_inertia"],
        )


def model() -> Model:
    """Return the equations of motion with all tables."""
    return model_of("rars_sprung", "RARS on four springs, over a step", PARAMETERS, SprungPlatform)
