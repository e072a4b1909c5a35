"""Motor, encoder, gear and load of the user's own at an emulated drive; settings that contradict them."""

from pathlib import Path
from typing import Final, NamedTuple

import pytest
from typer.testing import CliRunner

from emulators.devices import devices
from emulators.epos2.documents.eds import dcf
from emulators.epos2.drive import Epos2
from emulators.epos2.mounted import Mounted, ShaftLoad
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.epos2.objects.parameters import is_parameter
from emulators.epos2.single import DrivesOrder, drives
from emulators.fittings import Encoder, FittingError, encoder, gear
from emulators.motors import MotorError, catalogue, motor
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.data_sheets import SheetError, configured
from firmware_bridge.units import SECOND
from hil_tests.rows import every
from hil_tests.unit.world.players import Player

RE_40: Final = motor("148867")
EC_45: Final = motor("397172")
POLE_PAIRS: Final = Address(0x6410, 3)
BRUSHED: Final = {od.MOTOR_TYPE: 1}
RPM: Final = 600


class Came(NamedTuple):
    """Result: emergency codes, the true speed of the shaft in rpm, and the console's output."""

    codes: list[int]
    rpm: float
    warnings: list[str]


def turned(mounted: Mounted, settings: dict[Address, int]) -> Came:
    """Set a drive up, and have it turn in profile velocity mode with its default gains."""
    warnings: list[str] = []
    made, bank = drives(DrivesOrder((1,), PROFILES["70/10"], 1_000_000, mounted=mounted), warnings.append)
    world, wire = World(bank), CanWire(1_000_000)
    writes = [(0x000, "0100"), *(_write(*each) for each in (settings | {od.MODE: 3}).items())]
    writes += [(0x201, "0600"), (0x201, "0F00"), (0x501, "0F00" + RPM.to_bytes(4, "little").hex())]
    packets = [Packet(CAN, address, bytes.fromhex(text)) for address, text in writes]
    master = Player(*((SECOND // 10 + SECOND // 50 * k, packet) for k, packet in enumerate(packets)))
    world.attach("motor1", made["motor1"], {CAN: wire})
    world.attach("master", master, {CAN: wire})
    world.run(3 * SECOND // 2)
    before = bank.axes[0].encoder
    world.run(2 * SECOND)
    codes = [int.from_bytes(p.payload[:2], "little") for _, p in master.received if p.address == 0x081]
    turns = (bank.axes[0].encoder - before) / (4 * mounted.pulses)
    return Came(codes, 120.0 * turns, warnings)


def _write(address: Address, value: int) -> tuple[int, str]:
    size = EPOS2_70_10.objects[address].type.size
    command = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
    raw = (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")
    return 0x601, bytes((command, *address.index.to_bytes(2, "little"), address.subindex, *raw)).hex()


def with_encoder(pulses: int, sensor: int = 1) -> dict[Address, int]:
    return BRUSHED | {at.ENCODER_PULSES: pulses, at.SENSOR_TYPE: sensor}


def test_with_the_settings_of_what_is_mounted_it_turns_as_it_is_commanded() -> None:
    for pulses in (500, 1024, 2048):
        came = turned(Mounted(motor=RE_40, pulses=pulses), with_encoder(pulses))
        assert (came.codes, came.warnings) == ([], [])
        assert came.rpm == pytest.approx(RPM, rel=0.02)


def test_a_wrong_pulse_number_is_found_by_the_index_and_named_by_the_console() -> None:
    """The recorded inputs of a user: 1024 at an encoder of 500, and the other way round."""
    for mounted, written in ((500, 1024), (1024, 500), (500, 256)):
        came = turned(Mounted(motor=RE_40, pulses=mounted), with_encoder(written))
        assert came.codes[0] in {0xFF02, 0xFF03}
        assert came.warnings == [
            f"node 1: 0x2210:1 is {written} pulses, the mounted encoder has {mounted} (--encoder)"
        ]


def test_a_robot_s_drive_has_the_encoder_and_the_motor_of_the_robot_file() -> None:
    warnings: list[str] = []
    robot = find("rars")
    emulated = devices(robot, report=warnings.append)
    drive, lines = emulated.nodes(Epos2)["left"], Epos2Axis.of(robot.axes[0]).encoder_lines
    for address, value in ((at.ENCODER_PULSES, lines + 1), (od.MOTOR_TYPE, 10), (od.CONTROLWORD, 0x000F)):
        drive.store.write(address, EPOS2_70_10.objects[address].type.encode(value))
    (text,) = warnings
    assert text.startswith(f"'left': 0x2210:1 is {lines + 1} pulses, the mounted encoder has {lines} ")
    assert text.endswith("(encoder_lines); 0x6402 is motor type 10, a brushed motor is mounted (motor_type)")
    emulated.plant.close()


def test_without_an_index_a_wrong_pulse_number_is_a_wrong_speed() -> None:
    came = turned(Mounted(motor=RE_40, pulses=500, index=False), with_encoder(1024, sensor=2))
    assert came.codes == []
    assert came.rpm == pytest.approx(RPM * 1024 / 500, rel=0.03)


def test_an_index_that_is_set_up_and_not_there_is_missed() -> None:
    came = turned(Mounted(motor=RE_40, index=False), with_encoder(500))
    assert came.codes == [0xFF02]
    assert came.warnings == ["node 1: 0x2210:2 is 1, with index; the mounted encoder has none (--encoder)"]


def test_a_wrong_sign_runs_away_until_a_limit_trips() -> None:
    came = turned(Mounted(motor=RE_40), with_encoder(500) | {Address(0x2210, 4): 1})
    assert came.codes != []


@every(
    ("kind", "pairs", "codes", "rpm", "states"),
    [
        (10, 8, [], RPM, ""),
        (11, 8, [], RPM, ""),
        (10, 1, [0xFF08], 0, "0x6410:3 is 1 pole pairs, the mounted motor has 8 (--pole-pairs)"),
        (1, 8, [], 0, "0x6402 is motor type 1, an EC motor is mounted (--motor)"),
    ],
)
def test_an_ec_motor_turns_where_the_drive_is_set_up_for_it(
    kind: int, pairs: int, codes: list[int], rpm: int, states: str
) -> None:
    came = turned(Mounted(motor=EC_45), {od.MOTOR_TYPE: kind, POLE_PAIRS: pairs})
    assert came.codes == codes
    assert came.rpm == pytest.approx(rpm, rel=0.03, abs=1.0)
    assert came.warnings == ([f"node 1: {states}"] if states else [])


def test_a_brushed_motor_shows_no_hall_sensors() -> None:
    came = turned(Mounted(motor=RE_40), {od.MOTOR_TYPE: 10, POLE_PAIRS: 1})
    assert came.codes == [0xFF04], "hall sensor not found"
    assert came.warnings == ["node 1: 0x6402 is motor type 10, a brushed motor is mounted (--motor)"]


def test_what_is_no_particular_motor_is_right_with_any_type() -> None:
    for kind in (1, 10):
        came = turned(Mounted(), {od.MOTOR_TYPE: kind})
        assert (came.codes, came.warnings) == ([], [])
        assert came.rpm == pytest.approx(RPM, rel=0.02)


@pytest.mark.parametrize(
    ("text", "fitted"),
    [
        ("1024", Encoder(1024)),
        ("1024,no-index", Encoder(1024, index=False)),
        ("110512", Encoder(500)),
        ("hedl 5540", Encoder(500)),
        ("225787", Encoder(1024)),
    ],
)
def test_an_encoder_is_stated_by_its_pulses_or_by_what_it_is_called(text: str, fitted: Encoder) -> None:
    assert encoder(text) == fitted


@pytest.mark.parametrize(
    ("text", "ratio", "inertia"),
    [
        ("26", 26.0, 0.0),
        ("57/13", 57 / 13, 0.0),
        ("166936", 576 / 25, 0.8e-7),
        ("GP 32 C 23:1", 576 / 25, 0.8e-7),
        ("gpx 32 62:1", 421_875 / 6_859, 7.55e-7),
    ],
)
def test_a_gear_is_stated_by_its_ratio_or_by_what_it_is_called(
    text: str, ratio: float, inertia: float
) -> None:
    assert (gear(text).ratio, gear(text).inertia_kg_m2) == pytest.approx((ratio, inertia))


def test_a_part_of_a_gears_name_that_several_have_lists_them() -> None:
    with pytest.raises(FittingError, match=r"3 gears .* names: GP 32 A 3\.7:1 166155; GP 32 A 86:1"):
        gear("GP 32 A")


def test_the_gears_own_inertia_is_at_the_motors_shaft() -> None:
    assert Mounted(gear=26.0, gear_inertia=8e-8, load=ShaftLoad(0.1, 0.0)).shaft.inertia == pytest.approx(
        8e-8 + 0.1 / 26.0**2
    )


def test_the_load_is_seen_through_the_gear() -> None:
    shaft = Mounted(motor=RE_40, gear=26.0, load=ShaftLoad(0.1, 2.6)).shaft
    assert shaft.inertia == pytest.approx(142e-7 + 0.1 / 676)
    # The no-load current's torque, 0.137 A x 30.2 mN m/A, and a 26th of the load's.
    assert shaft.friction == pytest.approx(0.137 * 0.0302 + 0.1)
    assert Mounted(motor=RE_40).shaft.inertia == pytest.approx(142e-7)
    assert Mounted(load=ShaftLoad(5e-5, 0.002)).shaft.inertia == 5e-5


def test_every_motor_of_the_catalog_fits_its_published_figures() -> None:
    """The speed without load: within 5 % of the constant's, as the file promises; a source for each."""
    assert len(catalogue()) == 171
    for one in catalogue().values():
        assert one.source
        assert one.kind == "ec" or one.pole_pairs in {1, 2, None}
        assert 0.0 < one.no_load_current_a < one.continuous_current_a


@pytest.mark.parametrize(
    ("name", "title"),
    [
        ("148867", "RE 40 GB 150W 24V (148867)"),
        ("re 40 24v", "RE 40 GB 150W 24V (148867)"),
        ("dcx22s01gbkl598", "DCX 22 S GB 24V (DCX22S01GBKL598)"),
        ("RE40", "maxon RE40 150 W 24 V (148867)"),
    ],
)
def test_a_motor_is_found_by_number_and_by_words(name: str, title: str) -> None:
    assert motor(name).title == title


def test_an_ambiguous_name_lists_the_motors_that_have_it() -> None:
    with pytest.raises(
        MotorError, match=r"2 motors .*RE 40 GB 150W 24V \(148867\); RE 40 GB 150W 48V \(148877\)"
    ):
        motor("RE 40")
    with pytest.raises(MotorError, match=r"no motor '148866' is known; perhaps"):
        motor("148866")


def test_a_configuration_file_is_what_the_drive_begins_with(tmp_path: Path) -> None:
    values: dict[Address, int | bytes] = {od.MOTOR_TYPE: 1, at.ENCODER_PULSES: 1024, at.CURRENT_P: 321}
    values |= {Address(0x2210, 4): 1, od.STATUSWORD: 0x40, Address(0x1400, 1): 0x209}
    file = tmp_path / "drive.dcf"
    file.write_text(dcf(PROFILES["70/10"], 5, 1_000_000, values), encoding="ascii")
    read = configured(file, ANY_TYPE).values
    assert {key: read[key] for key in values if key != od.STATUSWORD} == {
        key: value for key, value in values.items() if key != od.STATUSWORD
    }
    made, _ = drives(
        DrivesOrder(
            (5,),
            PROFILES["70/10"],
            1_000_000,
            commissioned={
                key: value for key, value in read.items() if is_parameter(EPOS2_70_10.objects[key])
            },
        )
    )
    drive = made["motor5"]
    drive.wake(0)
    assert [drive.store.get(key) for key in (od.MOTOR_TYPE, at.ENCODER_PULSES, at.CURRENT_P)] == [
        1,
        1024,
        321,
    ]


@pytest.mark.parametrize(
    ("text", "states"),
    [
        ("no sections", "cannot be read as a data sheet"),
        ("[6402]\nParameterName=Motor Type\n", "no ParameterValue"),
        (
            "[6402]\nParameterValue=many\n[2210sub1]\nParameterValue=-1\n",
            r"\[6402\] .* no number; \[2210sub1\]",
        ),
        ("[6402]\nParameterValue=0x10000\n", "does not fit UNSIGNED16"),
    ],
)
def test_what_is_no_configuration_file_is_refused_with_section_and_key(
    tmp_path: Path, text: str, states: str
) -> None:
    file = tmp_path / "drive.dcf"
    file.write_text(text, encoding="ascii")
    with pytest.raises(SheetError, match=states):
        configured(file, ANY_TYPE)
    with pytest.raises(SheetError, match="cannot be read"):
        configured(tmp_path / "none.dcf", ANY_TYPE)


@pytest.mark.parametrize(
    ("words", "states"),
    [
        ("--motor RE41", "--motor: no motor 'RE41' is known; perhaps 'RE40'"),
        ("--encoder 8", "--encoder 8: give PULSES[,no-index], 16 to 2500000 in a turn"),
        ("--encoder 500,idx", "--encoder 500,idx: give PULSES"),
        ("--gear 0", "--gear 0: give the motor's turns"),
        ("--gear 1/0", "--gear 1/0: give the motor's turns"),
        ("--gear GP33", "--gear GP33: give the motor's turns"),
        ("--gear nan", "--gear nan: give the motor's turns"),
        ("--load 0,0", "--load 0,0: the inertia must be more than 0"),
        ("--motor RE40 --load -1,0", "--load -1,0: the inertia must be not less than 0"),
        ("--plant my.fmu --motor RE40", "--motor: the plant has motors of its own"),
        ("--plant my.fmu --gear 26", "--gear: the plant has motors of its own"),
        ("--plant my.fmu --pole-pairs 4", "--pole-pairs: the plant has motors of its own"),
        ("--dcf none.dcf", "none.dcf: cannot be read"),
        ("--boot-time 3", "--boot-time 3: give a time, as 262.5ms"),
    ],
)
def test_a_wrong_option_is_refused_in_one_line(words: str, states: str) -> None:
    result = CliRunner().invoke(program, ["emulate", "epos2", "--serial", "pty", *words.split()])
    assert result.exit_code == 2
    assert states in result.stderr
    assert result.stderr.count("\n") == 1
