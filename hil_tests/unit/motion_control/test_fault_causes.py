"""Every emergency that the servo axis can find, reached by its cause; what it does, and what ends it."""

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from emulators.servo.surroundings import IndexPulse, SensorWires, Surroundings
from firmware_bridge.wire.cia402 import State
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.emergency import EMERGENCIES, FaultReaction
from hil_tests.unit.motion_control.conftest import SETTINGS, STEERING

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive

RESET = 0x80
SOUND = SensorWires()
SENSOR_TYPE, POLARITY, MISCELLANEOUS = Address(0x2210, 2), Address(0x2210, 4), Address(0x2008)
STRUCTURE, NUMERATOR, DENOMINATOR = Address(0x2220), Address(0x2230, 1), Address(0x2230, 2)
POLE_PAIRS = Address(0x6410, 3)
WITH_INDEX, WITHOUT_INDEX, SSI = 1, 2, 4
SINUS, BLOCK = 10, 11


@pytest.fixture
def drive(drive: "Drive") -> "Drive":
    """The drive knows its motor, so that an open winding carries no current from the first instant."""
    drive.axis.back_emf = round(STEERING.torque_constant * 2**24)
    return drive


def moving(drive: "Drive", rpm: int = 3000) -> None:
    drive.enable(mode=3)
    drive.run(20)
    drive.write(at.TARGET_VELOCITY, rpm)
    drive.run(300)


def falls(drive: "Drive", code: int, within_ms: int = 100) -> None:
    """Expect this one emergency, with the reaction that its row says, and no current after it."""
    already = list(drive.reported)
    drive.runs_until(lambda: drive.reported != already, within_ms)
    assert drive.reported == [*already, code]
    if EMERGENCIES[code].reaction is FaultReaction.DISABLE:
        assert drive.stands_in(State.FAULT)
    drive.runs_until(lambda: drive.stands_in(State.FAULT), 500)
    stays_without_current(drive)


def stays_without_current(drive: "Drive") -> None:
    """What the winding's inductance has kept going is over in some ms; then nothing flows."""
    assert not drive.axis.powered
    drive.run(10)
    for _ in range(50):
        drive.run(1)
        assert abs(drive.plant.outputs[0]) < 0.02
        assert not drive.axis.powered


def resets(drive: "Drive") -> bool:
    drive.command(0, RESET)
    return drive.state is State.SWITCH_ON_DISABLED


# The power stage and its supplies


@pytest.mark.emergency(0x2310)
def test_a_short_in_the_winding_is_an_over_current(drive: "Drive") -> None:
    moving(drive)
    drive.plant.becomes(0, replace(STEERING, resistance=0.02, inductance=5e-6))
    drive.runs_until(lambda: bool(drive.reported), 50)
    assert drive.reported == [0x2310]
    assert drive.stands_in(State.FAULT)
    drive.plant.becomes(0, STEERING)
    stays_without_current(drive)
    assert resets(drive)


@pytest.mark.emergency(0x4210)
def test_a_current_heats_the_power_stage_until_it_switches_off(drive: "Drive") -> None:
    Surroundings(drive.axis).air(99.995)
    drive.plant.load[0] = -1.2 * STEERING.torque_constant
    drive.enable(mode=-3)
    drive.write(at.CURRENT_MODE_SETTING, 1200)
    drive.run(300)
    assert drive.reported == []
    falls(drive, 0x4210, within_ms=3000)
    assert not resets(drive)
    Surroundings(drive.axis).air(60.0)
    drive.run(2)
    assert resets(drive)


@pytest.mark.emergency(0x4210)
def test_hot_surroundings_are_enough(drive: "Drive") -> None:
    Surroundings(drive.axis).air(101.0)
    drive.run(2)
    assert drive.reported == [0x4210]
    assert drive.stands_in(State.FAULT)


@pytest.mark.emergency(0x5113)
def test_a_short_in_a_sensor_cable_pulls_the_5_v_supply_down(drive: "Drive") -> None:
    moving(drive)
    Surroundings(drive.axis).logic_supply(3.0)
    falls(drive, 0x5113, within_ms=2)
    assert not resets(drive)
    Surroundings(drive.axis).logic_supply(4.5)
    drive.run(2)
    assert resets(drive)


@pytest.mark.emergency(0x5114)
def test_gates_that_lack_voltage_are_not_driven(drive: "Drive") -> None:
    moving(drive)
    Surroundings(drive.axis).gate_supply(8.9)
    falls(drive, 0x5114, within_ms=2)
    assert not resets(drive)
    Surroundings(drive.axis).gate_supply(9.0)
    drive.run(2)
    assert resets(drive)


