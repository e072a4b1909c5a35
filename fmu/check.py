"""Examine an FMU before it is trusted: its description, its start, its bits, and what a master needs of it.

Everything that is wrong is gathered, not only the first.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

from fmu.errors import PlantError, PlantWarning
from fmu.loading import must_be_file
from fmu.plant import OTHER_BITS, FmuPlant
from fmu.references import References
from fmu.verify import ComparisonResult


@dataclass(frozen=True, slots=True)
class Findings:
    """Contents of an FMU, and its errors; `start` and `bits` are empty where there are none."""

    model: str
    version: str
    interfaces: tuple[str, ...]
    variables: int
    description: tuple[str, ...]
    start: str
    fingerprint: ComparisonResult
    references: References

    @property
    def problems(self) -> tuple[str, ...]:
        """Every error, for any use."""
        bits = (OTHER_BITS,) if self.fingerprint is ComparisonResult.OTHER else ()
        return (*self.description, *((self.start,) if self.start else ()), *bits)

    def lacking(
        self, inputs: Sequence[str], outputs: Sequence[str], units: Mapping[str, str]
    ) -> tuple[str, ...]:
        """Return what keeps this FMU from serving a master with these variables, one sentence each."""
        found = []
        for names, causalities in ((inputs, ("input",)), (outputs, ("output", "local"))):
            for name in names:
                try:
                    self.references.find([name], causalities, units)
                except PlantError as error:
                    found.append(str(error))
        return tuple(found)


def examine(path: Path) -> Findings:
    """Read, validate and start an FMU; PlantError where it is none."""
    must_be_file(path)
    try:
        # Unchecked, so that even a wrong description gives its version.
        description = read_model_description(str(path), validate=False)
    except BadZipFile as error:
        raise PlantError(f"{path}: not an FMU: {error}") from error
    except Exception as error:
        raise PlantError(f"{path}: its modelDescription.xml cannot be read: {error}") from error
    start, fingerprint = _started(path)
    offered = {
        "co-simulation": description.coSimulation,
        "model exchange": description.modelExchange,
        "scheduled execution": getattr(description, "scheduledExecution", None),
    }
    return Findings(
        model=str(description.modelName),
        version=str(description.fmiVersion),
        interfaces=tuple(name for name, entry in offered.items() if entry is not None),
        variables=len(description.modelVariables),
        description=tuple(" ".join(str(problem).split()) for problem in validate_fmu(str(path))),
        start=start,
        fingerprint=fingerprint,
        references=References(path.name, description),
    )


def _started(path: Path) -> tuple[str, ComparisonResult]:
    """Load, initialize and step an FMU; return what was wrong, and whose bits it gives."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PlantWarning)
            # Without variables: what a certain master needs is judged apart, in `lacking`.
            with FmuPlant(path, (), ()) as plant:
                plant.step()
                return "", plant.fingerprint
    except PlantError as error:
        return " ".join(str(error).removeprefix(f"{path}: ").split()), ComparisonResult.NONE
