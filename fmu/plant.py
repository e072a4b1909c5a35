"""Load any co-simulation FMU and step it: names become value references once, on load.

The only module that imports FMPy, which unzips, validates and instantiates; each step is then three native
calls on prepared arrays. It knows variables and units, not what they move.
"""

import shutil
import tempfile
import weakref
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Any, Final, NoReturn, Self
from zipfile import BadZipFile, ZipFile

import fmpy
from fmpy import fmi2, fmi3
from fmpy.model_description import read_model_description

from fmu.calls import OK_OR_WARNING, STATUS, prepare
from fmu.errors import PlantError
from fmu.interface import UNITS
from fmu.references import References

__all__ = ["FmuPlant", "PlantError"]

_SECOND_NS: Final = 1e9
_NOTHING: Final[Mapping[str, float]] = MappingProxyType({})


class FmuPlant:
    """A plant in step with a master of fixed step; time is the step's index times the step.

    Write `inputs` before `step()`, read `outputs` after it; both are in the order of the names given.
    """

    def __init__(
        self,
        path: Path,
        inputs: Sequence[str],
        outputs: Sequence[str],
        parameters: Mapping[str, float] = _NOTHING,
        step: int = 100_000,
        *,
        units: Mapping[str, str] = UNITS,
    ) -> None:
        """Unzip, validate, instantiate, set `parameters` (SI), initialise; `step` in ns.

        `units` tells what the named variables must be in; an FMU without units is taken at its word.
        Raises PlantError, naming the file and what is wrong with it.
        """
        self.path = path
        self.steps_done = 0
        self._messages: deque[str] = deque(maxlen=8)
        description = _described(path)
        self._references = References(str(path), description)
        input_references = self._references.find(inputs, ("input",), units)
        output_references = self._references.find(outputs, ("output", "local"), units)
        set_references = self._references.settable(parameters)
        self._fmu, self._finish = _loaded(self, path, description, self._messages)
        try:
            self._initialise(description, set_references, list(parameters.values()))
        except Exception as error:
            self.close()
            raise PlantError(self._reason("cannot be initialised", error)) from error
        self._step_ns = step
        version = int(description.fmiVersion[0])
        component = int(getattr(self._fmu.component, "value", self._fmu.component))
        calls = prepare(
            self._fmu.dll, component, version, input_references, output_references, step=step / _SECOND_NS
        )
        self.inputs, self.outputs, self._time = calls.inputs, calls.outputs, calls.time
        self._write, self._write_arguments = calls.write, calls.write_arguments
        self._forward, self._forward_arguments = calls.step, calls.step_arguments
        self._read, self._read_arguments = calls.read, calls.read_arguments
        if self._read(*self._read_arguments) > OK_OR_WARNING:
            reason = self._reason("cannot be read", PlantError("no reason given"))
            self.close()
            raise PlantError(reason)

    def step(self) -> None:
        """Take one communication step: inputs in, plant forward, outputs out."""
        self._time.value = self.steps_done * self._step_ns / _SECOND_NS
        if (status := self._write(*self._write_arguments)) > OK_OR_WARNING:
            self._fail("setting the inputs", status)
        if (status := self._forward(*self._forward_arguments)) > OK_OR_WARNING:
            self._fail("doStep", status)
        self.steps_done += 1
        if (status := self._read(*self._read_arguments)) > OK_OR_WARNING:
            self._fail("reading the outputs", status)

    def read(self, name: str) -> float:
        """Return any variable's value now; slow."""
        reference, kind = self._references.any(name)
        self._open()
        getter = getattr(self._fmu, f"get{kind}", None)
        if getter is None or kind == "String":
            raise PlantError(f"{self.path}: '{name}' is of type {kind}, not a number")
        try:
            return float(getter([reference])[0])
        except Exception as error:
            raise PlantError(self._reason(f"'{name}' cannot be read", error)) from error

    def close(self) -> None:
        """Free the instance, unload the library, delete the unzipped files; harmless twice."""
        self._finish()
        self._write = self._forward = self._read = _closed

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _initialise(self, description: Any, references: list[int], values: list[float]) -> None:
        plant = self._fmu
        if description.fmiVersion.startswith("2"):
            plant.setupExperiment(startTime=0.0)
            if references:
                plant.setReal(references, values)
            plant.enterInitializationMode()
        else:
            if references:
                plant.setFloat64(references, values)
            plant.enterInitializationMode(startTime=0.0)
        plant.exitInitializationMode()

    def _open(self) -> None:
        if not self._finish.alive:
            raise PlantError(f"{self.path}: the plant is closed")

    def _fail(self, action: str, status: int) -> NoReturn:
        self._open()
        at = self.steps_done * self._step_ns / _SECOND_NS
        word = STATUS[status] if status < len(STATUS) else f"status {status}"
        said = self._messages[-1] if self._messages else "the FMU gives no reason"
        raise PlantError(f"{self.path}: {action} failed at {at:.4f} s ({word}): {said}")

    def _reason(self, problem: str, error: Exception) -> str:
        return f"{self.path}: the FMU {problem}: {self._messages[-1] if self._messages else error}"