# The encoder


@pytest.mark.emergency(0xFF0A)
def test_a_cut_cable_is_a_breach_of_an_incremental_encoder(drive: "Drive") -> None:
    moving(drive)
    Surroundings(drive.axis).wires(SensorWires(broken=True))
    falls(drive, 0xFF0A, within_ms=2)
    assert not resets(drive)
    Surroundings(drive.axis).wires(SOUND)
    drive.run(2)
    assert resets(drive)


@pytest.mark.emergency(0x7320)
def test_a_cut_cable_makes_the_position_of_an_absolute_encoder_invalid(drive: "Drive") -> None:
    drive.write(SENSOR_TYPE, SSI)
    moving(drive)
    Surroundings(drive.axis).wires(SensorWires(broken=True))
    falls(drive, 0x7320, within_ms=2)
    assert not resets(drive)


def test_supervision_of_the_position_sensor_can_be_switched_off(drive: "Drive") -> None:
    # 0x2008 bit 0: then only the following error is left to notice it.
    drive.write(MISCELLANEOUS, 1)
    drive.enable(mode=1)
    Surroundings(drive.axis).wires(SensorWires(broken=True))
    drive.write(at.TARGET_POSITION, 20_000)
    drive.command(0x1F)
    drive.runs_until(lambda: bool(drive.reported))
    assert drive.reported == [0x8611]


@pytest.mark.parametrize("index", [IndexPulse.MISSING, IndexPulse.SPURIOUS])
@pytest.mark.emergency(0xFF02)
def test_an_index_that_is_missing_or_comes_too_often(drive: "Drive", index: IndexPulse) -> None:
    drive.write(SENSOR_TYPE, WITH_INDEX)
    moving(drive)
    drive.run(200)
    assert drive.reported == []
    Surroundings(drive.axis).wires(SensorWires(index=index))
    falls(drive, 0xFF02, within_ms=65)  # three turns at 3000 rpm
    assert resets(drive)


def test_an_encoder_without_index_needs_none(drive: "Drive") -> None:
    drive.write(SENSOR_TYPE, WITHOUT_INDEX)
    moving(drive)
    Surroundings(drive.axis).wires(SensorWires(index=IndexPulse.MISSING))
    drive.run(500)
    assert drive.reported == []


@pytest.mark.emergency(0xFF03)
def test_counts_that_get_lost_do_not_fit_the_resolution(drive: "Drive") -> None:
    moving(drive)
    before = drive.axis.position
    turned = drive.plant.outputs[1]
    Surroundings(drive.axis).wires(SensorWires(lost_per_mille=50))
    falls(drive, 0xFF03, within_ms=65)
    counted = drive.axis.position - before
    assert counted < 0.97 * (drive.plant.outputs[1] - turned) * 2000 / 6.2831853
    assert resets(drive)


@pytest.mark.emergency(0xFF03)
def test_a_pulse_number_that_is_not_the_encoder_s(drive: "Drive") -> None:
    drive.write(at.ENCODER_PULSES, 400)
    drive.enable(mode=3)
    drive.write(at.TARGET_VELOCITY, 1000)
    falls(drive, 0xFF03, within_ms=300)


@pytest.mark.parametrize("rpm", [3000, -3000])
@pytest.mark.emergency(0xFF11)
def test_an_encoder_that_counts_against_the_motor(drive: "Drive", rpm: int) -> None:
    drive.enable(mode=3)
    Surroundings(drive.axis).wires(SensorWires(swapped=True))
    drive.write(at.TARGET_VELOCITY, rpm)
    falls(drive, 0xFF11, within_ms=1000)
    assert resets(drive)


@pytest.mark.emergency(0xFF11)
def test_a_wrong_polarity_is_as_bad_as_swapped_channels_and_makes_up_for_them(drive: "Drive") -> None:
    drive.write(POLARITY, 1)
    drive.enable(mode=3)
    drive.write(at.TARGET_VELOCITY, 3000)
    falls(drive, 0xFF11, within_ms=1000)
    assert resets(drive)
    drive.run(2000)
    Surroundings(drive.axis).wires(SensorWires(swapped=True))
    drive.control.reset()
    drive.run(20)
    moving(drive)
    assert drive.reported == [0xFF11, 0]
    assert drive.rpm == pytest.approx(3000, abs=30)


def test_a_load_that_wins_is_no_wrong_direction(drive: "Drive") -> None:
    drive.enable(mode=3)
    drive.plant.load[0] = -0.15
    drive.write(at.TARGET_VELOCITY, 1000)
    drive.run(400)
    assert drive.rpm < -1000
    assert drive.reported == []


