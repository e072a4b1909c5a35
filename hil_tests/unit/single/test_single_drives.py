"""Drives without a robot: their default gains move the default motor; the command that brings them."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import pytest
from typer.testing import CliRunner

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.single import DrivesOrder, drives
from emulators.servo.axis import RAMP, TICK, ServoAxis
from emulators.servo.commands import regulate_velocity
from emulators.servo.fmu_axes import set_motor
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.cli import program
from firmware_bridge.cli.node_numbers import numbers
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from fmu.build import ensure
from fmu.errors import PlantError
from hil_tests.unit.world.players import Player

if TYPE_CHECKING:
    from fmu.plant import FmuPlant

MOVE = (
    (0x000, "0100"),
    (0x601, "2b02640001000000"),
    (0x201, "0600"),
    (0x201, "0F00"),
    (0x601, "237a6000409c0000"),
    (0x601, "2b4060001f000000"),
)


def refused(*words: str) -> str:
    result = CliRunner().invoke(program, ["emulate", "epos2", *words])
    assert result.exit_code == 2, result.output
    return result.stderr


@pytest.mark.parametrize("name", PROFILES)
def test_a_drive_of_any_type_turns_its_motor_with_its_default_gains(name: str) -> None:
    made, bank = drives(DrivesOrder((1,), PROFILES[name], 1_000_000))
    world, wire = World(bank), CanWire(1_000_000)
    drive = made["motor1"]
    master = Player(*((SECOND // 10 * k, Packet(CAN, a, bytes.fromhex(b))) for k, (a, b) in enumerate(MOVE)))
    world.attach("motor1", drive, {CAN: wire})
    world.attach("master", master, {CAN: wire})
    world.run(3 * SECOND)
    assert bank.axes[0].position == pytest.approx(40_000, abs=20)
    assert not [packet for _, packet in master.received if packet.address == 0x081], "no emergency"


def test_eight_drives_have_serial_numbers_of_their_own() -> None:
    made, _ = drives(DrivesOrder(range(1, 9), PROFILES["70/10"], 1_000_000))
    assert [drive.node_id for drive in made.values()] == list(range(1, 9))
    assert len({drive.profile.serial_number for drive in made.values()}) == 8


def test_the_axes_of_an_fmu_are_taken_by_their_names() -> None:
    order = DrivesOrder((3, 4), PROFILES["70/10"], 1_000_000, plant=ensure("rars"), axes=("left", "right"))
    made, bank = drives(order)
    assert list(made) == ["left", "right"]
    assert bank.advance(SECOND // 100) == (SECOND // 100, ())


def test_parameters_are_kept_in_a_file_for_each_node(tmp_path: Path) -> None:
    order = DrivesOrder((2,), PROFILES["70/10"], 1_000_000, parameters=tmp_path)
    (drive,) = drives(order)[0].values()
    drive.wake(0)
    drive.receive(Packet(CAN, 0x602, bytes.fromhex("2310100173617665")), 0)
    assert [path.name for path in tmp_path.iterdir()] == ["node-2.json"]


def test_numbers_are_read_as_lists_and_ranges() -> None:
    assert numbers("1") == (1,)
    assert numbers("1-3,7, 9-9") == (1, 2, 3, 7, 9)


@pytest.mark.parametrize("text", ["", "0", "128", "3-1", "1-", "a", "1,1", "1-3,2"])
def test_what_is_no_list_of_nodes_is_refused(text: str) -> None:
    assert f"--node {text}" in refused("--node", text)


def test_mistakes_are_answered_with_what_there_is() -> None:
    assert "24/2, 24/5, 36/2, 50/5, 50/5-6320, 70/10" in refused("--profile", "90/9")
    assert "800000" in refused("--bitrate", "100000")
    assert "INERTIA,FRICTION" in refused("--load", "1")
    assert "more than 0" in refused("--load", "0,0.1")
    assert "did you mean boot-time" in refused("--choice", "boot-tme=1s")
    assert "give yes or no" in refused("--choice", "reports-reset=perhaps")
    assert "one for each" in refused("--node", "1-2", "--axes", "left")
    assert "all begin as node 1" in refused("--node", "1-2", "--dip-off")
    assert "nowhere.fmu" in refused("--plant", "nowhere.fmu")


def test_a_file_that_holds_no_parameters_is_named(tmp_path: Path) -> None:
    (tmp_path / "node-1.json").write_text("{}")
    assert "node-1.json" in refused("--parameters", str(tmp_path), "-i", "virtual", "-c", "single")


@pytest.mark.parametrize("words", [(), ("--no-latency", "--node", "1-8", "--profile", "24/5")])
def test_the_command_brings_drives_onto_a_bus_and_ends_in_good_order(words: tuple[str, ...]) -> None:
    requested = ["emulate", "epos2", *words, "-i", "virtual", "-c", "single", "--duration", "0.2"]
    result = CliRunner().invoke(program, requested)
    assert result.exit_code == 0, result.output
    assert "ended: the time is over" in result.output


def test_a_robot_is_still_emulated_by_its_name_alone_options_in_front_or_behind() -> None:
    for words in (
        ["rars", "-i", "virtual", "-c", "single"],
        ["-i", "virtual", "-c", "single", "rars"],
        ["robot", "rars", "-i", "virtual", "-c", "single", "--realistic-latency"],
    ):
        result = CliRunner().invoke(program, ["emulate", *words, "--duration", "0.1"])
        assert result.exit_code == 0, result.output
        assert "rars is on the bus" in result.output


def test_parameters_of_the_plant_are_set_by_name() -> None:
    order = DrivesOrder(
        (1,),
        PROFILES["70/10"],
        1_000_000,
        plant=ensure("single_axis"),
        plant_parameters={"limit_low": 1.0},
        axes=("axis",),
    )
    _, bank = drives(order)
    bank.advance(SECOND // 100)
    assert bank.axes[0].pins == 1 << 5, "the load stands below the negative limit"


def test_a_parameter_needs_a_plant_and_a_value(tmp_path: Path) -> None:
    assert "--set a=1: there is no plant" in refused("--set", "a=1")
    assert "--set a: give NAME=VALUE" in refused("--plant", "single_axis", "--set", "a")
    assert f"{tmp_path}: it is a folder, not an FMU" in refused("--plant", str(tmp_path), "--set", "a=1")


def test_an_axis_is_reported_its_motor_by_the_plant_and_learns_only_what_the_plant_does_not_report() -> None:
    order = DrivesOrder((1,), PROFILES["70/10"], 1_000_000, plant=ensure("single_axis"), axes=("axis",))
    made, bank = drives(order)
    assert made
    (axis,) = bank.axes
    assert (
        axis.back_emf > 0,
        axis.decay_resistance > 0,
        axis.balance_resistance > axis.decay_resistance,
        axis.learning,
    ) == (
        True,
        True,
        True,
        0,
    )

    class Silent:
        def read(self, name: str) -> float:
            raise PlantError(f"no parameter {name}")

    unknown = ServoAxis("axis", 2000)
    set_motor(cast("FmuPlant", Silent()), unknown)
    assert (unknown.back_emf, unknown.decay_resistance, unknown.balance_resistance) == (0, 0, 0)
    assert unknown.learning > 0


@pytest.mark.parametrize("rpm", [1500, -1500])
def test_the_kernel_s_open_winding_carries_no_current_above_a_plant_in_c(rpm: int) -> None:
    """Same as in the reference implementation above motors in Python: here above an FMU's own equations."""
    order = DrivesOrder((1,), PROFILES["70/10"], 1_000_000, plant=ensure("single_axis"), axes=("axis",))
    _, bank = drives(order)
    (axis,) = bank.axes
    assert bank.native
    plant: Any = vars(bank)["_engine"].__dict__["_plant"]
    configure(
        axis,
        Settings(
            current_p=180,
            current_i=60,
            velocity_p=1200,
            velocity_i=150,
            max_speed=25_000,
            peak_current=5000,
            continuous_current=5000,
        ),
    )
    axis.switch_on()
    regulate_velocity(axis)
    axis.profile, axis.target_velocity = RAMP, speed_units(axis, rpm)
    axis.acceleration = axis.deceleration = acceleration_units(axis, 10_000)
    while bank.now < 200 * MILLISECOND:
        bank.advance(200 * MILLISECOND)
    place = {name: at for at, name in enumerate(plant.output_names)}
    fast = plant.outputs[place["speed_axis"]]
    assert abs(fast) > 50.0
    axis.switch_off()
    for tick in range(500):
        bank.advance(bank.now + TICK)
        if tick > 20:
            assert abs(plant.outputs[place["current_axis"]]) < 0.02
            assert abs(plant.outputs[place["speed_axis"]]) <= abs(fast)
