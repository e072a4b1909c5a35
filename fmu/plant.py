"""Load any co-simulation FMU and step it: names become value references once, on load.

Loading is FMPy's work; each step is then three native calls on prepared arrays. It knows variables and
units, not what they move.
"""

import ctypes
import warnings
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Any, Final, NamedTuple, NoReturn, Self

from fmu.calls import OK_OR_WARNING, SECOND_NS, STATUS, Look, Mirrored, PlantRecord, look, prepare
from fmu.errors import PlantError, PlantWarning
from fmu.references import References, Variable
from fmu.states import Copy, StateError
from fmu.verify import ComparisonResult, compare

__all__ = ["FmuPlant", "PlantError", "variables_of"]

WRITING: Final = "setting the inputs"
STEPPING: Final = "doStep"
READING: Final = "reading the outputs"
OTHER_BITS: Final = (
    "this plant was compiled in another way: its reference run does not give the bits that its equations"
    " give, so results will differ from those of other machines; compile it with -ffp-contract=off and"
    " without -ffast-math, or build it again with `firmware-bridge fmu build`"
)

_NOTHING: Final[Mapping[str, float]] = MappingProxyType({})
_NO_UNITS: Final[Mapping[str, str]] = MappingProxyType({})


def variables_of(path: Path) -> tuple[Variable, ...]:
    """Return what an FMU has, without loading it; PlantError, naming the file and what is wrong with it."""
    from fmu import loading  # noqa: PLC0415 - FMPy comes with it

    return References(str(path), loading.described(path)).described()


