"""Errors of an FMU: the plant reports each in one message, and leaves nothing behind."""

import ctypes
import gc
import math
import tempfile
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from fmu.loading import forgotten, listened
from fmu.plant import FmuPlant, PlantError
from fmu.rars.interface import INPUTS, OUTPUTS, UNITS


def changed(original: Path, target: Path, change: Callable[[str], str], *, drop: str = "\0") -> Path:
    """Copy an FMU with another modelDescription.xml, without the files that start with `drop`."""
    with ZipFile(original) as source, ZipFile(target, "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = change(content.decode()).encode()
            if not name.startswith(drop):
                archive.writestr(name, content)
    return target


def opened(path: Path, **options: Any) -> FmuPlant:
    options = {"units": UNITS} | options
    return FmuPlant(path, list(INPUTS), list(OUTPUTS), **options)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(PlantError, match=r"nowhere\.fmu: there is no such file"):
        opened(tmp_path / "nowhere.fmu")


def test_not_an_fmu(tmp_path: Path) -> None:
    path = tmp_path / "plain.fmu"
    path.write_text("not a zip")
    with pytest.raises(PlantError, match=r"plain\.fmu: not an FMU"):
        opened(path)
    with ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "no description")
    with pytest.raises(PlantError, match=r"no modelDescription\.xml"):
        opened(path)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name="voltage_lift"', 'name="voltage_lifts"', "lacks the input 'voltage_lift'.*'voltage_lifts'"),
        ('name="rack"', 'name="zahnstange"', "lacks the output 'rack'"),
        ('<Unit name="rad/s">', '<Unit name="turns/s">', "not valid"),
        ('fmiVersion="', 'fmiVersion="9', "not valid|not supported"),
    ],
)
def test_wrong_description(  # noqa: PLR0917 - a row and its fixtures
    fmu_file: dict[int, Path], tmp_path: Path, fmi: int, old: str, new: str, message: str
) -> None:
    path = changed(fmu_file[fmi], tmp_path / "odd.fmu", lambda xml: xml.replace(old, new))
    with pytest.raises(PlantError, match=rf"odd\.fmu.*({message})"):
        opened(path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_wrong_unit(fmu_file: dict[int, Path], tmp_path: Path, fmi: int) -> None:
    with pytest.raises(PlantError, match="'rack' is in 'm', but 'V' was expected"):
        opened(fmu_file[fmi], units={"rack": "V"})
    # Another spelling of the same unit is the same unit.
    same = changed(fmu_file[fmi], tmp_path / "s.fmu", lambda xml: xml.replace('"rad/s"', '"rad.s-1"'))
    opened(same).close()
    # A factor makes it another one.
    other = changed(
        fmu_file[fmi],
        tmp_path / "o.fmu",
        lambda xml: xml.replace('"rad/s"', '"rpm"').replace(
            's="-1" rad="1"', 's="-1" rad="1" factor="0.1047"'
        ),
    )
    with pytest.raises(PlantError, match="'speed_left' is in 'rpm', but 'rad/s' was expected"):
        opened(other)


def test_wrong_causality(fmu_file: dict[int, Path]) -> None:
    with pytest.raises(PlantError, match="'rack' has causality 'output', but the plant's input was expected"):
        FmuPlant(fmu_file[3], ["rack"], [])
    with pytest.raises(PlantError, match="'slope' has causality 'parameter', but the plant's output"):
        FmuPlant(fmu_file[3], [], ["slope"])


def test_wrong_parameters(fmu_file: dict[int, Path]) -> None:
    with pytest.raises(
        PlantError, match="lacks the parameter 'platform_mas'; the nearest name is 'platform_mass'"
    ):
        opened(fmu_file[3], parameters={"platform_mas": 70.0})
    with pytest.raises(PlantError, match="'energy' is no parameter"):
        opened(fmu_file[3], parameters={"energy": 70.0})


@pytest.mark.parametrize("fmi", [2, 3])
def test_parameters_that_contradict_each_other(fmu_file: dict[int, Path], fmi: int) -> None:
    with pytest.raises(PlantError, match=r"cannot be initialised.*parameters contradict"):
        opened(fmu_file[fmi], parameters={"lift_link_length": 0.0})
    with pytest.raises(PlantError, match=r"cannot be initialised.*platform_mass cannot be nan"):
        opened(fmu_file[fmi], parameters={"platform_mass": math.nan})


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_binary_for_this_machine(fmu_file: dict[int, Path], tmp_path: Path, fmi: int) -> None:
    path = changed(fmu_file[fmi], tmp_path / "bare.fmu", lambda xml: xml, drop="binaries")
    with pytest.raises(PlantError, match=r"bare\.fmu: no binary for this machine.*it holds: none"):
        opened(path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_wrong_token_is_refused_by_the_fmu(fmu_file: dict[int, Path], tmp_path: Path, fmi: int) -> None:
    path = changed(
        fmu_file[fmi],
        tmp_path / "token.fmu",
        lambda xml: xml.replace('guid="{', 'guid="{0').replace('Token="{', 'Token="{0'),
    )
    with pytest.raises(PlantError, match="cannot be instantiated: instantiate: the token is not"):
        opened(path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_step_that_fails_names_the_time_and_the_reason(fmu_file: dict[int, Path], fmi: int) -> None:
    with opened(fmu_file[fmi]) as plant:
        for _ in range(25):
            plant.step()
        plant.inputs[1] = 1e300
        with pytest.raises(
            PlantError, match=r"doStep failed at 0\.0025 s \(error\): \w+ ran away between 0\.0025 s"
        ):
            plant.step()
        with pytest.raises(PlantError, match=r"setting the inputs failed at 0\.0025 s.*state 'failed'"):
            plant.step()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_voltage_that_is_no_number(fmu_file: dict[int, Path], fmi: int) -> None:
    with opened(fmu_file[fmi]) as plant:
        plant.inputs[0] = math.nan
        with pytest.raises(PlantError, match=r"setting the inputs failed.*voltage_left cannot be nan"):
            plant.step()


@pytest.mark.parametrize("fmi", [2, 3])
def test_closing_leaves_nothing_behind(
    fmu_file: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmi: int
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    plant = opened(fmu_file[fmi])
    assert len(list(tmp_path.iterdir())) == 1
    plant.close()
    plant.close()
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(PlantError, match="the plant is closed"):
        plant.step()
    with pytest.raises(PlantError, match="the plant is closed"):
        plant.read("rack")
    # Neither does a plant that is forgotten, or one that could not be made.
    del plant
    opened(fmu_file[fmi])
    gc.collect()
    with pytest.raises(PlantError):
        opened(fmu_file[fmi], parameters={"lift_link_length": 0.0})
    assert list(tmp_path.iterdir()) == []


def test_two_plants_do_not_know_each_other(fmu_file: dict[int, Path]) -> None:
    with opened(fmu_file[3]) as one, opened(fmu_file[3]) as other, opened(fmu_file[2]) as third:
        one.inputs[0] = 12.0
        for _ in range(100):
            one.step()
            other.step()
            third.step()
        assert one.read("speed_left") > 10
        assert other.read("speed_left") == third.read("speed_left") == 0.0


def test_read_of_an_unknown_variable(fmu_file: dict[int, Path]) -> None:
    with opened(fmu_file[3]) as plant, pytest.raises(PlantError, match="lacks the variable 'nothing'"):
        plant.read("nothing")


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_library_that_cannot_be_loaded_leaves_the_process_where_it_is(
    fmu_file: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmi: int
) -> None:
    with ZipFile(fmu_file[fmi]) as source, ZipFile(tmp_path / "odd.fmu", "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            binary = name.startswith("binaries/") and not name.endswith("/")
            archive.writestr(name, b"no library" if binary else source.read(name))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(PlantError, match=r"odd\.fmu: the FMU cannot be loaded"):
        opened(Path("odd.fmu"))
    assert Path.cwd() == tmp_path
    with pytest.raises(PlantError, match=r"odd\.fmu: the FMU cannot be loaded"):
        opened(Path("odd.fmu"))


def test_what_an_fmu_states_has_its_arguments_in_it() -> None:
    """FMI 2.0 hands a format and what follows to the master (section 2.1.5): called as an FMU calls it."""
    logged, others = deque[str](), deque[str]()
    (callbacks, number), (_, other) = listened(logged), listened(others)
    logger = ctypes.cast(callbacks.logger, ctypes.c_void_p).value
    assert logger is not None
    speak = ctypes.CFUNCTYPE(
        *(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
        *(ctypes.c_int, ctypes.c_char_p),
    )(logger)
    for status in (2, 0):
        speak(number, b"tank", status, b"logStatusError", b"%d of the %s are open, 100 %%", 3, b"valves")
    assert list(logged) == ["3 of the valves are open, 100 %"]
    assert not others
    for one in (number, other):
        forgotten(one)
