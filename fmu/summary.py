"""Summary of a plant in a line: from its FMU where that is there, in no time, else from its equations."""

from collections import Counter
from dataclasses import dataclass

from fmu.build import ensure, is_built
from fmu.errors import PlantError
from fmu.loading import described
from fmu.plants import find


@dataclass(frozen=True, slots=True)
class Summary:
    """Number of each kind of variable; outputs without those that only the solver knows."""

    description: str
    states: int
    inputs: int
    outputs: int
    parameters: int


def summary(name: str) -> Summary:
    """Return what the installed plant of this name is; PlantError where it cannot be made."""
    if _is_here(name):
        found = described(ensure(name))
        counts = Counter(variable.causality for variable in found.modelVariables)
        states = found.numberOfContinuousStates
        return Summary(found.description, states, counts["input"], counts["output"], counts["parameter"])
    model = find(name).model()
    outputs = sum(not row.local for row in model.outputs)
    return Summary(model.description, len(model.states), len(model.inputs), outputs, len(model.parameters))


def _is_here(name: str) -> bool:
    try:
        return is_built(name)
    except PlantError:
        # No compiler, or a third party's mistake, which the equations report by themselves.
        return False
