"""Wrong and vain calls of a master, each of which is reported to it: NULLs, changed bytes, missing modes."""

from collections.abc import Callable
from ctypes import byref, c_bool, c_char_p, c_double, c_size_t, c_uint32, c_void_p, create_string_buffer
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET
from zipfile import ZipFile

import pytest
from fmpy.fmi1 import FMICallException

from fmu.platforms import FLAGS
from hil_tests.fmu.instance import VERSIONS, Instance, Maker

ERROR, ONE = 3, c_size_t(1)
REFERENCES, VALUES = (c_uint32 * 1)(1), (c_double * 40)()
STATES = c_size_t(34)
Call = tuple[str, tuple[Any, ...]]
CONTINUOUS: Final[dict[int, tuple[Call, ...]]] = {
    2: (
        ("CompletedIntegratorStep", (1, None, byref(c_bool()))),
        ("CompletedIntegratorStep", (1, byref(c_bool()), None)),
        ("SetContinuousStates", (None, STATES)),
        ("GetContinuousStates", (None, STATES)),
        ("GetDerivatives", (None, STATES)),
        ("GetNominalsOfContinuousStates", (None, STATES)),
        ("GetDirectionalDerivative", (None, ONE, REFERENCES, ONE, VALUES, VALUES)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, None, ONE, VALUES, VALUES)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, REFERENCES, ONE, None, VALUES)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, REFERENCES, ONE, VALUES, None)),
    ),
    3: (
        ("CompletedIntegratorStep", (1, None, byref(c_bool()))),
        ("CompletedIntegratorStep", (1, byref(c_bool()), None)),
        ("SetContinuousStates", (None, STATES)),
        ("GetContinuousStates", (None, STATES)),
        ("GetContinuousStateDerivatives", (None, STATES)),
        ("GetNominalsOfContinuousStates", (None, STATES)),
        ("GetNumberOfContinuousStates", (None,)),
        ("GetNumberOfEventIndicators", (None,)),
        ("GetDirectionalDerivative", (None, ONE, REFERENCES, ONE, VALUES, ONE, VALUES, ONE)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, None, ONE, VALUES, ONE, VALUES, ONE)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, REFERENCES, ONE, None, ONE, VALUES, ONE)),
        ("GetDirectionalDerivative", (REFERENCES, ONE, REFERENCES, ONE, VALUES, ONE, None, ONE)),
    ),
}
"""Calls in continuous time, with a NULL in each place in turn."""
STEPPING: Final[dict[int, tuple[Call, ...]]] = {
    2: (
        ("SetReal", (None, ONE, VALUES)),
        ("SetReal", (REFERENCES, ONE, None)),
        ("GetReal", (None, ONE, VALUES)),
        ("GetReal", (REFERENCES, ONE, None)),
        ("SetDebugLogging", (1, ONE, None)),
        ("GetFMUstate", (None,)),
        ("SetFMUstate", (None,)),
        ("SerializedFMUstateSize", (None, byref(c_size_t()))),
        ("SerializedFMUstateSize", (VALUES, None)),
        ("SerializeFMUstate", (None, VALUES, ONE)),
        ("SerializeFMUstate", (VALUES, None, ONE)),
        ("DeSerializeFMUstate", (None, ONE, byref(c_void_p()))),
        ("DeSerializeFMUstate", (VALUES, ONE, None)),
    ),
    3: (
        ("SetFloat64", (None, ONE, VALUES, ONE)),
        ("SetFloat64", (REFERENCES, ONE, None, ONE)),
        ("GetFloat64", (None, ONE, VALUES, ONE)),
        ("GetFloat64", (REFERENCES, ONE, None, ONE)),
        ("SetDebugLogging", (c_bool(), ONE, None)),
        ("GetFMUState", (None,)),
        ("SetFMUState", (None,)),
        ("SerializedFMUStateSize", (None, byref(c_size_t()))),
        ("SerializedFMUStateSize", (VALUES, None)),
        ("SerializeFMUState", (None, VALUES, ONE)),
        ("SerializeFMUState", (VALUES, None, ONE)),
        ("DeserializeFMUState", (None, ONE, byref(c_void_p()))),
        ("DeserializeFMUState", (VALUES, ONE, None)),
    ),
}
"""Calls in a step's pause, likewise."""


def refused(instance: Instance, name: str, arguments: tuple[Any, ...]) -> None:
    """Call it as C would; it must say that something is NULL, and go on."""
    instance.logged.clear()
    function = instance.fmu.dll[f"fmi{instance.fmi}{name}"]
    assert function(c_void_p(instance.component), *arguments) == ERROR, name
    ((status, category, text),) = instance.logged
    assert (status, category) == (ERROR, "logStatusError")
    assert f"{name}: the argument '" in text
    assert text.endswith("' is NULL")


@VERSIONS
def test_a_null_is_refused_and_does_no_harm(made: Maker, fmi: int) -> None:
    model, slave = made(fmi, "model"), made(fmi)
    model.initialize()
    slave.initialize()
    before = model.states()
    for name, arguments in CONTINUOUS[fmi]:
        refused(model, name, arguments)
    assert model.states() == before
    update = {2: ("NewDiscreteStates", (None,)), 3: ("UpdateDiscreteStates", (None,) * 6)}[fmi]
    model.fmu.enterEventMode()
    refused(model, *update)
    for name, arguments in STEPPING[fmi]:
        refused(slave, name, arguments)
    slave.step(0.0)


