"""The variables of an FMU in the order of their value references, for both FMI versions."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fmu.export.blocks import ModelCode, UnsupportedError
from fmu.export.units import NEVER_NEGATIVE, UNITS, Unit, per_second

TIME: Final = 0
"""Value reference of the time."""

SWITCH: Final = "Switch"
"""Type of what is 0 open or 1 closed."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable as both FMI versions describe it; `rate_of` is the value reference of its state."""

    reference: int
    name: str
    unit: str
    description: str
    causality: str
    variability: str
    initial: str | None = None
    start: float | None = None
    nominal: float | None = None
    rate_of: int | None = None
    least: float | None = None
    most: float | None = None

    @property
    def type(self) -> str | None:
        """Return the name of the declared type; None for ratios and for rates that have no name."""
        unit = UNITS.get(self.unit)
        return SWITCH if self.variability == "discrete" else (unit.quantity or None) if unit else None


def variables(program: ModelCode) -> tuple[Variable, ...]:
    """Return time, inputs, parameters, outputs, locals, rates.

    UnsupportedError where a name comes twice, or a unit is not known.
    """
    model = program.model
    given = [(entry.name, entry.unit) for entry in model.inputs]
    given += [(entry.name, entry.unit) for entry in model.parameters]
    given += [(entry.name, entry.unit) for entry in model.states]
    given += [(entry.name, entry.unit) for entry in model.outputs]
    for name, unit in given:
        if unit not in UNITS:
            problem = f"'{name}' of {model.name} is in '{unit}', which is no unit that is known"
            raise UnsupportedError(f"{problem}; there are: {', '.join(UNITS)}")
    rows = tuple(_rows(program))
    twice = [name for name, count in Counter(row.name for row in rows).items() if count > 1]
    if twice:
        raise UnsupportedError(f"two variables of {program.model.name} are called '{twice[0]}'")
    return rows


def state_references(program: ModelCode) -> tuple[int, ...]:
    """Return the value reference of each state."""
    first = first_reading(program)
    states = program.states_of_readings
    return tuple(first + states.index(i) for i in range(len(program.model.states)))


def event_references(program: ModelCode) -> tuple[int, ...]:
    """Return the value reference of each event indicator."""
    names = [row.name for row in program.readings]
    return tuple(first_reading(program) + names.index(event.name) for event in program.model.events)


def first_reading(program: ModelCode) -> int:
    """Return the value reference of the first output."""
    return 1 + len(program.model.inputs) + len(program.model.parameters)


def units(program: ModelCode) -> dict[str, Unit]:
    """Return the units that the variables use, in the order of the table."""
    used = {row.unit for row in variables(program)}
    found = {name: unit for name, unit in UNITS.items() if name in used}
    for state in program.model.states:
        name, unit = per_second(state.unit)
        found.setdefault(name, unit)
    return found


def _rows(program: ModelCode) -> Iterator[Variable]:
    model = program.model
    yield Variable(TIME, "time", "s", "time", "independent", "continuous")
    reference = 0
    for entry in model.inputs:
        yield Variable(
            reference := reference + 1,
            entry.name,
            entry.unit,
            entry.description,
            "input",
            "discrete" if entry.switch else "continuous",
            start=0.0,
            nominal=entry.nominal,
            least=0.0 if entry.switch else None,
            most=1.0 if entry.switch else None,
        )
    for row in model.parameters:
        yield Variable(
            reference := reference + 1,
            row.name,
            row.unit,
            f"{row.description}. {row.source}",
            "parameter",
            "tunable" if row.tunable else "fixed",
            "exact",
            float(row.start),
            nominal=abs(row.start) or None,
            least=row.least if row.least is not None or row.unit not in NEVER_NEGATIVE else 0.0,
            most=row.most,
        )
    for reading, free in zip(program.readings, program.settable_states, strict=True):
        yield Variable(
            reference := reference + 1,
            reading.name,
            reading.unit,
            reading.description,
            "local" if reading.local else "output",
            "discrete" if reading.switch else "continuous",
            "calculated" if free < 0 else "exact",
            None if free < 0 else 0.0,
            reading.nominal,
            least=0.0 if reading.switch else reading.least,
            most=1.0 if reading.switch else None,
        )
    for state, shown in zip(model.states, state_references(program), strict=True):
        yield Variable(
            reference := reference + 1,
            f"der({state.name})",
            per_second(state.unit)[0],
            f"rate of {state.name}",
            "local",
            "continuous",
            "calculated",
            rate_of=shown,
        )
