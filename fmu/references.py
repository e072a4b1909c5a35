"""Names to value references of an FMU, with clear words where a variable is missing or is another one."""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from fmu.errors import PlantError
from fmu.export.units import UNITS as SI

_REAL: Final = frozenset({"Real", "Float64"})
_BASES: Final = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of an FMU: its unit is None, and its description empty, where the FMU lacks them."""

    name: str
    causality: str
    unit: str | None
    description: str
    start: str = ""
    """Its start value as the FMU writes it; empty where it has none."""


class References:
    """The variables of one model description, as FMPy reads it."""

    def __init__(self, file: str, description: Any) -> None:
        self._file = file
        self._variables = {variable.name: variable for variable in description.modelVariables}
        self._units = {unit.name: unit for unit in description.unitDefinitions}

    def find(self, names: Sequence[str], causalities: Sequence[str], units: Mapping[str, str]) -> list[int]:
        """Return the value references of real variables of these causalities, checked against `units`."""
        return [self._reference(name, causalities, units.get(name)) for name in names]

    def present(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return those of the names that are variables here, in their order."""
        return tuple(name for name in names if name in self._variables)

    def described(self) -> tuple[Variable, ...]:
        """Return all real variables, as a master may ask for them."""
        return tuple(
            Variable(
                name,
                str(variable.causality),
                _unit(variable),
                str(variable.description or ""),
                str(variable.start or ""),
            )
            for name, variable in self._variables.items()
            if variable.type in _REAL
        )

    def any(self, name: str) -> tuple[int, str]:
        """Return value reference and type of any variable."""
        variable = self._variable(name, "variable")
        return int(variable.valueReference), str(variable.type)

    def tunable(self) -> tuple[str, ...]:
        """Return the real parameters that a master may change while it steps (FMI: variability tunable)."""
        return tuple(
            name
            for name, variable in self._variables.items()
            if variable.type in _REAL
            and (variable.causality, variable.variability) == ("parameter", "tunable")
        )

    def settable(self, names: Iterable[str]) -> list[int]:
        """Return the value references of parameters, or of variables with a start value."""
        found = []
        for name in names:
            variable = self._variable(name, "parameter")
            if variable.causality not in {"parameter", "structuralParameter"} and variable.initial != "exact":
                kind = variable.causality
                raise PlantError(f"{self._file}: '{name}' is no parameter, but a computed {kind} value")
            found.append(self._checked_type(name, variable))
        return found

    def _reference(self, name: str, causalities: Sequence[str], unit: str | None) -> int:
        variable = self._variable(name, causalities[0])
        if variable.causality not in causalities:
            raise PlantError(
                f"{self._file}: '{name}' has causality '{variable.causality}',"
                f" but the plant's {causalities[0]} was expected"
            )
        self._check_unit(name, variable, unit)
        return self._checked_type(name, variable)

    def _variable(self, name: str, kind: str) -> Any:
        variable = self._variables.get(name)
        if variable is not None:
            return variable
        near = difflib.get_close_matches(name, self._variables, n=1)
        hint = f"; the nearest name is '{near[0]}'" if near else ""
        hint += "; `firmware-bridge fmu show` lists what it has" if kind == "parameter" else ""
        raise PlantError(f"{self._file}: the FMU lacks the {kind} '{name}'{hint}")

    def _checked_type(self, name: str, variable: Any) -> int:
        if variable.type not in _REAL or getattr(variable, "dimensions", None):
            raise PlantError(
                f"{self._file}: '{name}' must be one real number, but it is of type {variable.type}"
            )
        return int(variable.valueReference)

    def _check_unit(self, name: str, variable: Any, expected: str | None) -> None:
        declared = _unit(variable)
        # Many tools write no units: then there is nothing to compare.
        if expected is None or declared is None or declared == expected:
            return
        unit = self._units.get(declared)
        base = getattr(unit, "baseUnit", None)
        if base is not None:
            exponents = {key: int(getattr(base, key) or 0) for key in _BASES if getattr(base, key)}
            factor, offset = float(base.factor or 1.0), float(base.offset or 0.0)
            # Another spelling of the same SI unit is accepted; a factor or an offset is not.
            if exponents == SI[expected].exponents() and (factor, offset) == (1.0, 0.0):
                return
        raise PlantError(f"{self._file}: '{name}' is in '{declared}', but '{expected}' was expected")


def _unit(variable: Any) -> str | None:
    unit = variable.unit
    if unit is None and variable.declaredType is not None:
        unit = variable.declaredType.unit
    return None if unit is None else str(unit)