@pytest.mark.emergency(0xFF12)
def test_an_auxiliary_encoder_that_counts_against_the_main_one(drive: "Drive") -> None:
    for address, value in ((STRUCTURE, 1), (NUMERATOR, 1), (DENOMINATOR, 1)):
        drive.write(address, value)
    moving(drive)
    drive.write(at.TARGET_VELOCITY, 0)
    drive.run(300)
    drive.command(0)
    Surroundings(drive.axis).wires(SensorWires(auxiliary_swapped=True))
    drive.enable(mode=3)
    drive.write(at.TARGET_VELOCITY, 1000)
    falls(drive, 0xFF12, within_ms=150)


# The hall sensors of a brushless motor


def brushless(drive: "Drive", motor: int = BLOCK) -> None:
    drive.write(at.MOTOR_TYPE, motor)


@pytest.mark.parametrize("wires", [SensorWires(hall_high=(1, 2, 3)), SensorWires(hall_low=(2,))])
@pytest.mark.emergency(0xFF01)
def test_hall_sensors_that_cannot_be_under_way(drive: "Drive", wires: SensorWires) -> None:
    brushless(drive)
    moving(drive)
    Surroundings(drive.axis).wires(wires)
    falls(drive, 0xFF01, within_ms=25)
    Surroundings(drive.axis).wires(SOUND)
    drive.run(2)
    assert resets(drive)


@pytest.mark.emergency(0xFF04)
def test_hall_sensors_that_are_not_there_when_the_drive_looks_for_them(drive: "Drive") -> None:
    brushless(drive)
    Surroundings(drive.axis).wires(SensorWires(hall_high=(1, 2, 3)))
    drive.enable(mode=3)
    falls(drive, 0xFF04)
    Surroundings(drive.axis).wires(SOUND)
    drive.run(2)
    assert not resets(drive)
    drive.control.reset()  # only the network's node reset leads out
    drive.run(20)
    moving(drive)
    assert drive.reported == [0xFF04]


@pytest.mark.parametrize("wrong", ["pole pairs", "counts"])
@pytest.mark.emergency(0xFF08)
def test_a_rotor_angle_that_does_not_fit_the_hall_sensors(drive: "Drive", wrong: str) -> None:
    drive.write(SENSOR_TYPE, WITHOUT_INDEX)
    brushless(drive, SINUS)
    drive.write(POLE_PAIRS, 2)
    if wrong == "pole pairs":
        Surroundings(drive.axis).motor(pole_pairs=3)
        drive.enable(mode=3)
        drive.run(20)
        drive.write(at.TARGET_VELOCITY, 1000)
    else:
        moving(drive)
        assert drive.reported == []
        Surroundings(drive.axis).wires(SensorWires(lost_per_mille=60))
    falls(drive, 0xFF08, within_ms=300)
    assert resets(drive)


@pytest.mark.parametrize("motor", [SINUS, BLOCK])
@pytest.mark.parametrize("pairs", [1, 7])
def test_a_brushless_motor_that_is_sound_turns_both_ways(drive: "Drive", motor: int, pairs: int) -> None:
    drive.write(POLE_PAIRS, pairs)
    brushless(drive, motor)
    moving(drive, 4000)
    moving(drive, -4000)
    assert drive.reported == []
    assert drive.read(Address(0x2022)) in range(1, 7)


def test_a_brushed_motor_has_no_hall_sensors(drive: "Drive") -> None:
    assert SETTINGS[at.MOTOR_TYPE] == 1
    Surroundings(drive.axis).wires(SensorWires(hall_high=(1, 2, 3)))
    moving(drive)
    assert drive.reported == []
    assert drive.read(Address(0x2022)) == 0


# Positions, settings and commands


@pytest.mark.parametrize("rpm", [1000, -1000])
@pytest.mark.emergency(0xFF09)
def test_a_shaft_that_runs_past_its_limit_is_stopped_and_may_come_back(drive: "Drive", rpm: int) -> None:
    drive.write(at.MIN_POSITION_LIMIT, -3000)
    drive.write(at.MAX_POSITION_LIMIT, 3000)
    drive.enable(mode=3)
    drive.write(at.TARGET_VELOCITY, rpm)
    falls(drive, 0xFF09, within_ms=200)
    assert 3000 < abs(drive.axis.position) < 3700
    drive.write(at.TARGET_VELOCITY, 0)
    assert resets(drive)
    drive.enable()
    drive.run(100)
    drive.write(at.TARGET_VELOCITY, -rpm)
    drive.run(100)
    assert drive.reported == [0xFF09, 0]
    assert abs(drive.axis.position) < 3000
    drive.write(at.TARGET_VELOCITY, rpm)
    drive.run(300)
    assert drive.reported == [0xFF09, 0, 0xFF09]