class PlantState(NamedTuple):
    """A plant at one instant: what is in the FMU, and what its last step gave."""

    copy: Copy
    inputs: bytes
    outputs: bytes
    steps_done: int
    messages: tuple[str, ...]


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
        units: Mapping[str, str] = _NO_UNITS,
        optional_inputs: Sequence[str] = (),
        optional_outputs: Sequence[str] = (),
        mirrored: Sequence[str] = (),
        shown: Sequence[str] = (),
    ) -> None:
        """Unzip, validate, instantiate, set `parameters` (SI), initialize; `step` in ns.

        `units` has the required units of the named variables; an FMU without units is taken at its word.
        Optional variables follow the others where the FMU has them: `input_names` and `output_names` list
        all. `mirrored` are those of both that `inputs` and `outputs` have with the other sign; `read` gives
        the FMU's own. Those of `shown` are read by `look` only, which costs nothing in a step. Raises
        PlantError, naming the file and what is wrong with it.
        """
        # FMPy comes with it, and most of what FMPy imports: only who has a plant waits for that.
        from fmu import loading  # noqa: PLC0415 - see above

        self.path = path
        # The last ones only: an FMU may log in every step.
        self._messages: deque[str] = deque(maxlen=8)
        self._record = PlantRecord()
        description = loading.described(path)
        self._references = References(str(path), description)
        self.input_names: Final = (*inputs, *self._references.present(optional_inputs))
        self.output_names: Final = (*outputs, *self._references.present(optional_outputs))
        input_references = self._references.find(self.input_names, ("input",), units)
        output_references = self._references.find(self.output_names, ("output", "local"), units)
        self.shown_names: Final = tuple(name for name in shown if name not in self.output_names)
        shown_references = self._references.find(self.shown_names, ("output", "local"), units)
        # Before anything is unzipped: a wrong name costs no time and leaves nothing behind.
        set_references = self._references.settable(parameters)
        self._fmu, self._vault, self._finish = loading.loaded(self, path, description, self._messages)
        try:
            self._initialise(description, set_references, list(parameters.values()))
        except Exception as error:
            self.close()
            raise PlantError(self._reason("cannot be initialised", error)) from error
        self._step_ns = step
        version = int(description.fmiVersion[0])
        self.fingerprint = self._verified(version)
        component = loading.component_of(self._fmu)
        # Kept whole: the record holds bare addresses of what the calls own.
        self._calls = calls = prepare(
            self._fmu.dll,
            component,
            version,
            input_references,
            output_references,
            step=step,
            mirrored=Mirrored(
                [place for place, name in enumerate(self.input_names) if name in mirrored],
                [place for place, name in enumerate(self.output_names) if name in mirrored],
            ),
        )
        self._look = look(self._fmu.dll, component, version, shown_references)
        self._record = calls.record
        self.inputs, self.outputs, self._time = calls.inputs, calls.outputs, calls.time
        self._write, self._write_arguments = calls.write, calls.write_arguments
        self._forward, self._forward_arguments = calls.step, calls.step_arguments
        self._read, self._read_arguments = calls.read, calls.read_arguments
        if self._read(*self._read_arguments) > OK_OR_WARNING:
            reason = self._reason("cannot be read", PlantError("no reason given"))
            self.close()
            raise PlantError(reason)

    @property
    def variables(self) -> Mapping[str, Variable]:
        """Variables of this FMU by name, with units and descriptions: any of them can be read."""
        return {variable.name: variable for variable in self._references.described()}

    @property
    def record(self) -> PlantRecord:
        """The step's native functions, their arguments and the count of steps, for a master in C."""
        return self._record

    @property
    def steps_done(self) -> int:
        """Number of steps taken, by `step` or by a master in C."""
        return int(self._record.steps_done)

    def step(self) -> None:
        """Take one communication step: inputs in, plant forward, outputs out."""
        record = self._record
        done = record.steps_done
        # The index times the step, in integers: a sum of steps would drift.
        self._time.value = done * self._step_ns / SECOND_NS
        if (status := self._write(*self._write_arguments)) > OK_OR_WARNING:
            self.failed(WRITING, status)
        if (status := self._forward(*self._forward_arguments)) > OK_OR_WARNING:
            self.failed(STEPPING, status)
        # Counted before the outputs are read: the FMU has made this step, whatever follows.
        record.steps_done = done + 1
        if (status := self._read(*self._read_arguments)) > OK_OR_WARNING:
            self.failed(READING, status)

    def look(self) -> Sequence[float]:
        """Return the shown variables now, in the order of `shown_names`."""
        if (status := self._look.read(*self._look.arguments)) > OK_OR_WARNING:
            self.failed(READING, status)
        return self._look.values[:]

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

    @property
    def tunable(self) -> tuple[str, ...]:
        """The parameters that may be changed while it runs."""
        return self._references.tunable()

    def change(self, name: str, value: float) -> None:
        """Set a tunable parameter from the next step on; PlantError for any other, or for a refused value."""
        reference, kind = self._references.any(name)
        self._open()
        if name not in self.tunable:
            known = ", ".join(self.tunable) or "none"
            raise PlantError(f"{self.path}: '{name}' cannot be changed while it runs; tunable are: {known}")
        try:
            getattr(self._fmu, f"set{kind}")([reference], [value])
        except Exception as error:
            raise PlantError(self._reason(f"'{name}' cannot be set to {value:g}", error)) from error

    def save_state(self) -> PlantState:
        """Keep everything that a run changes; PlantError where the FMU cannot copy its state."""
        self._open()
        if self._vault is None:
            raise PlantError(
                f"{self.path}: time cannot be rewound: the FMU cannot save its state"
                " (canGetAndSetFMUState); export it with that capability, or run it straight on"
            )
        try:
            copy = self._vault.copy()
        except StateError as error:
            raise PlantError(self._reason("cannot save its state", error)) from error
        done = self._record.steps_done
        return PlantState(copy, bytes(self.inputs), bytes(self.outputs), done, tuple(self._messages))

    def restore_state(self, state: PlantState) -> None:
        """Go back to an instant of this plant; PlantError where the FMU does not take its own state."""
        self._open()
        if self._vault is None or not self._vault.knows(state.copy):
            raise PlantError(f"{self.path}: this state was saved by another plant")
        try:
            self._vault.bring_back(state.copy)
        except StateError as error:
            raise PlantError(self._reason("cannot go back to a state that it saved", error)) from error
        # In place: the kernel in C and the FMU's calls hold the addresses of both arrays.
        ctypes.memmove(self.inputs, state.inputs, len(state.inputs))
        ctypes.memmove(self.outputs, state.outputs, len(state.outputs))
        self._record.steps_done = state.steps_done
        self._messages.clear()
        self._messages.extend(state.messages)

    def close(self) -> None:
        """Free the instance, unload the library, delete the unzipped files; harmless twice."""
        self._finish()
        self._write = self._forward = self._read = _closed
        self._look = Look(_closed, (), (ctypes.c_double * 0)())
        # Null for the kernel in C, too: it must not call into a library that is unloaded.
        self._record.write = self._record.forward = self._record.read = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _initialise(self, description: Any, references: list[int], values: list[float]) -> None:
        plant = self._fmu
        if description.fmiVersion.startswith("2"):
            # FMI 2.0 takes the start time here, FMI 3.0 with enterInitializationMode.
            plant.setupExperiment(startTime=0.0)
            if references:
                plant.setReal(references, values)
            plant.enterInitializationMode()
        else:
            if references:
                plant.setFloat64(references, values)
            plant.enterInitializationMode(startTime=0.0)
        plant.exitInitializationMode()

    def _verified(self, version: int) -> ComparisonResult:
        """Compare the FMU's fingerprint, and warn where it is another one."""
        try:
            verdict = compare(self.path, self._fmu, version, self._references)
            if verdict is ComparisonResult.OTHER:
                warnings.warn(f"{self.path}: {OTHER_BITS}", PlantWarning, stacklevel=3)
        except BaseException:
            self.close()
            raise
        return verdict

    def _open(self) -> None:
        if not self._finish.alive:
            raise PlantError(f"{self.path}: the plant is closed")

    def failed(self, action: str, status: int) -> NoReturn:
        """Raise the error for one of the step's three calls that gave this status."""
        self._open()
        at = self.steps_done * self._step_ns / SECOND_NS
        word = STATUS[status] if status < len(STATUS) else f"status {status}"
        stated = self._messages[-1] if self._messages else "the FMU gives no reason"
        raise PlantError(f"{self.path}: {action} failed at {at:.4f} s ({word}): {stated}")

    def _reason(self, problem: str, error: Exception) -> str:
        return f"{self.path}: the FMU {problem}: {self._messages[-1] if self._messages else error}"


def _closed(*_: Any) -> int:
    return len(STATUS)
