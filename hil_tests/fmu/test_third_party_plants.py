"""A plant of someone else in place of ours: it drives the robot, is refused, or its failure is reported."""

import platform
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest
import sympy as sp
from pythonfmu import FmuBuilder
from typer.testing import CliRunner

from emulators.bench.mission import Mission, Noise
from emulators.bench.operator import ScriptedOperator
from emulators.bench.step import Input
from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.gateway import Cluster
from emulators.rig import BRIDGE, OPERATOR_STATION, Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.robots.rars import RarsStep as Step
from emulators.servo.bank import plant_outputs
from emulators.servo.fmu_axes import SUPPLY
from emulators.wires import CanWire, DatagramWire
from emulators.world import World
from firmware_bridge.bridge import Bridge
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds
from fmu.build import export
from fmu.errors import PlantError
from fmu.export.model import Expression, Model, Output, Parameter, StateVariable
from fmu.export.model import Input as Voltage
from fmu.rars.interface import AXES, INPUTS, OUTPUTS
from fmu.verify import ComparisonResult

STEPS = (
    Step(at_s=0.0, title="where it stands", zero={"steering": 0.0, "lift": 0.0}),
    Step(at_s=3.0, title="arm", arm=True),
    Step(at_s=3.3, title="crawl", speed_mps=0.2),
    Step(at_s=3.6, title="steer", steer_deg=10.0),
)
MISSION = """
title = "crawl"
duration_s = 5.0

[[step]]
at_s = 0.0
title = "where it stands"
zero = { steering = 0.0, lift = 0.0 }

[[step]]
at_s = 3.0
title = "arm"
arm = true

[[step]]
at_s = 3.5
title = "crawl"
speed_mps = 0.05
"""

pytestmark = pytest.mark.skipif(
    platform.machine().lower() not in {"x86_64", "amd64"}, reason="PythonFMU has binaries for x86-64 only"
)


def tiny_robot() -> Model:
    """A second third party, of our own exporter: motors without windings' inductance, plain kinematics."""
    symbol = {name: sp.Symbol(name, real=True) for name in INPUTS}
    rates = {axis: sp.Symbol(f"speed_{axis}", real=True) for axis in AXES}
    angles = {axis: sp.Symbol(f"angle_{axis}", real=True) for axis in AXES}
    currents = {axis: sp.Symbol(f"current_{axis}", real=True) for axis in AXES}
    heading, limit = sp.Symbol("heading", real=True), sp.Symbol("wanted_speed", real=True)
    resistance = {"left": 0.1, "right": 0.1, "steer": 2.0, "lift": 9.0}
    inertia = {"left": 3e-4, "right": 3e-4, "steer": 2e-6, "lift": 1e-6}
    constant = {"left": 0.0385, "right": 0.0385, "steer": 0.0234, "lift": 0.025}
    states = []
    for axis in AXES:
        drop = symbol[f"voltage_{axis}"] - resistance[axis] * currents[axis] - constant[axis] * rates[axis]
        torque = constant[axis] * currents[axis]
        states += [
            StateVariable(f"current_{axis}", "A", sp.S.Zero, drop / (5e-4 * resistance[axis])),
            StateVariable(f"angle_{axis}", "rad", sp.S.Zero, rates[axis]),
            StateVariable(f"speed_{axis}", "rad/s", sp.S.Zero, torque / inertia[axis]),
        ]
    speed = (rates["left"] + rates["right"]) * 0.025 / 26
    yaw_rate = (rates["right"] - rates["left"]) * 0.125 / 26
    states += [
        StateVariable("x", "m", sp.S.Zero, speed * sp.cos(heading)),
        StateVariable("y", "m", sp.S.Zero, speed * sp.sin(heading)),
        StateVariable("heading", "rad", sp.S.Zero, yaw_rate),
    ]
    rack = angles["steer"] * 0.015 / 159
    special: dict[str, Expression] = {
        "speed": speed,
        "yaw_rate": yaw_rate,
        "rack": rack,
        "steer_left": sp.atan(rack / 0.03),
        "steer_right": sp.atan(rack / 0.03),
        "steer": sp.atan(rack / 0.03),
        "lift_height": angles["lift"] * 1e-5,
        "battery_voltage": limit,
    }
    return Model(
        name="tiny",
        description="Third party",
        parameters=(Parameter("wanted_speed", 24.0, "V", "the battery's voltage", "assumed"),),
        inputs=tuple(Voltage(name, unit, name, 24.0) for name, unit in INPUTS.items()),
        states=tuple(states),
        outputs=tuple(
            Output(name, unit, name, special.get(name, sp.Symbol(name, real=True)))
            for name, unit in OUTPUTS.items()
        ),
        inner_step=50e-6,
    )


