"""One FMU instance, of either version and either interface, with the same few verbs for all four."""

from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_double, c_size_t
from pathlib import Path
from typing import Any, Final

import fmpy
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.model_description import read_model_description

KINDS: Final = {
    (2, "slave"): FMU2Slave,
    (2, "model"): FMU2Model,
    (3, "slave"): FMU3Slave,
    (3, "model"): FMU3Model,
}


class Instance:
    """Instantiated, not yet initialized; `logged` are its messages as (status, category, text)."""

    def __init__(self, path: Path, folder: Path, kind: str = "slave", *, logging: bool = False) -> None:
        self.description = read_model_description(str(path))
        self.fmi = int(self.description.fmiVersion[0])
        self.kind = kind
        self.references = {v.name: int(v.valueReference) for v in self.description.modelVariables}
        self.names = {reference: name for name, reference in self.references.items()}
        self.logged: list[tuple[int, str, str]] = []
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        self.fmu: Any = KINDS[self.fmi, kind](
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="under test",
        )
        if self.fmi == 2:
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda _e, _n, *rest: self._receive(*rest))
            self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)
        else:
            self.fmu.instantiate(loggingOn=logging, logMessage=lambda _e, *rest: self._receive(*rest))

    def _receive(self, status: int, category: bytes, text: bytes) -> None:
        self.logged.append((status, category.decode(), text.decode()))

    @property
    def component(self) -> int:
        """The address of the native instance."""
        return int(getattr(self.fmu.component, "value", self.fmu.component))

    def begin(self) -> None:
        """Enter initialization."""
        if self.fmi == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def initialize(self) -> None:
        """Initialize; a model goes on into continuous time."""
        self.begin()
        self.fmu.exitInitializationMode()
        if self.kind == "model":
            (self.fmu.newDiscreteStates if self.fmi == 2 else self.fmu.updateDiscreteStates)()
            self.fmu.enterContinuousTimeMode()

    def write(self, **values: float) -> None:
        references = [self.references[name] for name in values]
        (self.fmu.setReal if self.fmi == 2 else self.fmu.setFloat64)(references, list(values.values()))

    def read(self, *names: str) -> list[float]:
        getter = self.fmu.getReal if self.fmi == 2 else self.fmu.getFloat64
        return [float(value) for value in getter([self.references[name] for name in names])]

    def step(self, at: float, length: float = 1e-4) -> None:
        if self.fmi == 2:
            self.fmu.doStep(at, length)
        else:
            no_rollback, reported = c_bool(False), (c_bool(), c_bool(), c_bool())  # noqa: FBT003 - C
            fmu = self.fmu
            fmu.fmi3DoStep(
                fmu.component, at, length, no_rollback, *(byref(one) for one in reported), byref(c_double())
            )

    @property
    def state_names(self) -> list[str]:
        """The continuous states in their order."""
        rows = {int(v.valueReference): v for v in self.description.modelVariables}
        found = [rows[int(entry.variable.valueReference)] for entry in self.description.derivatives]
        return [str(row.derivative.name) for row in found]

    def set_states(self, values: Sequence[float]) -> None:
        array = (c_double * len(values))(*values)
        self.fmu.setContinuousStates(array, len(values))

    def states(self) -> list[float]:
        return self.vector("getContinuousStates", len(self.description.derivatives))

    def rates(self) -> list[float]:
        name = "getDerivatives" if self.fmi == 2 else "getContinuousStateDerivatives"
        return self.vector(name, len(self.description.derivatives))

    def nominals(self) -> list[float]:
        return self.vector("getNominalsOfContinuousStates", len(self.description.derivatives))

    def vector(self, name: str, count: int) -> list[float]:
        """Return the values that a function with an array and its length writes."""
        array = (c_double * count)()
        function = getattr(self.fmu, f"fmi{self.fmi}{name[0].upper()}{name[1:]}")
        function(self.fmu.component, array, c_size_t(count))
        return list(array)

    def slopes(self, unknowns: Sequence[str], knowns: Sequence[str], seed: Sequence[float]) -> list[float]:
        """Directional derivatives."""
        rows = [self.references[name] for name in unknowns], [self.references[name] for name in knowns]
        return [float(value) for value in self.fmu.getDirectionalDerivative(*rows, list(seed))]

    def save(self) -> Any:
        return self.fmu.getFMUstate() if self.fmi == 2 else self.fmu.getFMUState()

    def restore(self, state: Any) -> None:
        (self.fmu.setFMUstate if self.fmi == 2 else self.fmu.setFMUState)(state)

    def release(self, state: Any) -> None:
        (self.fmu.freeFMUstate if self.fmi == 2 else self.fmu.freeFMUState)(state)

    def to_bytes(self, state: Any) -> bytes:
        return bytes(
            self.fmu.serializeFMUstate(state) if self.fmi == 2 else self.fmu.serializeFMUState(state)
        )

    def from_bytes(self, text: bytes) -> Any:
        if self.fmi == 2:
            return self.fmu.deSerializeFMUstate(text)
        return self.fmu.deserializeFMUState(text)


Maker = Callable[..., Instance]
"""Constructor of an instance of a version of FMI, and of a kind."""
VERSIONS = pytest.mark.parametrize("fmi", [2, 3])
