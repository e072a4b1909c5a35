"""Any model of ours on a bench of its own: runs by input name, readings by name, rates without C."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Self

import sympy as sp

from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from fmu.build import ensure
from fmu.export.model import Model
from fmu.plant import FmuPlant

NOTHING: Mapping[str, float] = MappingProxyType({})


class ModelBench:
    """A plant with all of its outputs by name; close it, or use it in a `with`."""

    def __init__(
        self,
        model: Model,
        parameters: Mapping[str, float] = NOTHING,
        *,
        fmi: int = 3,
        step: Nanoseconds = 100 * MICROSECOND,
    ) -> None:
        self.step = step
        self.names = [row.name for row in model.inputs]
        self.outputs = [row.name for row in model.outputs if not row.local]
        units = {row.name: row.unit for row in model.inputs} | {row.name: row.unit for row in model.outputs}
        self.plant = FmuPlant(
            ensure(model.name, fmi), self.names, self.outputs, parameters, step, units=units
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.plant.close()

    def runs(self, seconds: float, **inputs: float) -> dict[str, float]:
        """Hold these inputs (others 0) for this time; return the outputs."""
        for i, name in enumerate(self.names):
            self.plant.inputs[i] = inputs.get(name.removeprefix("voltage_"), 0.0)
        step = self.plant.step
        for _ in range(round(seconds * SECOND / self.step)):
            step()
        return self.now()

    def now(self) -> dict[str, float]:
        return dict(zip(self.outputs, self.plant.outputs, strict=True))

    def energy(self) -> float:
        return self.plant.read("energy")


OWN = {
    "positive_part": lambda x: max(x, 0.0),
    "clamped": lambda x, bound: max(-bound, min(bound, x)),
    "larger": max,
    "size": abs,
    "shared": lambda x: x,
    "named": lambda x: x,
    "angle": math.atan2,
    "step_at": lambda x: float(x > 0),
    "reciprocal": lambda x: 1 / x,
}


_RATES: dict[str, Callable[..., list[float]]] = {}
"""Functions by the model's name: one function serves all parameters."""


def evaluator(model: Model, expressions: Mapping[str, Any]) -> Callable[..., list[float]]:
    """Return a Python function of the model's parameters, states and inputs that evaluates these expressions.

    Their parts are shared before SymPy turns to them: written out they have two million nodes.
    """
    names = [row.name for row in model.parameters]
    names += [row.name for row in model.states] + [row.name for row in model.inputs]
    shared, short = sp.cse([sp.sympify(each) for each in expressions.values()], order="none")
    made: Callable[..., list[float]] = sp.lambdify(
        [sp.Symbol(name, real=True) for name in names], short, [OWN, "math"], cse=lambda _: (shared, short)
    )
    return made


def formula(
    model: Model,
    expressions: Mapping[str, Any],
    parameters: Mapping[str, float] = NOTHING,
    function: Callable[..., list[float]] | None = None,
) -> Any:
    """Return a Python function of states and inputs (by name, others 0) that evaluates these expressions."""
    assert set(parameters) <= {row.name for row in model.parameters}
    fixed = [parameters.get(row.name, row.start) for row in model.parameters]
    names = [*(row.name for row in model.states), *(row.name for row in model.inputs)]
    of_all = function or evaluator(model, expressions)

    def evaluate(**given: float) -> dict[str, float]:
        assert set(given) <= set(names)
        found = of_all(*fixed, *(given.get(name, 0.0) for name in names))
        return dict(zip(expressions, found, strict=True))

    return evaluate


def rates(model: Model, parameters: Mapping[str, float] = NOTHING) -> Any:
    """Return a function of states and inputs (by name, others 0) that gives the rate of every state."""
    expressions = {state.name: state.rate for state in model.states}
    if model.name not in _RATES:
        _RATES[model.name] = evaluator(model, expressions)
    return formula(model, expressions, parameters, _RATES[model.name])


def only_loses(bench: ModelBench, steps: int) -> None:
    """Run on without inputs, and look at the energy after every step."""
    before = bench.energy()
    for _ in range(steps):
        bench.plant.step()
        after = bench.energy()
        assert after <= before + 1e-12 * (1.0 + abs(before))
        before = after
