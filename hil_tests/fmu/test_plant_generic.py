"""The exporter knows nothing of RARS: another model, another seam, equations and parameters only."""

import math
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
import sympy as sp
from fmpy.validation import validate_fmu

from fmu.build import export
from fmu.export.code import UnsupportedError, c_text
from fmu.export.model import Input, Model, Output, Parameter, State
from fmu.plant import FmuPlant


def pendulum() -> Model:
    length, angle, speed, force = (sp.Symbol(n, real=True) for n in ("length", "angle", "speed", "force"))
    start = sp.sqrt(2 * 9.81 * (1 - sp.cos(1)) / length)
    return Model(
        name="pendulum",
        description="A pendulum of 1 kg",
        parameters=(Parameter("length", 1.0, "m", "length", "ASSUME"),),
        inputs=(Input("force", "N", "force across"),),
        states=(
            State("angle", "rad", sp.S.Zero, speed),
            # Starts on the orbit that just reaches 1 rad with length = 1 m.
            State("speed", "rad/s", start, (force - 9.81 * sp.sin(angle)) / length),
        ),
        outputs=(
            Output("angle", "rad", "angle", angle),
            Output("height", "m", "height", length * (1 - sp.cos(angle)), local=True),
        ),
        inner_step=1e-3,
    )  # fmt: skip


@pytest.mark.parametrize("fmi", [2, 3])
def test_another_model(tmp_path: Path, fmi: int) -> None:
    path = tmp_path / "pendulum.fmu"
    export(pendulum(), fmi, path, token="{pendulum}")  # noqa: S106 - no password
    assert validate_fmu(str(path)) == []
    with FmuPlant(path, ["force"], ["angle", "height"], step=1_000_000) as plant:
        highest = 0.0
        for _ in range(2000):
            plant.step()
            highest = max(highest, plant.outputs[0])
        assert highest == pytest.approx(1.0, abs=1e-5)
        assert plant.read("height") == pytest.approx(1 - math.cos(plant.outputs[0]), abs=1e-12)


def test_an_fmu_of_a_stranger_without_units(tmp_path: Path) -> None:
    path, bare = tmp_path / "pendulum.fmu", tmp_path / "bare.fmu"
    export(pendulum(), 2, path, token="{pendulum}")  # noqa: S106 - no password
    with ZipFile(path) as source, ZipFile(bare, "w", ZIP_DEFLATED) as target:
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
