"""Comparison of a loaded FMU with its equations, bit by bit: its fixed run again, in a second instance."""

import copy
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from fmu.calls import OK_OR_WARNING, Calls, prepare
from fmu.errors import PlantError
from fmu.fingerprint import RESOURCE, Fingerprint, measure
from fmu.references import References


class ComparisonResult(StrEnum):
    """Result of the comparison."""

    SAME = "same"
    OTHER = "other"
    NONE = "none"
    """The FMU carries none of ours, or one of other variables than it has: it is a third party's."""


class _RunError(Exception):
    """The second instance refused a call."""


class _Second:
    """The second instance as the fixed run wants it."""

    def __init__(self, calls: Calls, step: int) -> None:
        self._calls = calls
        self._length = step / 1e9
        self._done = 0

    def write(self, values: Sequence[float]) -> None:
        self._calls.inputs[:] = list(values)
        self._check(self._calls.write(*self._calls.write_arguments))

    def step(self) -> None:
        self._calls.time.value = self._done * self._length
        self._check(self._calls.step(*self._calls.step_arguments))
        self._done += 1

    def read(self) -> Sequence[float]:
        self._check(self._calls.read(*self._calls.read_arguments))
        return self._calls.outputs[:]

    @staticmethod
    def _check(status: int) -> None:
        if status > OK_OR_WARNING:
            raise _RunError


def recorded(path: Path) -> Fingerprint | None:
    """Return the fingerprint that an FMU carries, None where it has none of ours."""
    with ZipFile(path) as archive:
        if RESOURCE not in archive.namelist():
            return None
        try:
            return Fingerprint.from_json(archive.read(RESOURCE))
        except (ValueError, TypeError):
            return None


def compare(path: Path, fmu: Any, major: int, references: References) -> ComparisonResult:
    """Run a loaded FMU (FMPy's object, of FMI 2 or 3) against its fingerprint, beside the instance it has."""
    wanted = recorded(path)
    if wanted is None:
        return ComparisonResult.NONE
    try:
        inputs = references.find(list(wanted.inputs), ("input",), {})
        outputs = references.find(wanted.outputs, ("output",), {})
    except PlantError:
        # The measured variables were renamed. A master that needs them reports that itself.
        return ComparisonResult.NONE
    # A shallow copy shares the loaded library, and gets an instance of its own.
    second = copy.copy(fmu)
    # FMI 2.0 takes callbacks at instantiation; they must outlive the instance, so the first one's serve.
    if major == 2:  # noqa: PLR2004 - the version
        second.instantiate(callbacks=fmu.callbacks)
    else:
        second.instantiate(logMessage=lambda *_: None)
    try:
        _initialise(second, major)
        component = int(getattr(second.component, "value", second.component))
        calls = prepare(second.dll, component, major, inputs, outputs, step=wanted.step)
        same = measure(_Second(calls, wanted.step), list(wanted.inputs.values())) == wanted.sha256
    except _RunError:
        same = False
    finally:
        (second.fmi2FreeInstance if major == 2 else second.fmi3FreeInstance)(second.component)  # noqa: PLR2004
    return ComparisonResult.SAME if same else ComparisonResult.OTHER


def _initialise(second: Any, major: int) -> None:
    if major == 2:  # noqa: PLR2004 - the version
        second.setupExperiment(startTime=0.0)
    second.enterInitializationMode()
    second.exitInitializationMode()
