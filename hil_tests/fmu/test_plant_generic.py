"""The exporter knows nothing of RARS: another model, another seam, equations and parameters only."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
import sympy as sp
from fmpy.validation import validate_fmu

from fmu.build import export
from fmu.errors import PlantError
from fmu.export.code import UnsupportedError, c_text
from fmu.plant import FmuPlant
from hil_tests.fmu.pendulum import pendulum


@pytest.mark.long(keeps=["3"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_another_model(pendulums: Callable[[int], Path], fmi: int) -> None:
    path = pendulums(fmi)
    assert validate_fmu(str(path)) == []
    with FmuPlant(path, ["force"], ["angle", "height"], step=1_000_000) as plant:
        highest = 0.0
        for _ in range(2000):
            plant.step()
            highest = max(highest, plant.outputs[0])
        assert highest == pytest.approx(1.0, abs=1e-5)
        assert plant.read("height") == pytest.approx(1 - math.cos(plant.outputs[0]), abs=1e-12)


def test_an_third_party_fmu_without_units(pendulums: Callable[[int], Path], tmp_path: Path) -> None:
    bare = tmp_path / "bare.fmu"
    with ZipFile(pendulums(2)) as source, ZipFile(bare, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                for unit in ("rad", "m", "N", "s"):
                    content = content.replace(f' unit="{unit}"'.encode(), b"")
            target.writestr(name, content)
    with FmuPlant(bare, ["force"], ["angle"], {"length": 4.0}, units={"angle": "rad", "force": "N"}) as plant:
        plant.step()
        assert 0 < plant.outputs[0] < 1e-3


@pytest.mark.parametrize(
    "expression", [sp.exp(sp.Symbol("x")), sp.Symbol("x") ** sp.Symbol("y"), sp.Symbol("x") ** 7]
)
def test_what_has_no_deterministic_c_is_refused(expression: sp.Expr) -> None:
    with pytest.raises(UnsupportedError, match="no C for"):
        c_text(expression)


@pytest.mark.parametrize("table", ["parameters", "inputs", "states", "outputs"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_that_is_not_known_is_refused_at_the_build(table: str, fmi: int, tmp_path: Path) -> None:
    rows = getattr(pendulum(), table)
    changed: Any = {table: (replace(rows[0], unit="furlong"), *rows[1:])}
    wrong = replace(pendulum(), **changed)
    reported = rf"'{rows[0].name}' of pendulum is in 'furlong', which .* there are: 1, s"
    with pytest.raises(PlantError, match=reported):
        export(wrong, fmi, tmp_path / "wrong.fmu", token="{}")  # noqa: S106 - no password
    assert not list(tmp_path.iterdir())
