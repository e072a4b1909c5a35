"""modelDescription.xml for FMI 2.0 and 3.0, written from the model's tables."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final
from xml.sax.saxutils import quoteattr

from fmu.export.code import settable_states
from fmu.export.model import Model
from fmu.export.units import UNITS

_GENERATOR = "firmware-bridge"
_STEP = "1e-4"


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable as both FMI versions describe it."""

    reference: int
    name: str
    unit: str
    description: str
    causality: str
    variability: str
    initial: str | None
    start: float | None
    nominal: float | None


def variables(model: Model) -> list[Variable]:
    """Return time, inputs, parameters and readings in the order of their value references."""
    rows = [
        Variable(0, "time", "s", "time", "independent", "continuous", None, None, None),
    ]

    def add(
        row: tuple[str, str, str],
        causality: str,
        variability: str,
        start: float | None,
        nominal: float | None,
    ) -> None:
        initial = None if causality == "input" else "calculated" if start is None else "exact"
        rows.append(Variable(len(rows), *row, causality, variability, initial, start, nominal))

    for entry in model.inputs:
        add((entry.name, entry.unit, entry.description), "input", "continuous", 0.0, entry.nominal)
    for parameter in model.parameters:
        text = f"{parameter.description}. {parameter.source}"
        add((parameter.name, parameter.unit, text), "parameter", "fixed", parameter.start, None)
    for output, state in zip(model.outputs, settable_states(model), strict=True):
        start = None if state < 0 else 0.0
        causality = "local" if output.local else "output"
        row = (output.name, output.unit, output.description)
        add(row, causality, "continuous", start, output.nominal)
    return rows


def _attributes(**values: object) -> str:
    return "".join(
        f" {name}={quoteattr(repr(value) if isinstance(value, float) else str(value))}"
        for name, value in values.items()
        if value is not None
    )


def _units(model: Model) -> Iterator[str]:
    used = {variable.unit for variable in variables(model)}
    yield "  <UnitDefinitions>"
    for name, unit in UNITS.items():
        if name in used:
            yield f'    <Unit name="{name}"><BaseUnit{_attributes(**unit.exponents())}/></Unit>'
    yield "  </UnitDefinitions>"


def _logging() -> Iterator[str]:
    yield "  <LogCategories>"
    yield '    <Category name="logStatusError" description="why a call was refused"/>'
    yield "  </LogCategories>"


def fmi2(model: Model, token: str, sources: Sequence[str]) -> str:
    """Return the FMI 2.0 description; `sources` are the C files of sources/."""
    rows = variables(model)
    head = _attributes(
        fmiVersion="2.0",
        modelName=model.name,
        guid=token,
        description=model.description,
        generationTool=_GENERATOR,
        variableNamingConvention="flat",
        numberOfEventIndicators=0,
    )
    interface = _attributes(
        modelIdentifier=model.name,
        canHandleVariableCommunicationStepSize="true",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<fmiModelDescription{head}>"]
    lines += [f"  <CoSimulation{interface}>", "    <SourceFiles>"]
    lines += [f'      <File name="{name}"/>' for name in sources]
    lines += ["    </SourceFiles>", "  </CoSimulation>", *_units(model), *_logging()]
    lines += [f'  <DefaultExperiment startTime="0" stopTime="1" stepSize="{_STEP}"/>', "  <ModelVariables>"]
    for row in rows:
        outer = _attributes(
            name=row.name,
            valueReference=row.reference,
            causality=row.causality,
            variability=row.variability,
            initial=row.initial,
            description=row.description,
        )
        inner = _attributes(unit=row.unit, nominal=row.nominal, start=row.start)
        lines.append(f"    <ScalarVariable{outer}><Real{inner}/></ScalarVariable>")
    lines += ["  </ModelVariables>", "  <ModelStructure>", "    <Outputs>"]
    lines += [f'      <Unknown index="{row.reference + 1}"/>' for row in rows if row.causality == "output"]
    lines.append("    </Outputs>")
    unknowns = [f'      <Unknown index="{row.reference + 1}"/>' for row in _initial_unknowns(rows)]
    if unknowns:
        lines += ["    <InitialUnknowns>", *unknowns, "    </InitialUnknowns>"]
    lines += ["  </ModelStructure>", "</fmiModelDescription>", ""]
    return "\n".join(lines)


def fmi3(model: Model, token: str, _sources: Sequence[str]) -> str:
    """Return the FMI 3.0 description; its sources are described by `fmi3_build`."""
    rows = variables(model)
    head = _attributes(
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        generationTool=_GENERATOR,
        variableNamingConvention="flat",
    )
    interface = _attributes(
        modelIdentifier=model.name,
        canBeInstantiatedOnlyOncePerProcess="false",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        canHandleVariableCommunicationStepSize="true",
        fixedInternalStepSize=model.inner_step,
    )
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<fmiModelDescription{head}>"]
    lines += [f"  <CoSimulation{interface}/>", *_units(model), *_logging()]
    lines += [f'  <DefaultExperiment startTime="0" stopTime="1" stepSize="{_STEP}"/>', "  <ModelVariables>"]
    for row in rows:
        attributes = _attributes(
            name=row.name,
            valueReference=row.reference,
            causality=row.causality,
            variability=row.variability,
            initial=row.initial,
            unit=row.unit,
            nominal=row.nominal,
            start=row.start,
            description=row.description,
        )
        lines.append(f"    <Float64{attributes}/>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    lines += [f'    <Output valueReference="{row.reference}"/>' for row in rows if row.causality == "output"]
    lines += [f'    <InitialUnknown valueReference="{row.reference}"/>' for row in _initial_unknowns(rows)]
    lines += ["  </ModelStructure>", "</fmiModelDescription>", ""]
    return "\n".join(lines)


def fmi3_build(model: Model, sources: Sequence[str]) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    files = "".join(f'      <SourceFile name="{name}"/>\n' for name in sources)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{model.name}">\n'
        f'    <SourceFileSet language="C99" compilerOptions="-O2 -ffp-contract=off">\n{files}'
        '    </SourceFileSet>\n    <Library name="m"/>\n  </BuildConfiguration>\n</fmiBuildDescription>\n'
    )


DESCRIPTIONS: Final[Mapping[int, Callable[[Model, str, Sequence[str]], str]]] = {2: fmi2, 3: fmi3}
"""The writer for each version of FMI."""


def _initial_unknowns(rows: list[Variable]) -> list[Variable]:
    return [row for row in rows if row.causality == "output" and row.initial == "calculated"]