@pytest.fixture(scope="module")
def new_stations(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("third_party")
    made = FmuBuilder.build_FMU(Path(__file__).with_name("third_party_robot.py"), dest=folder)
    found = {"PythonFMU": Path(made)}
    for fmi in (2, 3):
        found[f"tiny {fmi}"] = folder / f"tiny{fmi}.fmu"
        export(tiny_robot(), fmi, found[f"tiny {fmi}"], token="{tiny}")  # noqa: S106 - no password
    return found


def changed(original: Path, target: Path, *changes: tuple[str, str]) -> Path:
    """Copy an FMU with another description."""
    with ZipFile(original) as source, ZipFile(target, "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                text = content.decode()
                for old, new in changes:
                    text, count = re.subn(old, new, text)
                    assert count
                content = text.encode()
            archive.writestr(name, content)
    return target


def robot_with(**parameters: float) -> AnyRobot:
    robot = find("rars")
    plant = robot.plant.model_copy(update={"parameters": parameters})
    return robot.model_copy(update={"plant": plant})


class Process:
    """The emulated robot as a process of its own, which ends when its plant fails."""

    def __init__(self, cluster: Cluster) -> None:
        self.cluster = cluster
        self.logged = ""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return self.does(lambda: self.cluster.receive(packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        return self.does(lambda: self.cluster.wake(now))

    def does(self, act: Callable[[], Reaction]) -> Reaction:
        if self.logged:
            return Reaction()
        try:
            return act()
        except PlantError as error:
            self.logged = str(error)
            return Reaction()


def operator(robot: AnyRobot) -> ScriptedOperator:
    mission = Mission(title="a ride", duration_s=20, input=Input.STICK, noise=Noise(), step=STEPS)
    return ScriptedOperator(robot, BENCH_SETUP, mission, np.random.default_rng(0))


@pytest.fixture
def rigs() -> Iterator[list[Rig]]:
    made: list[Rig] = []
    yield made
    for rig in made:
        rig.finish()


@pytest.mark.long(keeps=["tiny 3"])
@pytest.mark.parametrize("who", ["PythonFMU", "tiny 2", "tiny 3"])
def test_a_third_party_plant_drives_the_robot(
    new_stations: dict[str, Path], rigs: list[Rig], who: str
) -> None:
    robot = robot_with()
    rigs.append(rig := Rig(robot, BENCH_SETUP, operator(robot), plant_path=new_stations[who]))
    rig.run(from_seconds(5.0))
    last = rig.samples[-1]
    assert last["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert last["steer_rad"] == pytest.approx(np.deg2rad(10.0), rel=0.03)
    assert last["heading_rad"] > 0.03
    assert last["odometry_x_m"] == pytest.approx(last["x_m"], rel=0.06)
    assert not [event for event in rig.interlock_events if event.ended is None]


@pytest.mark.long(beside="test_two_runs_with_one_seed_are_the_same_bytes")
def test_the_same_ride_twice_gives_the_same_bytes(new_stations: dict[str, Path], rigs: list[Rig]) -> None:
    robot = robot_with()
    for _ in range(2):
        rigs.append(rig := Rig(robot, BENCH_SETUP, operator(robot), plant_path=new_stations["PythonFMU"]))
        rig.run(from_seconds(3.6))
    assert rigs[0].world.trace_sha256 == rigs[1].world.trace_sha256
    assert rigs[0].samples == rigs[1].samples


@pytest.mark.parametrize("who", ["PythonFMU", "tiny 3"])
@pytest.mark.parametrize("name", ["voltage_steer", "current_left", "angle_lift", "battery_voltage"])
def test_a_plant_that_lacks_a_variable_is_refused_by_name(
    new_stations: dict[str, Path], tmp_path: Path, who: str, name: str
) -> None:
    path = changed(new_stations[who], tmp_path / "odd.fmu", (f'name="{name}"', f'name="{name}_x"'))
    with pytest.raises(PlantError, match=rf"odd\.fmu: the FMU lacks the \w+ '{name}'.*'{name}_x'"):
        devices(robot_with(), path)


@pytest.mark.parametrize("who", ["PythonFMU", "tiny 2", "tiny 3"])
def test_a_plant_that_lacks_a_variable_of_the_body_is_refused_by_whichever_client_looks_at_it(
    new_stations: dict[str, Path], tmp_path: Path, who: str
) -> None:
    path = changed(new_stations[who], tmp_path / "odd.fmu", ('name="yaw_rate"', 'name="yaw_rate_x"'))
    robot = robot_with()
    with pytest.raises(PlantError, match=r"odd\.fmu: the FMU lacks the output 'yaw_rate'.*'yaw_rate_x'"):
        Rig(robot, BENCH_SETUP, operator(robot), plant_path=path)
    # The drives do without it, whether the plant carries a fingerprint of that name or not.
    plant = devices(robot, path).plant
    assert plant.fingerprint is ComparisonResult.NONE
    plant.close()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_plant_in_another_unit_is_refused_by_name(
    new_stations: dict[str, Path], tmp_path: Path, fmi: int
) -> None:
    # Revolutions per minute in place of rad/s: the same dimension, another factor.
    path = changed(
        new_stations[f"tiny {fmi}"],
        tmp_path / "rpm.fmu",
        ('"rad/s"', '"rpm"'),
        ('s="-1" rad="1"', 's="-1" rad="1" factor="0.10471975511965977"'),
    )
    with pytest.raises(PlantError, match=r"rpm\.fmu: 'speed_left' is in 'rpm', but 'rad/s' was expected"):
        devices(robot_with(), path)


def test_a_plant_that_fails_under_way_ends_the_run_with_its_time(
    new_stations: dict[str, Path], rigs: list[Rig]
) -> None:
    robot = robot_with(fails_at=3.6)
    rigs.append(rig := Rig(robot, BENCH_SETUP, operator(robot), plant_path=new_stations["PythonFMU"]))
    with pytest.raises(PlantError, match=r"ThirdParty\.fmu: doStep failed at 3\.6000 s"):
        rig.run(from_seconds(5.0))
    # Up to that instant everything is as it was.
    assert rig.samples[-1].at == from_seconds(3.6)
    assert rig.samples[-1]["speed_mps"] > 0.15


def test_when_the_emulated_robot_dies_of_its_plant_the_bridge_is_safe(new_stations: dict[str, Path]) -> None:
    robot = robot_with(fails_at=3.6)
    emulated = devices(robot, new_stations["PythonFMU"])
    bus, air = (
        CanWire(Epos2Link.of_link(robot, "drives").bit_rate),
        DatagramWire(0, 0, 0.0, np.random.default_rng(0)),
    )
    bridge, world = Bridge(robot, ROBOT_TYPE), World()
    process = Process(Cluster(emulated.nodes(Epos2), emulated.physics))
    world.attach("emulator", process, {CAN: bus})
    world.attach(BRIDGE, bridge, {"drives": bus, OPERATOR: air})
    world.attach(OPERATOR_STATION, operator(robot), {OPERATOR: air})
    targets: list[tuple[Nanoseconds, int]] = []

    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        if sender == BRIDGE and packet.address in {0x501, 0x502}:  # controlword and target velocity
            targets.append((now, int.from_bytes(packet.payload[2:], "little", signed=True)))

    bus.observe(note)
    failed_at = round(3.6 * SECOND)
    world.run(failed_at + 1 * SECOND)
    emulated.plant.close()
    assert re.search(r"doStep failed at 3\.6000 s", process.logged)
    assert [target for at, target in targets if at < failed_at][-1] > 0
    late = [target for at, target in targets if at > failed_at + 500 * MILLISECOND]
    assert set(late) == {0}
    assert bridge.seen.commanded.speed_mps == 0.0
    assert {f"axis timeout: {axis}" for axis in AXES} <= {event.name for event in bridge.interlock_events}


def test_the_command_line_states_it_in_one_line(new_stations: dict[str, Path], tmp_path: Path) -> None:
    mission = tmp_path / "crawl.toml"
    mission.write_text(MISSION, encoding="utf-8")
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    own = tmp_path / "own.toml"
    own.write_text(text.replace("[plant]\n", "[plant]\nparameters = { fails_at = 3.25 }\n"), encoding="utf-8")
    words = ["bench", str(own), "-m", str(mission), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(program, [*words, "--plant", str(new_stations["PythonFMU"])])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert re.match(r"firmware-bridge: .*ThirdParty\.fmu: doStep failed at 3\.2500 s", line)


def test_foreign_nodes_need_no_more_than_the_bench_reads(new_stations: dict[str, Path]) -> None:
    with ZipFile(new_stations["PythonFMU"]) as archive:
        text = archive.read("modelDescription.xml").decode()
    names = set(re.findall(r'name="(\w+)"', text))
    assert names >= {*INPUTS, *plant_outputs(AXES), SUPPLY}
    assert "steer_left" not in names
