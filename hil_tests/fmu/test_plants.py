"""Plants come from packages: a third party's is listed, built and set from a robot's file as ours are."""

import sys
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from fmu.build import ensure
from fmu.errors import PlantError, UnknownNameError
from fmu.plant import FmuPlant
from fmu.plants import GROUP, Plant, find, names
from fmu.rars.parameters import PARAMETERS

PARAMETERS_PY = """
    from fmu.export.model import Parameter
    from fmu.plants import Plant

    PARAMETERS = (Parameter("length", 1.0, "m", "from pivot to bob", "assumed"),)
    PLANT = Plant("pendulum", "swinging", PARAMETERS, {"long": {"length": 4.0}}, {"rope": ("length", 1.0)})
"""
EQUATIONS_PY = """
    import sympy as sp

    from fmu.export.model import Input, Model, Output, StateVariable
    from fmu.parts.symbols import symbol
    from swinging.parameters import PARAMETERS

    def model():
        angle, speed = symbol("angle"), symbol("speed")
        rate = -9.81 / symbol("length") * sp.sin(angle) + symbol("push")
        return Model(
            "pendulum", "A pendulum", PARAMETERS, (Input("push", "rad/s2", "push"),),
            (
                StateVariable("angle", "rad", sp.S.Zero, speed),
                StateVariable("speed", "rad/s", sp.S.Zero, rate),
            ),
            (Output("angle", "rad", "angle from below", angle), Output("speed", "rad/s", "its rate", speed)),
            1e-3,
        )
"""


@dataclass(frozen=True)
class Row:
    name: str
    gear_ratio: float


@dataclass(frozen=True)
class Robot:
    axes: tuple[Row, ...]
    geometry: dict[str, Row]


ROBOT = Robot((Row("left", 26.0), Row("right", 27.0)), {"base": Row("base", 3.0)})

Installer = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Installer]:
    """Put a third party's distribution with these plants on the path, as pip would."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def installed(distribution: str = "swinging", **plants: str) -> None:
        info = tmp_path / f"{distribution}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
        rows = "".join(f"{name} = {value}\n" for name, value in plants.items())
        (info / "entry_points.txt").write_text(f"[{GROUP}]\n{rows}")
        package = tmp_path / "swinging"
        package.mkdir(exist_ok=True)
        (package / "__init__.py").write_text("")
        (package / "parameters.py").write_text(textwrap.dedent(PARAMETERS_PY))
        (package / "equations.py").write_text(textwrap.dedent(EQUATIONS_PY))

    yield installed
    for module in [name for name in sys.modules if name.partition(".")[0] == "swinging"]:
        del sys.modules[module]


def run(*words: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(program, ["fmu", *words], env={"COLUMNS": "200", "NO_COLOR": "1"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


def test_a_third_party_plant_is_listed_built_and_checked(install: Installer, tmp_path: Path) -> None:
    install(pendulum="swinging.parameters:PLANT")
    assert "pendulum" in names()
    assert "│ pendulum " in run("list")[1]
    target = tmp_path / "pendulum.fmu"
    assert run("build", "pendulum", "--out", str(target))[0] == 0
    status, out, err = run("check", str(target))
    assert (status, err) == (0, "")
    assert "pendulum, " in out
    with FmuPlant(ensure("pendulum"), ["push"], ["angle"], find("pendulum").parameter_set("long")) as plant:
        assert plant.read("length") == 4.0


def test_its_cache_follows_its_own_source(install: Installer, tmp_path: Path) -> None:
    install(pendulum="swinging.parameters:PLANT")
    first = ensure("pendulum")
    assert ensure("pendulum") == first
    equations = tmp_path / "swinging" / "equations.py"
    equations.write_text(equations.read_text() + "# changed\n")
    assert ensure("pendulum") != first


@pytest.mark.long(
    keeps=[
        "fmu.rars.parameters:PLANT-is not the plant 'pendulum'",
        "swinging.nowhere:PLANT-'pendulum' cannot be loaded from swinging\\\\.nowhere:PLANT",
    ]
)
@pytest.mark.parametrize(
    ("value", "logged"),
    [
        ("swinging.nowhere:PLANT", r"'pendulum' cannot be loaded from swinging\.nowhere:PLANT"),
        ("swinging.parameters:PARAMETERS", r"parameters:PARAMETERS is not the plant 'pendulum', but \("),
        ("fmu.rars.parameters:PLANT", "is not the plant 'pendulum'"),
    ],
)
def test_an_entry_that_is_no_plant_is_named(install: Installer, value: str, logged: str) -> None:
    install(pendulum=value)
    with pytest.raises(PlantError, match=logged):
        find("pendulum")
    assert find("rars").name == "rars", "and harms no other"
    status, out, _ = run("list")
    assert (status, "│ rars " in out, "cannot be loaded" in out or "is not the plant" in out) == (
        1,
        True,
        True,
    )


def test_two_plants_of_one_name_are_refused(install: Installer) -> None:
    install("one", pendulum="swinging.parameters:PLANT")
    install("two", pendulum="fmu.rars.parameters:PLANT")
    with pytest.raises(
        PlantError, match=r"two plants are called 'pendulum': fmu\.rars\.\S+ and swinging\.\S+; uninstall one"
    ):
        find("pendulum")


def test_an_unknown_plant_and_set_are_reported_with_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="there is no plant 'rarz'; did you mean 'rars'"):
        find("rarz")
    with pytest.raises(
        UnknownNameError, match="no parameter set 'a_plausible_yaw'; did you mean 'A_plausible_yaw'"
    ):
        find("rars").parameter_set("a_plausible_yaw")


def test_equations_in_another_package_than_reported_are_missed() -> None:
    with pytest.raises(PlantError, match="is to stand in the package no_such_package: there is none"):
        ensure(Plant("lost", "no_such_package", PARAMETERS))


def test_a_path_leads_through_attributes_keys_and_names_of_rows() -> None:
    plant = Plant(
        "p", "p", (), {}, {"axes.right.gear_ratio": ("gear", 2.0), "geometry.base.gear_ratio": ("base", 1.0)}
    )
    assert plant.parameters_of(ROBOT) == {"gear": 54.0, "base": 3.0}


@pytest.mark.parametrize(
    ("path", "logged"),
    [
        ("axes.rigth.gear_ratio", "which has no 'rigth'; did you mean 'right'"),
        ("geometry.bas.gear_ratio", "which has no 'bas'; did you mean 'base'"),
        ("axes.left.gear_rate", "which has no 'gear_rate'; did you mean 'gear_ratio'"),
        ("axes.left.name", "that is no number"),
        ("axes.left", "that is no number"),
    ],
)
def test_a_path_that_leads_nowhere_is_reported_with_the_nearest(path: str, logged: str) -> None:
    with pytest.raises(UnknownNameError, match=f"takes '{path}' from the robot's file.*{logged}"):
        Plant("p", "p", (), {}, {path: ("gear", 1.0)}).parameters_of(ROBOT)


def test_a_plant_reports_its_variables_with_units_and_meaning() -> None:
    with FmuPlant(ensure("rars"), (), ()) as plant:
        reported = plant.variables
    assert reported["lift_height"].unit == "m"
    assert reported["lift_height"].description == "lift above its collapsed height"
    assert (reported["lift_height"].causality, reported["energy"].causality) == ("output", "local")
    model = find("rars").model()
    assert {row.name: row.unit for row in model.outputs}.items() <= {
        n: v.unit for n, v in reported.items()
    }.items()