def test_a_shaft_beyond_its_limit_is_not_driven_further(drive: "Drive") -> None:
    moving(drive)
    drive.write(at.TARGET_VELOCITY, 0)
    drive.run(300)
    drive.write(at.MAX_POSITION_LIMIT, 1000)
    drive.run(50)
    assert drive.reported == []
    drive.write(at.TARGET_VELOCITY, 100)
    falls(drive, 0xFF09, within_ms=20)


def test_a_move_to_the_very_limit_is_no_fault_by_its_overshoot(drive: "Drive") -> None:
    drive.write(at.MAX_POSITION_LIMIT, 1000)
    drive.enable(mode=-1)
    furthest = 0
    drive.write(at.POSITION_MODE_SETTING, 1000)
    for _ in range(600):
        drive.run(1)
        furthest = max(furthest, drive.axis.position)
    assert furthest > 1000
    assert drive.reported == []


@pytest.mark.emergency(0x6320)
def test_a_target_too_far_for_a_low_velocity_contradicts_itself(drive: "Drive") -> None:
    drive.enable(mode=1)
    drive.write(at.PROFILE_VELOCITY, 1)
    drive.write(at.TARGET_POSITION, 2_000_000_000)
    drive.command(0x1F)
    assert drive.reported == [0x6320]
    stays_without_current(drive)
    assert drive.axis.position == pytest.approx(0, abs=5)
    drive.write(at.PROFILE_VELOCITY, 3000)
    assert resets(drive)
    drive.enable()
    drive.command(0x1F)
    drive.run(100)
    assert drive.axis.position > 1000


@pytest.mark.emergency(0xFF0B)
def test_a_master_that_floods_the_drive_with_targets_overloads_it(drive: "Drive") -> None:
    moving(drive)
    for rpm in range(8):
        drive.write(at.TARGET_VELOCITY, 3000 + rpm)
    assert drive.reported == []
    drive.write(at.TARGET_VELOCITY, 3000)
    assert drive.reported == [0xFF0B]
    assert drive.stands_in(State.FAULT)
    stays_without_current(drive)
    assert resets(drive)


@pytest.mark.parametrize("start", [Address(0x2410, 1), Address(0x2400, 3)])
@pytest.mark.emergency(0xFF0D)
def test_an_identification_of_the_motor_fails_and_moves_nothing(drive: "Drive", start: Address) -> None:
    drive.enable(mode=3)
    drive.run(100)
    at_rest = drive.plant.outputs[1]
    drive.write(start, 1)
    assert drive.reported == [0xFF0D]
    stays_without_current(drive)
    assert drive.plant.outputs[1] == pytest.approx(at_rest, abs=0.01)
    assert resets(drive)


@pytest.mark.emergency(0x1000)
def test_a_download_of_firmware_cannot_be_begun(drive: "Drive") -> None:
    moving(drive)
    drive.write(Address(0x2FFF, 1), 1)
    assert drive.reported == [0x1000]
    assert drive.stands_in(State.FAULT)
    stays_without_current(drive)


@pytest.mark.emergency(0xFF0F)
def test_a_dual_loop_without_a_gear_ratio_is_not_enabled(drive: "Drive") -> None:
    drive.write(STRUCTURE, 1)
    assert drive.read(NUMERATOR) == 0  # as read from a real 70/10
    drive.enable(mode=3)
    assert drive.reported == [0xFF0F]
    assert drive.stands_in(State.FAULT)
    stays_without_current(drive)
    assert not resets(drive)
    drive.write(NUMERATOR, 26)
    assert resets(drive)
    moving(drive)
    assert drive.reported == [0xFF0F, 0]


@pytest.mark.emergency(0xFF10)
def test_gains_that_the_gear_makes_too_large_are_not_enabled(drive: "Drive") -> None:
    for address, value in ((STRUCTURE, 1), (NUMERATOR, 200), (DENOMINATOR, 1)):
        drive.write(address, value)
    drive.enable(mode=3)
    assert drive.reported == [0xFF10]
    assert drive.stands_in(State.FAULT)
    assert not resets(drive)
    drive.write(NUMERATOR, 26)
    assert resets(drive)


def test_cables_and_sensors_that_there_are_not_are_refused() -> None:
    with pytest.raises(ValueError, match="0 to 1000"):
        SensorWires(lost_per_mille=1001)
    with pytest.raises(ValueError, match=r"1, 2 and 3, not \[4\]"):
        SensorWires(hall_low=(4,))
