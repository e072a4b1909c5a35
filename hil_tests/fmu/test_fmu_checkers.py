"""Third parties' checkers, and the description for people: categories, interfaces, sources."""

import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.model_description import read_model_description

from fmu.build import ensure
from fmu.export.description import CATEGORIES
from fmu.export.units import UNITS, per_second
from hil_tests.fmu.instance import Instance

VERSIONS = pytest.mark.parametrize("fmi", [2, 3])


@VERSIONS
def test_the_fmu_manipulation_toolbox_finds_nothing(fmu_file: dict[int, Path], fmi: int) -> None:
    tool = Path(sys.executable).with_name("fmutool")
    command = [str(tool), "-input", str(fmu_file[fmi]), "-check"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    logged = result.stdout + result.stderr
    assert f"compliant with FMI-{fmi}.0" in logged
    assert f"No semantic error against the FMI-{fmi} standard" in logged
    assert not [line for line in logged.splitlines() if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


@VERSIONS
def test_both_interfaces_offer_the_same(fmu_file: dict[int, Path], fmi: int) -> None:
    description = read_model_description(str(fmu_file[fmi]))
    for interface in (description.modelExchange, description.coSimulation):
        assert interface.modelIdentifier == "rars"
        assert interface.canBeInstantiatedOnlyOncePerProcess is False
        assert interface.canGetAndSetFMUstate
        assert interface.canSerializeFMUstate
    assert description.numberOfContinuousStates == 34
    # FMPy reads the word of FMI 2.0 only.
    with ZipFile(fmu_file[fmi]) as archive:
        text = archive.read("modelDescription.xml").decode()
    word = {2: "providesDirectionalDerivative", 3: "providesDirectionalDerivatives"}[fmi]
    assert text.count(f' {word}="true"') == 2
    assert description.numberOfEventIndicators == 4


@VERSIONS
def test_every_source_that_is_named_is_there_and_nothing_else(fmu_file: dict[int, Path], fmi: int) -> None:
    description = read_model_description(str(fmu_file[fmi]))
    with ZipFile(fmu_file[fmi]) as archive:
        held = {Path(name).name for name in archive.namelist() if name.endswith(".c")}
    (configuration,) = description.buildConfigurations
    named = [file for files in configuration.sourceFileSets for file in files.sourceFiles]
    assert sorted(named) == sorted(held)


@VERSIONS
def test_rates_have_the_unit_of_their_state_per_second(fmu_file: dict[int, Path], fmi: int) -> None:
    description = read_model_description(str(fmu_file[fmi]))
    rates = [row for row in description.modelVariables if row.derivative is not None]
    assert len(rates) == 34
    for row in rates:
        assert row.name == f"der({row.derivative.name})"
        assert row.unit == per_second(row.derivative.unit)[0]
    found = {unit.name: unit.baseUnit for unit in description.unitDefinitions}
    assert (found["rad/s2"].rad, found["rad/s2"].s) == (1, -2)
    assert (found["1/s"].s, found["A/s"].A) == (-1, 1)


def test_every_unit_has_a_rate() -> None:
    for name, unit in UNITS.items():
        written, rate = per_second(name)
        assert rate.exponents() == {k: v for k, v in (unit.exponents() | {"s": unit.s - 1}).items() if v}
        assert UNITS.get(written, rate) == rate


@VERSIONS
def test_what_has_a_physical_meaning_has_a_type(fmi: int) -> None:
    description = read_model_description(str(ensure("single_axis", fmi)))
    types = {it.name: it for it in description.typeDefinitions}
    assert (types["AngularVelocity"].quantity, types["AngularVelocity"].unit) == ("AngularVelocity", "rad/s")
    assert (float(types["Switch"].min), float(types["Switch"].max)) == (0.0, 1.0)
    used = set()
    for row in description.modelVariables:
        if row.declaredType is None:
            assert row.unit in {"1", "s/rad", "s/m"} or row.name.startswith("der("), row.name
            continue
        used.add(row.declaredType.name)
        assert row.declaredType.unit in {None, row.unit}
        assert (row.declaredType.name == "Switch") == (row.variability == "discrete")
    assert used == set(types)


@VERSIONS
def test_messages_come_in_the_categories_that_are_switched_on(
    fmu_file: dict[int, Path], tmp_path: Path, fmi: int
) -> None:
    description = read_model_description(str(fmu_file[fmi]))
    assert {category.name for category in description.logCategories} == set(CATEGORIES)
    plant = Instance(fmu_file[fmi], tmp_path / "unzipped", logging=True)
    plant.initialize()
    plant.fmu.terminate()
    plant.fmu.reset()
    assert [(status, category) for status, category, _ in plant.logged] == [(0, "logEvents")] * 4
    assert [text for *_, text in plant.logged] == [
        "instantiated for co-simulation",
        "initialised at 0 s",
        "terminated at 0 s",
        "reset",
    ]
    plant.logged.clear()
    switch(plant, ["logEvents"], on=False)
    plant.fmu.reset()
    assert plant.logged == []
    switch(plant, ["logEvents", "logStatusWarning"], on=True)
    plant.fmu.reset()
    assert [text for *_, text in plant.logged] == ["reset"]
    # An unknown category is answered with a warning, and the others are taken.
    plant.logged.clear()
    switch(plant, ["logDreams", "logEvents"], on=False)
    assert plant.logged == [(1, "logStatusWarning", "there is no log category 'logDreams'")]
    plant.fmu.reset()
    switch(plant, [], on=False)
    assert len(plant.logged) == 1
    # An error is logged even with all categories switched off.
    with pytest.raises(FMICallException):
        plant.step(0.0)
    assert plant.logged[-1][:2] == (3, "logStatusError")
    plant.fmu.freeInstance()


def switch(plant: Instance, categories: list[str], *, on: bool) -> None:
    plant.fmu.setDebugLogging(on, categories)
