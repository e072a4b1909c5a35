"""Directional derivatives against central differences, and the listed dependencies against both."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from fmu.rars.interface import AXES, INPUTS, OUTPUTS
from hil_tests.fmu.instance import Instance

SPREAD = {"current": 5.0, "angle": 300.0, "speed": 200.0, "friction": 0.9, "x": 1.0, "y": 1.0, "heading": 3.0}
SPREAD |= {"drift": 0.2, "yaw": 1.0, "spin": 10.0, "rolling": 0.9, "tyre": 1e-4}
STEP = {
    "current": 1e-4,
    "angle": 1e-4,
    "speed": 1e-4,
    "friction": 1e-6,
    "x": 1e-4,
    "y": 1e-4,
    "heading": 1e-5,
    "drift": 1e-6,
    "yaw": 1e-6,
    "spin": 1e-5,
    "rolling": 1e-6,
    "tyre": 1e-9,
}
PLATFORM = {"speed": (0.5, 1e-6)}
"""Spread and step of a state that has a prefix alone for its name."""
INNER = (
    "slip_ahead_rear_left",
    "slip_left_front_right",
    "force_ahead_front_left",
    "force_left_rear_right",
    "energy",
)


@pytest.fixture(params=[2, 3])
def model(request: pytest.FixtureRequest, fmu_file: dict[int, Path], tmp_path: Path) -> Iterator[Instance]:
    made = Instance(fmu_file[request.param], tmp_path / "unzipped", "model")
    yield made
    made.fmu.freeInstance()


def random_states(model: Instance, generator: np.random.Generator) -> list[float]:
    """States away from corners: the rack and the lift may lean on their stops, and no speed is near 0."""
    states = []
    for name in model.state_names:
        spread = PLATFORM[name][0] if name in PLATFORM else SPREAD[name.partition("_")[0]]
        value = float(generator.uniform(-spread, spread))
        if name == "angle_lift":
            value = abs(value)  # below its lower stop the scissor has no shape
        states.append(value if not name.startswith("speed_") or abs(value) > 1.0 else 1.0)
    return states


def step_of(name: str) -> float:
    return PLATFORM[name][1] if name in PLATFORM else STEP[name.partition("_")[0]]


def test_slopes_are_those_of_central_differences(model: Instance) -> None:
    model.initialize()
    names = model.state_names
    unknowns = [*(f"der({name})" for name in names), *OUTPUTS, *INNER]
    generator = np.random.default_rng(11)
    for _ in range(12):
        states = random_states(model, generator)
        voltages = dict(zip(INPUTS, map(float, generator.uniform(-20, 20, 4)), strict=True))
        model.write(**voltages)
        for known in (*names, *INPUTS):
            h = step_of(known) if known in names else 1e-3
            sides = []
            for side in (-1, 1, -2, 2):
                moved = states.copy()
                if known in names:
                    moved[names.index(known)] += side * h
                else:
                    model.write(**{known: voltages[known] + side * h})
                model.set_states(moved)
                sides.append(np.array(model.read(*unknowns)))
            model.write(**voltages)
            model.set_states(states)
            # Central difference of 4th order.
            difference = (8 * (sides[1] - sides[0]) - (sides[3] - sides[2])) / (12 * h)
            exact = np.array(model.slopes(unknowns, [known], [1.0]))
            assert np.isfinite(exact).all()
            noise = 1e-13 * np.abs(sides[0]) / h
            wrong = np.abs(exact - difference) > 2e-6 * np.abs(difference) + 20 * noise + 1e-9
            assert not wrong.any(), [
                (known, unknowns[i], exact[i], difference[i]) for i in np.flatnonzero(wrong)
            ]


def test_slopes_add_up_along_a_direction(model: Instance) -> None:
    model.initialize()
    names, generator = model.state_names, np.random.default_rng(3)
    model.set_states(random_states(model, generator))
    knowns = [*names, *INPUTS]
    unknowns = [f"der({name})" for name in names]
    seed = generator.uniform(-1, 1, len(knowns)).tolist()
    columns = [np.array(model.slopes(unknowns, [known], [1.0])) for known in knowns]
    together = sum(weight * column for weight, column in zip(seed, columns, strict=True))
    assert model.slopes(unknowns, knowns, seed) == pytest.approx(together, rel=1e-12, abs=1e-9)
    # A known that comes twice counts twice.
    twice = model.slopes(unknowns, ["speed_left", "speed_left"], [1.0, 0.5])
    assert twice == pytest.approx((1.5 * columns[names.index("speed_left")]).tolist())


def test_what_is_not_listed_as_a_dependency_has_no_slope(model: Instance) -> None:
    model.initialize()
    knowns = [*model.state_names, *INPUTS]
    generator = np.random.default_rng(4)
    points = []
    for _ in range(6):
        model.set_states(random_states(model, generator))
        rows = [*model.description.outputs, *model.description.derivatives]
        unknowns = [row.variable.name for row in rows]
        points.append(np.array([model.slopes(unknowns, [known], [1.0]) for known in knowns]))
    least, most = np.min(points, axis=0), np.max(points, axis=0)
    for column, row in enumerate(rows):
        kinds = dict(zip((v.name for v in row.dependencies), row.dependenciesKind or (), strict=False))
        moving = {knowns[i] for i in np.flatnonzero(np.abs(most[:, column]) + np.abs(least[:, column]))}
        assert moving <= kinds.keys(), row.variable.name
        for name, kind in kinds.items():
            same = least[knowns.index(name), column] == most[knowns.index(name), column]
            assert same or kind == "dependent", (row.variable.name, name)
    listed = {row.variable.name: {v.name for v in row.dependencies} for row in rows}
    assert listed["lift_height"] == {"angle_lift"}
    assert listed["der(current_left)"] == {"current_left", "speed_left", "voltage_left"}
    assert "voltage_lift" in listed["battery_voltage"]


def test_at_initialization_parameters_and_start_values_are_known(model: Instance) -> None:
    model.begin()
    unknowns = ["battery_voltage", "friction_lift", "lift_height", "der(speed_lift)", "der(speed_left)"]
    points = {
        "battery_emf": 1e-3,
        "lift_mass": 1e-5,
        "screw_friction": 1e-6,
        "slope": 1e-4,
        "angle_lift": 1e-2,
    }
    model.write(angle_lift=50.0, slope=0.02, lift_mass=1.0)
    before = dict(zip(points, model.read(*points), strict=True))
    for known, h in points.items():
        sides = []
        for side in (1, -1):
            model.write(**{known: before[known] + side * h})
            sides.append(np.array(model.read(*unknowns)))
        model.write(**{known: before[known]})
        exact = model.slopes(unknowns, [known], [1.0])
        difference = (sides[0] - sides[1]) / (2 * h)
        assert exact == pytest.approx(difference, rel=1e-4, abs=1e-6), known
    initial = {
        row.variable.name: {v.name for v in row.dependencies} for row in model.description.initialUnknowns
    }
    assert {"screw_friction", "lift_mass", "angle_lift"} <= initial["friction_lift"]
    assert {f"der({name})" for name in model.state_names} <= initial.keys()
    assert initial.keys() >= {"friction_lift", "battery_voltage", "speed"}


@pytest.mark.parametrize(
    ("unknown", "known", "message"),
    [
        ("speed", "platform_mass", "platform_mass is no known of directional derivatives in this state"),
        ("speed", "battery_voltage", "battery_voltage is no known"),
        ("voltage_left", "voltage_left", "voltage_left is no unknown of directional derivatives"),
        ("slope", "voltage_left", "slope is no unknown"),
    ],
)
def test_what_has_no_slope_is_refused(model: Instance, unknown: str, known: str, message: str) -> None:
    model.initialize()
    with pytest.raises(FMICallException):
        model.slopes([unknown], [known], [1.0])
    assert message in model.logged[-1][2]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_slave_has_slopes_too(fmu_file: dict[int, Path], tmp_path: Path, fmi: int) -> None:
    slave = Instance(fmu_file[fmi], tmp_path / "unzipped", "slave")
    slave.initialize()
    slave.write(voltage_left=12.0)
    slave.step(0.0, 0.01)
    gears = [slave.slopes(["rack"], [f"angle_{axis}"], [1.0])[0] for axis in AXES]
    assert gears == pytest.approx([0.0, 0.0, 0.015 / 159, 0.0])
    slave.fmu.freeInstance()
