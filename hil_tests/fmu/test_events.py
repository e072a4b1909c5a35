"""Switches, events and tuning: what changes at an instant, in co-simulation and with a master's solver."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from xml.etree import ElementTree as ET
from zipfile import ZipFile

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.model_description import read_model_description

from fmu.build import ensure
from fmu.errors import PlantError
from fmu.plant import FmuPlant
from fmu.plants import find, names
from fmu.rars.interface import INPUTS
from fmu.single_axis.parameters import SETS
from hil_tests.fmu.instance import VERSIONS, Instance

SWITCHES = ("negative_limit_axis", "positive_limit_axis", "home_axis")
TUNABLE = {
    "rars": {
        "slope", "floor_friction", "rolling_resistance", "tyre_torque", "platform_mass", "lift_payload",
        "battery_emf", "battery_resistance",
    },
    "single_axis": {
        "load_inertia", "load_coulomb", "load_viscous", "unbalance", "battery_emf", "battery_resistance",
    },
}  # fmt: skip


def bench_axis(fmi: int, folder: Path, kind: str = "slave", **start: float) -> Instance:
    """The single axis between its stops, initialized."""
    instance = Instance(ensure("single_axis", fmi), folder / f"{fmi}", kind, logging=True)
    instance.write(**SETS["between_stops"], **start)
    instance.initialize()
    instance.logged.clear()
    return instance


@VERSIONS
def test_switches_are_discrete_and_bounded(fmi: int) -> None:
    rows = {row.name: row for row in read_model_description(str(ensure("single_axis", fmi))).modelVariables}
    for name in ("brake_axis", *SWITCHES):
        assert (rows[name].variability, float(rows[name].min), float(rows[name].max)) == (
            "discrete",
            0.0,
            1.0,
        )
    assert rows["voltage_axis"].variability == "continuous"
    assert rows["voltage_axis"].min is None
    assert float(rows["battery_voltage"].min) == 0.0


@VERSIONS
@pytest.mark.parametrize("model", TUNABLE)
def test_parameters_report_their_kind_bounds_and_size(model: str, fmi: int) -> None:
    rows = [
        row
        for row in read_model_description(str(ensure(model, fmi))).modelVariables
        if row.causality == "parameter"
    ]
    assert {row.name for row in rows if row.variability == "tunable"} == TUNABLE[model]
    for row in rows:
        start = float(row.start)
        assert row.variability in {"fixed", "tunable"}
        assert float(row.min if row.min is not None else -math.inf) <= start
        assert float(row.max if row.max is not None else math.inf) >= start
        assert row.nominal is None if start == 0 else float(row.nominal) == abs(start)
    bounded = {row.name for row in rows if row.min is not None}
    assert {row.name for row in rows if row.unit in {"kg", "kg.m2", "Ohm", "H", "N.m/A"}} <= bounded


@pytest.mark.parametrize("model", names())
def test_no_parameter_set_is_out_of_bounds(model: str) -> None:
    plant = find(model)
    for chosen in plant.sets.values():
        with FmuPlant(ensure(plant), (), (), chosen) as running:
            running.step()


@VERSIONS
def test_a_switch_beyond_its_ends_is_taken_at_the_nearest_and_reported_once(tmp_path: Path, fmi: int) -> None:
    axis = bench_axis(fmi, tmp_path)
    for value, taken, other in ((1.5, 1.0, 0.0), (-3.0, 0.0, 1.0)):
        axis.write(brake_axis=other)
        axis.logged.clear()
        for step in range(3):
            axis.write(brake_axis=value, voltage_axis=float(step))
        assert axis.read("brake_axis") == [taken]
        ((status, category, text),) = axis.logged
        assert (status, category) == (1, "logStatusWarning")
        assert text == f"brake_axis is a switch, 0 open to 1 closed: {value:g} is taken as {taken:g}"
    axis.step(0.0)
    axis.fmu.freeInstance()


@VERSIONS
@pytest.mark.parametrize(
    ("values", "logged"),
    [
        ({"load_inertia": -1e-9}, "load_inertia cannot be -1e-09: it is 0 or more"),
        ({"resistance_axis": -0.1}, "resistance_axis cannot be -0.1: it is 0 or more"),
    ],
)
def test_a_parameter_out_of_bounds_is_refused(
    tmp_path: Path, fmi: int, values: Mapping[str, float], logged: str
) -> None:
    axis = Instance(ensure("single_axis", fmi), tmp_path / "unzipped", logging=True)
    with pytest.raises(FMICallException):
        axis.write(**values)
    assert axis.logged[-1][2] == logged
    axis.fmu.freeInstance()


def test_a_bound_above_is_reported_too() -> None:
    with pytest.raises(PlantError, match=r"slope cannot be 1\.6: it is 1\.5 or less"):
        FmuPlant(ensure("rars"), (), (), {"slope": 1.6})


@VERSIONS
def test_in_continuous_time_neither_switch_nor_tuning_moves(tmp_path: Path, fmi: int) -> None:
    for name, logged in (
        ("brake_axis", "brake_axis is a switch: it can be set in event mode, not in continuous time"),
        ("load_coulomb", "load_coulomb can be tuned in event mode, not in continuous time"),
        ("backlash", "backlash can be set only before the end of initialisation"),
    ):
        model = bench_axis(fmi, tmp_path, "model")
        with pytest.raises(FMICallException):
            model.write(**{name: 0.5})
        assert model.logged[-1][2] == logged
        model.fmu.freeInstance()
    model = bench_axis(fmi, tmp_path, "model")
    before = model.states()
    model.fmu.enterEventMode()
    model.write(brake_axis=1.0, load_coulomb=0.5)
    (model.fmu.newDiscreteStates if fmi == 2 else model.fmu.updateDiscreteStates)()
    model.fmu.enterContinuousTimeMode()
    assert model.read("brake_axis", "load_coulomb") == [1.0, 0.5]
    assert model.states() == before
    model.fmu.freeInstance()


@VERSIONS
def test_in_continuous_time_a_switch_waits_for_its_event(tmp_path: Path, fmi: int) -> None:
    model = bench_axis(fmi, tmp_path, "model")
    states = model.states()
    place = model.state_names.index("load_angle")
    seen = []
    for angle in (0.3, 0.5, 1.95):
        states[place] = angle
        model.set_states(states)
        held = model.read(*SWITCHES)
        model.fmu.enterEventMode()
        there = model.read(*SWITCHES)
        (model.fmu.newDiscreteStates if fmi == 2 else model.fmu.updateDiscreteStates)()
        model.fmu.enterContinuousTimeMode()
        assert model.read(*SWITCHES) == there
        seen.append((held, there))
    assert seen == [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
    ]
    model.fmu.freeInstance()


@VERSIONS
def test_indicators_are_the_variables_that_the_description_names(tmp_path: Path, fmi: int) -> None:
    path = ensure("single_axis", fmi)
    with ZipFile(path) as archive:
        tree = ET.fromstring(archive.read("modelDescription.xml"))  # noqa: S314 - our own
    events = [event.name for event in find("single_axis").model().events]
    assert len(events) == 8
    if fmi == 2:
        assert tree.get("numberOfEventIndicators") == "8"
    else:
        (structure,) = tree.iter("ModelStructure")
        references = {row.get("valueReference"): row.get("name") for row in tree.iter("Float64")}
        rows = list(structure.iter("EventIndicator"))
        assert [references[row.get("valueReference")] for row in rows] == events
        reported = {references[row.get("valueReference")]: row.get("dependencies") for row in rows}
        (angle,) = [key for key, name in references.items() if name == "load_angle"]
        assert reported["past_stop_high"] == angle
    model = bench_axis(fmi, tmp_path, "model")
    states = model.states()
    states[model.state_names.index("load_angle")] = 0.5
    states[model.state_names.index("angle_axis")] = 26 * 0.515
    model.set_states(states)
    values = model.vector("getEventIndicators", len(events))
    assert values == model.read(*events)
    assert values == pytest.approx([0.005, -0.025, 1.5, -1.5, 1.4, -1.4, 0.1, -0.1])
    with pytest.raises(FMICallException):
        model.vector("getEventIndicators", 7)
    assert model.logged[-1][2] == "7 event indicators were asked for, but there are 8"
    model.fmu.freeInstance()


@VERSIONS
def test_a_solver_stops_where_a_switch_closes_and_where_a_stop_is_met(fmi: int) -> None:
    """CVode finds the edges; the switch closes there, and the load meets its stop as in co-simulation."""
    wanted = ("load_angle", "load_speed", "angle_axis", "home_axis", "positive_limit_axis")
    driven = np.array([(0.0, 4.0), (2.0, 4.0)], dtype=[("time", np.float64), ("voltage_axis", np.float64)])
    runs = {
        kind: simulate_fmu(
            str(ensure("single_axis", fmi)),
            validate=False,
            fmi_type=kind,
            stop_time=2.0,
            step_size=1e-3,
            output_interval=0.01,
            relative_tolerance=1e-8,
            start_values=SETS["between_stops"],
            input=driven,
            output=wanted,
            record_events=True,
        )
        for kind in ("ModelExchange", "CoSimulation")
    }
    rows = runs["ModelExchange"]
    for switch, edge in (("home_axis", 0.4), ("home_axis", 0.6), ("positive_limit_axis", 1.9)):
        turned = np.flatnonzero(np.diff(rows[switch]))
        nearest = min(abs(float(rows["load_angle"][i + 1]) - edge) for i in turned)
        assert nearest < 1e-6, (switch, edge)
    assert set(np.unique(rows["home_axis"])) == {0.0, 1.0}
    last, other = rows[-1], runs["CoSimulation"][-1]
    assert last["load_angle"] == pytest.approx(2.0, abs=0.01)
    for name in wanted:
        assert last[name] == pytest.approx(other[name], rel=1e-4, abs=1e-4), name


@VERSIONS
def test_tuning_in_a_run_moves_nothing_and_then_acts(tmp_path: Path, fmi: int) -> None:
    """Braked on a slope that the floor holds: it gets steeper, it slides; it gets rough, it stops."""
    rars = Instance(ensure("rars", fmi), tmp_path / "unzipped", logging=True)
    held = {f"coulomb_{axis}": 50.0 for axis in ("left", "right")}
    rars.write(slope=math.radians(8.0), **held)
    rars.initialize()
    rars.write(**dict.fromkeys(INPUTS, 0.0))
    rars.step(0.0, 0.5)
    names = ("x", "speed", "drift", "tyre_ahead_rear_left", "rack", "lift_height")
    standing = rars.read(*names)
    rars.write(slope=math.radians(14.0), battery_emf=20.0)
    assert rars.read(*names) == standing
    assert rars.read("battery_voltage") == [pytest.approx(20.0, abs=0.01)]
    rars.step(0.5, 0.5)
    assert rars.read("x")[0] < standing[0] - 0.02
    assert rars.read("speed")[0] < -0.1
    rars.write(floor_friction=0.9)
    rars.step(1.0, 1.0)
    assert rars.read("speed")[0] == pytest.approx(0.0, abs=1e-3)
    rars.fmu.freeInstance()


@VERSIONS
def test_a_tuned_value_is_part_of_a_kept_state(tmp_path: Path, fmi: int) -> None:
    axis = bench_axis(fmi, tmp_path, angle_axis=3.0)
    axis.step(0.0, 0.01)
    before = axis.save()
    axis.write(unbalance=50.0)
    axis.step(0.01, 0.01)
    pulled = axis.read("load_speed")
    axis.restore(before)
    assert axis.read("unbalance") == [0.0]
    axis.step(0.01, 0.01)
    free = axis.read("load_speed")
    axis.restore(before)
    axis.write(unbalance=50.0)
    axis.step(0.01, 0.01)
    assert axis.read("load_speed") == pulled != free
    axis.release(before)
    axis.fmu.freeInstance()


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_an_fmu_brings_its_version_license_and_equations(pendulums: Callable[[int], Path], fmi: int) -> None:
    with ZipFile(ensure("rars", fmi)) as archive:
        head = ET.fromstring(archive.read("modelDescription.xml"))  # noqa: S314 - our own
        page = archive.read("documentation/index.html").decode()
        licence = archive.read("documentation/licenses/license.txt").decode()
    assert head.get("version")
    assert head.get("author") == "The firmware-bridge authors"
    assert head.get("license") == "MIT"
    assert head.get("copyright", "no one") in licence
    assert "WITHOUT WARRANTY OF ANY KIND" in licence
    for word in ("lift_payload", "tunable", "voltage_steer", "N_front = ", "<h2>Parameters</h2>"):
        assert word in page
    # Equations without a package are documented as they are written.
    with ZipFile(pendulums(fmi)) as archive:
        page = archive.read("documentation/index.html").decode()
        assert not [name for name in archive.namelist() if "licenses" in name]
    assert "der(speed) = (force - 9.81*sin(angle))/length" in page
