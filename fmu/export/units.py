"""The units that models may use, by their SI exponents."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit by its SI exponents (FMI 2.0.4 section 2.2.2, FMI 3.0.2 section 2.4.3), and what it measures.

    The `quantity` is the name of the type that its variables have, as Modelica.Units.SI calls it.
    """

    kg: int = 0
    m: int = 0
    s: int = 0
    A: int = 0
    rad: int = 0
    quantity: str = ""

    def exponents(self) -> dict[str, int]:
        """Return the exponents that are not zero."""
        every = {"kg": self.kg, "m": self.m, "s": self.s, "A": self.A, "rad": self.rad}
        return {base: power for base, power in every.items() if power}


UNITS: Final[Mapping[str, Unit]] = {
    "1": Unit(),
    "s": Unit(s=1, quantity="Time"),
    "m": Unit(m=1, quantity="Length"),
    "m/s": Unit(m=1, s=-1, quantity="Velocity"),
    "m/s2": Unit(m=1, s=-2, quantity="Acceleration"),
    "s/m": Unit(m=-1, s=1),
    "rad": Unit(rad=1, quantity="Angle"),
    "rad/s": Unit(rad=1, s=-1, quantity="AngularVelocity"),
    "rad/s2": Unit(rad=1, s=-2, quantity="AngularAcceleration"),
    "kg": Unit(kg=1, quantity="Mass"),
    "kg.m2": Unit(kg=1, m=2, quantity="MomentOfInertia"),
    "N": Unit(kg=1, m=1, s=-2, quantity="Force"),
    "N/m": Unit(kg=1, s=-2, quantity="TranslationalSpringConstant"),
    "N.m": Unit(kg=1, m=2, s=-2, quantity="Torque"),
    "N.m.s/rad": Unit(kg=1, m=2, s=-1, rad=-1, quantity="RotationalDampingConstant"),
    "N.m/rad": Unit(kg=1, m=2, s=-2, rad=-1, quantity="RotationalSpringConstant"),
    "N.s/m": Unit(kg=1, s=-1, quantity="TranslationalDampingConstant"),
    "s/rad": Unit(s=1, rad=-1),
    "N.m/A": Unit(kg=1, m=2, s=-2, A=-1, quantity="ElectricalTorqueConstant"),
    "J": Unit(kg=1, m=2, s=-2, quantity="Energy"),
    "W": Unit(kg=1, m=2, s=-3, quantity="Power"),
    "A": Unit(A=1, quantity="Current"),
    "V": Unit(kg=1, m=2, s=-3, A=-1, quantity="Voltage"),
    "Ohm": Unit(kg=1, m=2, s=-3, A=-2, quantity="Resistance"),
    "H": Unit(kg=1, m=2, s=-2, A=-2, quantity="Inductance"),
}
"""Units that models may use."""


NEVER_NEGATIVE: Final = frozenset({
    "kg", "kg.m2", "N/m", "N.m.s/rad", "N.m/rad", "N.s/m", "s/m", "s/rad", "N.m/A", "Ohm", "H", "s",
})  # fmt: skip
"""Units of masses, stiffnesses, dampings, windings: a parameter in one of them is 0 or more."""


def per_second(name: str) -> tuple[str, Unit]:
    """Return the unit of the rate of a quantity in this unit: its name and its exponents."""
    unit = UNITS[name]
    written = name.removesuffix("/s") + "/s2" if name.endswith("/s") else f"{name}/s"
    return written, UNITS.get(written) or replace(unit, s=unit.s - 1, quantity="")
