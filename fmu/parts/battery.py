"""A battery with inner resistance under the power of all motors."""

from collections.abc import Iterable, Mapping

import sympy as sp

from fmu.export.functions import positive_part
from fmu.export.model import Expression
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF


def terminal_voltage(shafts: Iterable[Shaft], parameters: Mapping[str, Expression]) -> Expression:
    """Return the terminal voltage V with V = E - R I and V I = the motors' power; E / 2 where none fits."""
    power = sum((shaft.voltage * shaft.current for shaft in shafts), sp.S.Zero)
    emf = parameters["battery_emf"]
    # V^2 - E V + R P = 0: of both roots the upper one is the working point, the lower one the collapse.
    root = emf**2 - 4 * parameters["battery_resistance"] * power
    return (emf + sp.sqrt(positive_part(root))) * HALF
