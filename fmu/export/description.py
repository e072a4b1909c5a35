"""modelDescription.xml for FMI 2.0 and 3.0, written from the model's tables."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final
from xml.sax.saxutils import quoteattr

from fmu.export.about import About
from fmu.export.blocks import ModelCode
from fmu.export.structure import Unknown, structure
from fmu.export.variables import SWITCH, Variable, units, variables

_GENERATOR: Final = "firmware-bridge"
_STEP: Final = "1e-4"
_XML: Final = '<?xml version="1.0" encoding="UTF-8"?>'
_EXPERIMENT: Final = f'  <DefaultExperiment startTime="0" stopTime="1" stepSize="{_STEP}"/>'

_TYPE2: Final = '    <SimpleType name="{name}"><Real{attributes}/></SimpleType>'
_TYPE3: Final = '    <Float64Type name="{name}"{attributes}/>'

CATEGORIES: Final[Mapping[str, str]] = {
    "logEvents": "phases of an instance: made, initialised, reset, ended",
    "logStatusWarning": "what was requested and is not there; the run goes on",
    "logStatusDiscard": "rates that are not finite: take a smaller step",
    "logStatusError": "why a call was refused; given even where logging is off",
}
"""Log categories of our FMUs, by the status that they come with (fmu/export/c/core.h has the same order)."""


def fmi2(program: ModelCode, token: str, sources: Sequence[str], about: About) -> str:
    """Return the FMI 2.0 description; `sources` are the C files of sources/."""
    model = program.model
    head = _attributes(
        fmiVersion="2.0",
        modelName=model.name,
        guid=token,
        description=model.description,
        author=about.author or None,
        version=about.version or None,
        copyright=about.copyright or None,
        license=about.licence or None,
        generationTool=_GENERATOR,
        variableNamingConvention="structured",
        numberOfEventIndicators=len(model.events),
    )
    common = {
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    files = ["    <SourceFiles>", *(f'      <File name="{name}"/>' for name in sources), "    </SourceFiles>"]
    exchange = _attributes(modelIdentifier=model.name, completedIntegratorStepNotNeeded="true", **common)
    slave = _attributes(modelIdentifier=model.name, canHandleVariableCommunicationStepSize="true", **common)
    lines = [_XML, f"<fmiModelDescription{head}>"]
    lines += [f"  <ModelExchange{exchange}>", *files, "  </ModelExchange>"]
    lines += [f"  <CoSimulation{slave}>", *files, "  </CoSimulation>"]
    lines += [*_units(program), *_types(program, _TYPE2), *_logging(), _EXPERIMENT, "  <ModelVariables>"]
    lines += [_variable2(row) for row in variables(program)]
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    found = structure(program)
    for title, rows in (
        ("Outputs", found.outputs),
        ("Derivatives", found.rates),
        ("InitialUnknowns", found.initial),
    ):
        if rows:
            kinds = title != "InitialUnknowns"
            lines += [f"    <{title}>", *(_unknown2(row, kinds=kinds) for row in rows), f"    </{title}>"]
    lines += ["  </ModelStructure>", "</fmiModelDescription>", ""]
    return "\n".join(lines)


def fmi3(program: ModelCode, token: str, _sources: Sequence[str], about: About) -> str:
    """Return the FMI 3.0 description; its sources are described by `fmi3_build`."""
    model = program.model
    head = _attributes(
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        author=about.author or None,
        version=about.version or None,
        copyright=about.copyright or None,
        license=about.licence or None,
        generationTool=_GENERATOR,
        variableNamingConvention="structured",
    )
    common = {
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
    }
    exchange = _attributes(modelIdentifier=model.name, needsCompletedIntegratorStep="false", **common)
    slave = _attributes(
        modelIdentifier=model.name,
        canHandleVariableCommunicationStepSize="true",
        fixedInternalStepSize=model.inner_step,
        **common,
    )
    lines = [_XML, f"<fmiModelDescription{head}>"]
    lines += [f"  <ModelExchange{exchange}/>", f"  <CoSimulation{slave}/>"]
    lines += [*_units(program), *_types(program, _TYPE3), *_logging(), _EXPERIMENT, "  <ModelVariables>"]
    lines += [_variable3(row) for row in variables(program)]
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    found = structure(program)
    lines += [_unknown3("Output", row) for row in found.outputs]
    lines += [_unknown3("ContinuousStateDerivative", row) for row in found.rates]
    lines += [_unknown3("InitialUnknown", row, kinds=False) for row in found.initial]
    lines += [_unknown3("EventIndicator", row) for row in found.events]
    lines += ["  </ModelStructure>", "</fmiModelDescription>", ""]
    return "\n".join(lines)


def fmi3_build(program: ModelCode, sources: Sequence[str], flags: Sequence[str]) -> str:
    """Return sources/buildDescription.xml of FMI 3.0; `flags` are those of the binaries beside them."""
    compiled = _attributes(language="C99", compiler="gcc", compilerOptions=" ".join(flags))
    files = "".join(f'      <SourceFile name="{name}"/>\n' for name in sources)
    return (
        f'{_XML}\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{program.model.name}">\n'
        f"    <SourceFileSet{compiled}>\n{files}"
        '    </SourceFileSet>\n    <Library name="m"/>\n  </BuildConfiguration>\n</fmiBuildDescription>\n'
    )


DESCRIPTIONS: Final[Mapping[int, Callable[[ModelCode, str, Sequence[str], About], str]]] = {2: fmi2, 3: fmi3}
"""The writer for each version of FMI."""


def _attributes(**values: object) -> str:
    return "".join(
        f" {name}={quoteattr(repr(value) if isinstance(value, float) else str(value))}"
        for name, value in values.items()
        if value is not None
    )


def _units(program: ModelCode) -> Iterator[str]:
    yield "  <UnitDefinitions>"
    for name, unit in units(program).items():
        yield f'    <Unit name="{name}"><BaseUnit{_attributes(**unit.exponents())}/></Unit>'
    yield "  </UnitDefinitions>"


def _types(program: ModelCode, written: str) -> Iterator[str]:
    types = {row.type: row for row in variables(program) if row.type}
    limits = _attributes(min=0.0, max=1.0)
    yield "  <TypeDefinitions>"
    for name, row in sorted(types.items()):
        means = limits if name == SWITCH else _attributes(quantity=name, unit=row.unit)
        yield written.format(name=name, attributes=means)
    yield "  </TypeDefinitions>"


def _logging() -> Iterator[str]:
    yield "  <LogCategories>"
    for name, meaning in CATEGORIES.items():
        yield f"    <Category{_attributes(name=name, description=meaning)}/>"
    yield "  </LogCategories>"


def _variable2(row: Variable) -> str:
    outer = _attributes(
        name=row.name,
        valueReference=row.reference,
        causality=row.causality,
        variability=row.variability,
        initial=row.initial,
        description=row.description,
    )
    # FMI 2.0 gives the index of the variable, counted from 1; FMI 3.0 its value reference.
    state = None if row.rate_of is None else row.rate_of + 1
    inner = _attributes(
        declaredType=row.type,
        unit=row.unit,
        min=row.least,
        max=row.most,
        nominal=row.nominal,
        start=row.start,
        derivative=state,
    )
    return f"    <ScalarVariable{outer}><Real{inner}/></ScalarVariable>"


def _variable3(row: Variable) -> str:
    attributes = _attributes(
        name=row.name,
        valueReference=row.reference,
        causality=row.causality,
        variability=row.variability,
        initial=row.initial,
        declaredType=row.type,
        unit=row.unit,
        min=row.least,
        max=row.most,
        nominal=row.nominal,
        start=row.start,
        derivative=row.rate_of,
        description=row.description,
    )
    return f"    <Float64{attributes}/>"


def _unknown2(row: Unknown, *, kinds: bool) -> str:
    # FMI 2.0 counts variables from 1, in the order of the file.
    return f'      <Unknown index="{row.reference + 1}"{_dependencies(row, 1, kinds=kinds)}/>'


def _unknown3(title: str, row: Unknown, *, kinds: bool = True) -> str:
    return f'    <{title} valueReference="{row.reference}"{_dependencies(row, 0, kinds=kinds)}/>'


def _dependencies(row: Unknown, offset: int, *, kinds: bool) -> str:
    on = " ".join(str(reference + offset) for reference, _ in row.dependencies)
    how = " ".join(kind.name for _, kind in row.dependencies)
    return _attributes(dependencies=on, dependenciesKind=how if kinds and how else None)
