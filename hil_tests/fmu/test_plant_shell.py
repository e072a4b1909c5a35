"""The FMI shells: calls out of turn are refused with a message; states are saved, restored and reset."""

from collections.abc import Iterator
from ctypes import byref, c_bool, c_double
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.model_description import read_model_description


class Slave:
    """One instance with the same few verbs for both versions of FMI."""

    def __init__(self, path: Path, folder: Path, fmi: int) -> None:
        self.description = read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.logged: list[str] = []
        self.fmi = fmi
        options = {
            "guid": self.description.guid,
            "unzipDirectory": fmpy.extract(str(path), str(folder)).as_posix(),
            "modelIdentifier": "rars",
            "instanceName": "under test",
        }
        if fmi == 2:
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda *a: self.logged.append(a[-1].decode()))
            self.callbacks = callbacks
            self.fmu: Any = FMU2Slave(**options)
            self.fmu.instantiate(callbacks=callbacks)
        else:
            self.fmu = FMU3Slave(**options)
            self.fmu.instantiate(logMessage=lambda *a: self.logged.append(a[-1].decode()))

    def initialize(self) -> None:
        if self.fmi == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def write(self, name: str, value: float) -> None:
        (self.fmu.setReal if self.fmi == 2 else self.fmu.setFloat64)([self.references[name]], [value])

    def read(self, name: str) -> float:
        getter = self.fmu.getReal if self.fmi == 2 else self.fmu.getFloat64
        return float(getter([self.references[name]])[0])

    def step(self, at: float, length: float = 1e-4) -> None:
        if self.fmi == 2:
            self.fmu.doStep(at, length)
        else:
            yes, flags = c_bool(True), (c_bool(), c_bool(), c_bool())  # noqa: FBT003 - C
            self.fmu.fmi3DoStep(
                self.fmu.component, at, length, yes, *(byref(f) for f in flags), byref(c_double())
            )


@pytest.fixture(params=[2, 3])
def slave(request: pytest.FixtureRequest, fmu_file: dict[int, Path], tmp_path: Path) -> Iterator[Slave]:
    made = Slave(fmu_file[request.param], tmp_path / "unzipped", request.param)
    yield made
    made.fmu.freeInstance()


def refused(slave: Slave, action: Any, *arguments: Any) -> str:
    with pytest.raises(FMICallException):
        action(*arguments)
    return slave.logged[-1]


def test_calls_out_of_turn(slave: Slave) -> None:
    assert "DoStep is not allowed in state 'instantiated'" in refused(slave, slave.step, 0.0)
    assert "not allowed in state 'instantiated'" in refused(slave, slave.fmu.exitInitializationMode)
    assert "not allowed in state 'instantiated'" in refused(slave, slave.fmu.terminate)
    slave.initialize()
    assert "not allowed in state 'step mode'" in refused(slave, slave.fmu.enterInitializationMode)
    slave.step(0.0)
    slave.fmu.terminate()
    assert "DoStep is not allowed in state 'terminated'" in refused(slave, slave.step, 1e-4)
    assert slave.read("time") == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("wheel_mass", 0.5, "wheel_mass can be set only before the end of initialisation"),
        ("angle_left", 1.0, "angle_left can be set only before the end of initialisation"),
        ("energy", 1.0, "energy is computed and cannot be set"),
        ("time", 1.0, "value reference 0 can be set"),
        ("voltage_left", float("inf"), "voltage_left cannot be inf"),
    ],
)
def test_what_cannot_be_set_in_a_run(slave: Slave, name: str, value: float, message: str) -> None:
    slave.initialize()
    assert message in refused(slave, slave.write, name, value)
    assert "state 'failed'" in refused(slave, slave.step, 0.0)
    slave.fmu.reset()
    slave.initialize()
    slave.step(0.0)


@pytest.mark.parametrize(
    ("at", "length", "message"),
    [
        (0.5, 1e-4, "a step from 0.5 s was asked for, but the plant stands at 0 s"),
        (0.0, 0.0, "a step of 0 s is not possible"),
        (0.0, -1e-4, "is not possible"),
        (0.0, 1e9, "a step of 1e+09 s is not possible: above 0 to 10000 s; take it in parts"),
        (float("nan"), 1e-4, "was asked for"),
        (0.0, float("nan"), "is not possible"),
    ],
)
def test_steps_that_make_no_sense(slave: Slave, at: float, length: float, message: str) -> None:
    slave.initialize()
    assert message in refused(slave, slave.step, at, length)


def test_an_unknown_value_reference(slave: Slave) -> None:
    slave.references["nothing"] = 4_000_000
    assert "no variable with value reference 4000000" in refused(slave, slave.read, "nothing")


def test_parameters_take_effect_during_initialization(slave: Slave) -> None:
    slave.write("battery_emf", 25.5)
    assert slave.read("battery_voltage") == 25.5
    slave.write("angle_steer", 100.0)
    assert slave.read("rack") == pytest.approx(100.0 * 0.015 / 159)


def test_reset_is_a_new_beginning(slave: Slave) -> None:
    slave.write("platform_mass", 20.0)
    slave.initialize()
    slave.write("voltage_left", 12.0)
    slave.step(0.0, 0.01)
    slave.fmu.reset()
    assert slave.read("platform_mass") == 70.0
    slave.initialize()
    assert (slave.read("time"), slave.read("speed_left"), slave.read("voltage_left")) == (0.0, 0.0, 0.0)


def test_a_long_step_is_many_short_ones(slave: Slave) -> None:
    slave.initialize()
    slave.write("voltage_left", 12.0)
    slave.step(0.0, 0.02)
    once = slave.read("speed_left")
    slave.fmu.reset()
    slave.initialize()
    slave.write("voltage_left", 12.0)
    for i in range(200):
        slave.step(i * 1e-4)
    assert slave.read("speed_left") == pytest.approx(once, rel=1e-9)


def test_going_back_replays_the_same_bits(slave: Slave) -> None:
    names = ("speed_left", "y", "rack", "energy")
    slave.initialize()
    slave.write("voltage_right", 9.0)
    slave.step(0.0, 0.01)
    fmu = slave.fmu
    state = fmu.getFMUstate() if slave.fmi == 2 else fmu.getFMUState()
    serial = fmu.serializeFMUstate(state) if slave.fmi == 2 else fmu.serializeFMUState(state)
    slave.write("voltage_steer", 20.0)
    slave.step(0.01, 0.01)
    ahead = [slave.read(name) for name in names]
    (fmu.setFMUstate if slave.fmi == 2 else fmu.setFMUState)(state)
    assert slave.read("time") == 0.01
    slave.write("voltage_steer", 20.0)
    slave.step(0.01, 0.01)
    assert [slave.read(name) for name in names] == ahead
    again = fmu.deSerializeFMUstate(serial) if slave.fmi == 2 else fmu.deserializeFMUState(serial)
    (fmu.setFMUstate if slave.fmi == 2 else fmu.setFMUState)(again)
    slave.write("voltage_steer", 20.0)
    slave.step(0.01, 0.01)
    assert [slave.read(name) for name in names] == ahead
    for kept in (state, again):
        (fmu.freeFMUstate if slave.fmi == 2 else fmu.freeFMUState)(kept)


def test_absent_functions_say_so(slave: Slave) -> None:
    getter = slave.fmu.getInteger if slave.fmi == 2 else slave.fmu.getInt32
    assert getter([]) == []
    assert "is not allowed" in refused(slave, getter, [1])
