"""Model exchange: the same equations with the master's own solver, in both versions of FMI."""

from collections.abc import Callable
from ctypes import c_void_p
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException

from fmu.rars.interface import INPUTS, OUTPUTS
from hil_tests.fmu.instance import VERSIONS, Instance, Maker

ERROR = 3


def runge_kutta(model: Instance, h: float) -> None:
    """One step of the same method as in the FMU, in the same order of operations."""
    s = model.states()
    sums = rates = model.rates()
    for part, weight in ((0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
        model.set_states([x + part * h * rate for x, rate in zip(s, rates, strict=True)])
        rates = model.rates()
        sums = [total + weight * rate for total, rate in zip(sums, rates, strict=True)]
    model.set_states([x + h / 6.0 * total for x, total in zip(s, sums, strict=True)])


@VERSIONS
def test_the_same_step_gives_the_same_bits_in_both_interfaces(made: Maker, fmi: int) -> None:
    model, slave = made(fmi, "model"), made(fmi, "slave")
    for instance in (model, slave):
        instance.write(slope=0.05, heading=1.0, angle_lift=40.0)
        instance.initialize()
    generator = np.random.default_rng(5)
    for step in range(400):
        if step % 40 == 0:
            voltages = dict(zip(INPUTS, map(float, generator.uniform(-24, 24, 4)), strict=True))
            model.write(**voltages)
            slave.write(**voltages)
        slave.step(step * 1e-4)
        runge_kutta(model, 1e-4)
        model.fmu.setTime(step * 1e-4 + 1e-4)
        model.fmu.completedIntegratorStep()
        assert model.read(*OUTPUTS, "energy", "time") == slave.read(*OUTPUTS, "energy", "time"), step


def test_both_versions_give_the_same_rates(made: Maker) -> None:
    two, three = made(2, "model"), made(3, "model")
    two.initialize()
    three.initialize()
    assert two.state_names == three.state_names
    generator = np.random.default_rng(6)
    for _ in range(50):
        states = generator.uniform(-1, 1, len(two.state_names)).tolist()
        two.set_states(states)
        three.set_states(states)
        assert two.rates() == three.rates()
        assert two.rates() == two.read(*(f"der({name})" for name in two.state_names))


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_a_third_party_solver_comes_to_the_same_place(fmu_file: dict[int, Path], fmi: int) -> None:
    fields = [("time", np.float64), *((name, np.float64) for name in INPUTS)]
    driven = np.array([(0.0, 5.0, 7.0, 6.0, 12.0), (0.5, 5.0, 7.0, 6.0, 12.0)], dtype=np.dtype(fields))
    ends = [
        simulate_fmu(
            str(fmu_file[fmi]),
            validate=False,
            fmi_type=kind,
            stop_time=0.5,
            output_interval=0.01,
            step_size=0.01,
            relative_tolerance=1e-8,
            input=driven,
            output=list(OUTPUTS),
        )[-1]
        for kind in ("ModelExchange", "CoSimulation")
    ]
    for name in OUTPUTS:
        assert ends[0][name] == pytest.approx(ends[1][name], rel=2e-5, abs=2e-6), name
    assert ends[0]["speed"] > 0.05


@VERSIONS
def test_nominal_values_of_the_states_are_those_of_the_description(made: Maker, fmi: int) -> None:
    model = made(fmi, "model")
    rows = {row.name: row for row in model.description.modelVariables}
    assert model.nominals() == [float(rows[name].nominal) for name in model.state_names]
    assert dict(zip(model.state_names, model.nominals(), strict=True))["speed_left"] == 100.0


@VERSIONS
def test_the_event_functions_find_no_events(made: Maker, fmi: int) -> None:
    model = made(fmi, "model")
    model.begin()
    model.fmu.exitInitializationMode()
    fmu = model.fmu
    update = fmu.newDiscreteStates if fmi == 2 else fmu.updateDiscreteStates
    assert not any(update())
    fmu.enterContinuousTimeMode()
    assert not any(fmu.completedIntegratorStep())
    fmu.enterEventMode()
    assert not any(update())
    fmu.enterContinuousTimeMode()
    model.rates()


def refused(model: Instance, action: Callable[..., object], *arguments: object) -> str:
    with pytest.raises(FMICallException):
        action(*arguments)
    return model.logged[-1][2]


@VERSIONS
def test_a_model_is_no_slave_and_the_other_way_round(made: Maker, fmi: int) -> None:
    model, slave = made(fmi, "model"), made(fmi, "slave")
    assert "not allowed in state 'instantiated'" in refused(model, model.rates)
    assert "not allowed in state 'instantiated'" in refused(model, model.fmu.enterContinuousTimeMode)
    model.begin()
    model.fmu.exitInitializationMode()
    assert "not allowed in state 'event mode'" in refused(model, model.set_states, model.states())
    assert "not allowed in state 'event mode'" in refused(model, model.fmu.completedIntegratorStep)
    model.fmu.enterContinuousTimeMode()
    update = model.fmu.newDiscreteStates if fmi == 2 else model.fmu.updateDiscreteStates
    assert "not allowed in state 'continuous-time mode'" in refused(model, update)
    model.fmu.terminate()
    assert "not allowed in state 'terminated'" in refused(model, model.fmu.enterEventMode)
    assert model.rates()
    slave.initialize()
    # A slave's library has the functions of a model; the instance refuses them.
    function = getattr(slave.fmu.dll, f"fmi{fmi}EnterContinuousTimeMode")
    assert function(c_void_p(slave.component)) == ERROR
    assert "not allowed in state 'step mode'" in slave.logged[-1][2]
    slave.step(0.0)


@VERSIONS
def test_a_solver_that_goes_astray_is_reported(made: Maker, fmi: int) -> None:
    model = made(fmi, "model")
    model.initialize()
    good = model.states()
    model.set_states([1e200] * len(good))
    assert "the rate of" in refused(model, model.rates)
    assert model.logged[-1][:2] == (2, "logStatusDiscard")
    # Discarded, not failed: with other states it goes on.
    model.set_states(good)
    assert model.rates() == pytest.approx([0.0] * len(good), abs=1e-9)
    assert "cannot be nan" in refused(model, model.set_states, [float("nan")] * len(good))
    assert "state 'failed'" in refused(model, model.rates)
