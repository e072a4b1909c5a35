"""Every model folder is made the same way: valid FMUs, sources, reference trajectory, README, sets."""

import importlib
import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

import fmu
from fmu.build import ensure
from fmu.plants import names

FOLDER = Path(fmu.__file__).parent
SOURCES = {
    "ar2": "[A]",
    "climber": "[C]",
    "rars": "[R]",
    "rars_tipping": "[R]",
    "rome_arm": "[A]",
    "rome_base": "[O]",
    "single_axis": "assumed",
}


def part(model: str, module: str) -> Any:
    return importlib.import_module(f"fmu.{model}.{module}")


def test_all_models_are_known() -> None:
    own = {name for name in names() if importlib.util.find_spec(f"fmu.{name}") is not None}
    assert own == set(SOURCES)


@pytest.mark.long(keeps=["3-rars", "2-single_axis"])
@pytest.mark.parametrize("model", SOURCES)
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpy_finds_nothing_wrong(model: str, fmi: int) -> None:
    assert validate_fmu(str(ensure(model, fmi))) == []


@pytest.mark.long(keeps=["single_axis"])
@pytest.mark.parametrize("model", SOURCES)
def test_the_reference_trajectory_holds_in_both_versions(model: str) -> None:
    reference = importlib.import_module(f"validation.references.{model}")
    head = reference.FILE.read_text(encoding="utf-8").splitlines()[0].split(",")
    outputs = [row.name for row in part(model, "equations").model().outputs if not row.local]
    assert sorted(head) == sorted(["time", *outputs])
    written = np.loadtxt(reference.FILE, delimiter=",", skiprows=1)
    second, third = (reference.rows(ensure(model, fmi)) for fmi in (2, 3))
    assert second == third
    assert np.array(third) == pytest.approx(written, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("model", SOURCES)
def test_parameters_carry_their_source(model: str) -> None:
    parameters = part(model, "parameters")
    names = [row.name for row in parameters.PARAMETERS]
    assert len(set(names)) == len(names)
    for row in parameters.PARAMETERS:
        assert "assumed" in row.source or SOURCES[model] in row.source
    for overrides in parameters.SETS.values():
        assert set(overrides) <= set(names)


@pytest.mark.parametrize("model", SOURCES)
def test_the_readme_names_every_input_and_output(model: str) -> None:
    text = (FOLDER / model / "README.md").read_text(encoding="utf-8")
    description = read_model_description(str(ensure(model)))
    names = [it.name for it in description.modelVariables if it.causality in {"input", "output"}]
    assert len(names) > 5
    for name in names:
        family = name.rpartition("_")[0] + "_*"
        assert f"`{name}`" in text or f"`{family}`" in text, name