def _closed(*_: Any) -> int:
    return len(STATUS)


def _described(path: Path) -> Any:
    """Return FMPy's model description after all of its checks."""
    if not path.is_file():
        raise PlantError(f"{path}: there is no such file; give the path of an FMU")
    try:
        with ZipFile(path) as archive:
            names = archive.namelist()
    except (BadZipFile, OSError) as error:
        raise PlantError(f"{path}: not an FMU: {error}") from error
    if "modelDescription.xml" not in names:
        raise PlantError(f"{path}: not an FMU: it holds no modelDescription.xml")
    try:
        description = read_model_description(str(path))
    except Exception as error:
        raise PlantError(f"{path}: its modelDescription.xml is not valid: {error}") from error
    version = description.fmiVersion
    if not version.startswith(("2.0", "3.0")):
        raise PlantError(f"{path}: FMI {version} is not supported: 2.0 or 3.0")
    if description.coSimulation is None:
        raise PlantError(f"{path}: the FMU offers no co-simulation; export it with its solver")
    folder = f"binaries/{fmpy.platform if version.startswith('2') else fmpy.platform_tuple}/"
    if not any(name.startswith(folder) for name in names):
        held = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and "." in name})
        raise PlantError(
            f"{path}: no binary for this machine ({folder}); it holds: {', '.join(held) or 'none'}"
        )
    return description


def _loaded(
    owner: object, path: Path, description: Any, messages: deque[str]
) -> tuple[Any, "weakref.finalize[..., Any]"]:
    """Unzip, load and instantiate; return FMPy's instance and what undoes all of it, once."""
    folder = tempfile.mkdtemp(prefix="firmware-bridge-plant-")
    try:
        fmpy.extract(str(path), folder)
        second = description.fmiVersion.startswith("2")
        kind = fmi2.FMU2Slave if second else fmi3.FMU3Slave
        plant = kind(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=description.modelName,
            requireFunctions=False,
        )
    except Exception as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise PlantError(f"{path}: the FMU cannot be loaded: {error}") from error
    try:
        if second:
            plant.instantiate(loggingOn=True, callbacks=_callbacks(messages))
        else:
            plant.instantiate(loggingOn=True, logMessage=_listener3(messages))
    except Exception as error:
        plant.freeLibrary()
        shutil.rmtree(folder, ignore_errors=True)
        said = messages[-1] if messages else error
        raise PlantError(f"{path}: the FMU cannot be instantiated: {said}") from error
    return plant, weakref.finalize(owner, _release, plant, folder)


def _release(plant: Any, folder: str) -> None:
    # Freeing an instance is allowed in every state; fmi*Terminate is not, and adds nothing here.
    plant.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


def _listener3(messages: deque[str]) -> Callable[[Any, int, bytes, bytes], None]:
    def listen(_environment: Any, status: int, _category: bytes, message: bytes) -> None:
        if status >= OK_OR_WARNING:
            messages.append(message.decode(errors="replace"))

    return listen


def _callbacks(messages: deque[str]) -> Any:
    def listen(_environment: Any, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
        if status >= OK_OR_WARNING:
            messages.append(message.decode(errors="replace"))

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(listen)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
    # FMPy's proxy, which would fill in printf arguments, keeps one logger for the whole process, and calls
    # it after it is gone: messages are taken as they are.
    return callbacks