@VERSIONS
def test_nothing_to_read_needs_no_place(made: Maker, fmi: int) -> None:
    slave = made(fmi)
    slave.initialize()
    none = c_size_t(0)
    name, arguments = {
        2: ("fmi2GetReal", (None, none, None)),
        3: ("fmi3GetFloat64", (None, none, None, none)),
    }[fmi]
    assert slave.fmu.dll[name](c_void_p(slave.component), *arguments) == 0


@VERSIONS
def test_a_saved_state_with_any_byte_changed_is_refused(made: Maker, fmi: int) -> None:
    plant = made(fmi)
    plant.initialize()
    plant.step(0.0)
    state = plant.save()
    good = plant.to_bytes(state)
    function = plant.fmu.dll[{2: "fmi2DeSerializeFMUstate", 3: "fmi3DeserializeFMUState"}[fmi]]
    component, size, place = c_void_p(plant.component), c_size_t(len(good)), c_void_p()
    buffer = create_string_buffer(good, len(good))
    for index in range(len(good)):
        buffer[index] = bytes([good[index] ^ 1 << index % 8])
        assert function(component, buffer, size, byref(place)) == ERROR, index
        assert place.value is None
        buffer[index] = good[index : index + 1]
    plant.restore(again := plant.from_bytes(good))
    plant.step(1e-4)
    for kept in (state, again):
        plant.release(kept)


@VERSIONS
@pytest.mark.parametrize("kind", ["slave", "model"])
def test_nothing_hangs_on_the_time(made: Maker, fmi: int, kind: str) -> None:
    plant = made(fmi, kind)
    plant.initialize()
    plant.write(voltage_left=12.0)
    assert plant.slopes(["speed", "rack"], ["time"], [1.0]) == [0.0, 0.0]
    alone = plant.slopes(["der(current_left)"], ["voltage_left"], [1.0])
    assert plant.slopes(["der(current_left)"], ["time", "voltage_left"], [5.0, 1.0]) == alone


def reported(path: Path, folder: Path, **requested: bool) -> tuple[bool, list[tuple[int, str]]]:
    """Instantiate for co-simulation in FMI 3.0; return the success, and the logged messages."""
    instance = Instance(path, folder, logging=True)
    instance.logged.clear()
    logged: list[tuple[int, str]] = []
    try:
        instance.fmu.instantiate(
            loggingOn=True,
            logMessage=lambda _e, status, _c, text: logged.append((status, text.decode())),
            **requested,
        )
    except Exception:  # noqa: BLE001 - FMPy has no class of its own for it
        return False, logged
    instance.fmu.freeInstance()
    return True, logged


def test_modes_that_there_are_not_are_answered(fmu_file: dict[int, Path], tmp_path: Path) -> None:
    made, logged = reported(fmu_file[3], tmp_path / "plain")
    assert (made, logged) == (True, [(0, "instantiated for co-simulation")])
    made, logged = reported(fmu_file[3], tmp_path / "events", eventModeUsed=True)
    assert not made
    ((status, text),) = logged
    assert status == ERROR
    assert "eventModeUsed" in text
    assert "hasEventMode" in text
    made, logged = reported(fmu_file[3], tmp_path / "early", earlyReturnAllowed=True)
    assert made
    assert logged[-1] == (1, "earlyReturnAllowed is true, but no step here returns early")


def test_the_build_description_names_the_flags_of_the_binary(fmu_file: dict[int, Path]) -> None:
    with ZipFile(fmu_file[3]) as archive:
        tree = ET.fromstring(archive.read("sources/buildDescription.xml"))  # noqa: S314 - our own
    (files,) = tree.iter("SourceFileSet")
    assert (files.get("compiler"), files.get("compilerOptions")) == ("gcc", " ".join(FLAGS))


@pytest.fixture
def swinging(pendulums: Callable[[int], Path], tmp_path: Path) -> Callable[[int], Instance]:
    def make(fmi: int) -> Instance:
        return Instance(pendulums(fmi), tmp_path / str(fmi), logging=True)

    return make


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_a_very_long_step_is_subdivided(swinging: Callable[[int], Instance], fmi: int) -> None:
    """1001 s of a model with inner steps of 1 ms: once above a million steps, once in pieces below."""
    once, pieces = swinging(fmi), swinging(fmi)
    once.initialize()
    pieces.initialize()
    once.step(0.0, 1001.0)
    for start in range(0, 1001, 91):
        pieces.step(float(start), 91.0)
    assert once.read("time") == pieces.read("time") == [1001.0]
    assert once.read("angle", "height") == pieces.read("angle", "height")
    with pytest.raises(FMICallException):
        once.step(1001.0, float("inf"))
    assert "a step of inf s is not possible" in once.logged[-1][2]
    for instance in (once, pieces):
        instance.fmu.freeInstance()


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_a_very_long_step_that_runs_away_ends_soon(swinging: Callable[[int], Instance], fmi: int) -> None:
    instance = swinging(fmi)
    instance.write(length=1e-300)
    instance.begin()
    instance.write(length=1e-9, angle=1.0)
    instance.fmu.exitInitializationMode()
    instance.write(force=1e300)
    # Taken to its end it would be 10^8 inner steps.
    with pytest.raises(FMICallException):
        instance.step(0.0, 1e5)
    assert "ran away between 0 s and 100000 s" in instance.logged[-1][2]
    instance.fmu.freeInstance()


def test_a_name_is_needed(fmu_file: dict[int, Path], tmp_path: Path) -> None:
    make = Instance(fmu_file[3], tmp_path / "unzipped").fmu.dll["fmi3InstantiateCoSimulation"]
    make.restype = c_void_p
    for name, token in ((None, c_char_p(b"{}")), (c_char_p(b"one"), None)):
        no = c_bool()
        assert make(name, token, None, no, no, no, no, None, c_size_t(0), None, None, None) is None
