"""The plain servo: states, option codes, modes and errors, as CiA 402-2 has them."""

import pytest

from emulators.canopen.homing_methods import Switch
from emulators.cia402.inputs import PINS
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode, PowerState
from firmware_bridge.families.cia402.wire import address as at
from hil_tests.unit.cia402.servo_bench import (
    COUNTS,
    DISABLE,
    ENABLE,
    NODE,
    QUICK_STOP,
    RESET,
    SHUTDOWN,
    SWITCH_ON,
    ServoBench,
)

TURN = COUNTS
OFF, READY, ON, ENABLED = (
    PowerState.SWITCH_ON_DISABLED,
    PowerState.READY_TO_SWITCH_ON,
    PowerState.SWITCHED_ON,
    PowerState.OPERATION_ENABLED,
)
STOPPING, FAULT = PowerState.QUICK_STOP_ACTIVE, PowerState.FAULT
REACHED, LIMITED, BIT_12, BIT_13 = 10, 11, 12, 13


@pytest.fixture
def bench() -> ServoBench:
    return ServoBench()


def turning(bench: ServoBench, rpm: int = 600) -> ServoBench:
    """Return it in profile velocity mode at this speed."""
    bench.enable(Mode.PROFILE_VELOCITY)
    bench.write(od.TARGET_VELOCITY, rpm)
    bench.run(200)
    assert abs(bench.read(od.VELOCITY_ACTUAL) - rpm) <= 60
    return bench


# Identity and states


def test_it_starts_and_shows_what_it_is(bench: ServoBench) -> None:
    assert bench.frames[0] == f"{0x700 + NODE:03X}#00"
    assert bench.send("605#4000100000000000") == ["585#4300100092010200"]
    # Servo, pp, pv, hm, csp, csv, cst.
    assert bench.read(od.SUPPORTED_MODES) == 0x3A5
    assert (bench.read(od.MODE), bench.read(od.MODE_DISPLAY), bench.state) == (0, 0, OFF)
    assert bench.states == [PowerState.NOT_READY_TO_SWITCH_ON, OFF]


def test_the_default_pdos_are_those_of_the_profile(bench: ServoBench) -> None:
    sent = bench.send("000#0105")
    assert [frame.partition("#")[0] for frame in sent] == ["185", "285", "385", "485"]
    assert sent[0] == "185#5002"
    assert bench.send("205#0600")[0] == "185#3102"


def test_each_command_leads_where_the_standard_has_it(bench: ServoBench) -> None:
    bench.command(SHUTDOWN, SWITCH_ON, ENABLE, SWITCH_ON, SHUTDOWN, DISABLE)
    assert bench.states[1:] == [OFF, READY, ON, ENABLED, ON, READY, OFF]
    bench.command(SHUTDOWN, ENABLE)
    assert bench.state is ENABLED, "3 and 4 at once"
    bench.command(DISABLE)
    assert bench.state is OFF


def test_a_command_that_the_state_does_not_take_is_ignored(bench: ServoBench) -> None:
    bench.command(ENABLE, SWITCH_ON)
    assert bench.state is OFF
    # With bit 7 up no other command is decoded.
    bench.command(0x86)
    assert bench.state is OFF


# Option codes


@pytest.mark.parametrize(
    ("option", "end", "shortest", "longest"),
    [
        # 600 rpm at 10,000 rpm/s is 60 ms, at 50,000 rpm/s it is 12 ms.
        (0, OFF, 0, 1),
        (1, OFF, 60, 75),
        (2, OFF, 12, 25),
        (5, STOPPING, 60, 75),
        (6, STOPPING, 12, 25),
    ],
)
def test_a_quick_stop_goes_by_its_option(
    bench: ServoBench, option: int, end: PowerState, shortest: int, longest: int
) -> None:
    turning(bench)
    assert bench.write(od.QUICK_STOP_OPTION, option) == 0
    bench.write(od.CONTROLWORD, QUICK_STOP)
    lasted = 0
    while lasted < 100 and (bench.read(od.VELOCITY_DEMAND) if end is STOPPING else bench.axis.powered):
        bench.run(1)
        lasted += 1
    assert shortest <= lasted <= longest
    assert bench.state is end
    assert (STOPPING in bench.states) is (option != 0)
    bench.command(ENABLE)
    # Transition 16 is for the options that stay.
    assert bench.state is (ENABLED if end is STOPPING else OFF)


@pytest.mark.parametrize(
    ("address", "word", "option", "milliseconds"),
    [
        (od.SHUTDOWN_OPTION, SHUTDOWN, 0, 0),
        (od.SHUTDOWN_OPTION, SHUTDOWN, 1, 60),
        (od.DISABLE_OPTION, SWITCH_ON, 0, 0),
        (od.DISABLE_OPTION, SWITCH_ON, 1, 60),
    ],
)
def test_power_goes_at_once_or_after_a_ramp_in_which_the_state_lasts(
    bench: ServoBench, address: Address, word: int, option: int, milliseconds: int
) -> None:
    turning(bench)
    bench.write(address, option)
    bench.write(od.CONTROLWORD, word)
    for _ in range(milliseconds):
        assert (bench.state, bench.axis.powered) == (ENABLED, 1)
        bench.run(1)
    bench.run(15)
    assert not bench.axis.powered


@pytest.mark.parametrize(("option", "milliseconds"), [(1, 60), (2, 12)])
def test_a_halt_ramps_by_its_option_and_goes_on_when_it_is_released(
    bench: ServoBench, option: int, milliseconds: int
) -> None:
    turning(bench)
    bench.write(od.HALT_OPTION, option)
    bench.write(od.CONTROLWORD, ENABLE | 0x100)
    bench.run(milliseconds - 4)
    assert bench.read(od.VELOCITY_DEMAND) > 0
    bench.run(8)
    assert bench.read(od.VELOCITY_DEMAND) == 0
    bench.run(100)
    assert (bench.state, bench.has(REACHED)) == (ENABLED, True)
    bench.command(ENABLE)
    bench.run(200)
    assert bench.read(od.VELOCITY_ACTUAL) > 500


@pytest.mark.parametrize(
    ("option", "end", "reported"),
    [(0, ENABLED, [0x8130]), (1, FAULT, [0x8130]), (2, OFF, [0x8130]), (3, OFF, [0x8130])],
)
def test_a_lost_heartbeat_acts_by_its_option(
    bench: ServoBench, option: int, end: PowerState, reported: list[int]
) -> None:
    turning(bench)
    bench.write(od.ABORT_CONNECTION_OPTION, option)
    assert bench.write(od.CONSUMER_HEARTBEAT_1, 0x0001_0064) == 0
    bench.send("701#05")
    bench.run(99)
    assert bench.state is ENABLED
    bench.run(200)
    assert (bench.state, bench.emergencies) == (end, reported)


def test_leaving_operational_acts_by_the_same_option_and_only_with_power(bench: ServoBench) -> None:
    bench.send("000#0105")
    bench.send("000#8005")
    assert (bench.state, bench.emergencies) == (OFF, [])
    bench.send("000#0105")
    turning(bench)
    bench.send("000#8005")
    bench.run(100)
    assert bench.state is FAULT


# Modes


def test_only_its_modes_are_taken(bench: ServoBench) -> None:
    for number in range(-128, 128):
        refused = bench.write(od.MODE, number)
        assert refused == (0 if number in {0, 1, 3, 6, 8, 9, 10} else 0x0609_0030)
        assert bench.read(od.MODE_DISPLAY) == (number if not refused else bench.read(od.MODE))


def test_a_position_is_reached_by_the_handshake_of_bits_4_and_12(bench: ServoBench) -> None:
    bench.enable(Mode.PROFILE_POSITION)
    bench.write(od.TARGET_POSITION, 3 * TURN)
    bench.command(ENABLE | 0x10)
    assert bench.has(BIT_12)
    assert not bench.has(REACHED)
    bench.command(ENABLE)
    assert not bench.has(BIT_12)
    bench.run(600)
    assert (bench.has(REACHED), abs(bench.position - 3 * TURN) <= 5) == (True, True)
    # Bit 4 that stays up is no new set-point, also where it is written again.
    bench.command(ENABLE | 0x10)
    bench.write(od.TARGET_POSITION, 0)
    bench.command(ENABLE | 0x10)
    bench.run(300)
    assert abs(bench.position - 3 * TURN) <= 5


def test_a_target_outside_the_limits_is_an_error_and_nothing_moves(bench: ServoBench) -> None:
    bench.enable(Mode.PROFILE_POSITION)
    bench.write(od.MAX_POSITION_LIMIT, TURN)
    bench.write(od.TARGET_POSITION, TURN + 1)
    bench.command(ENABLE | 0x10)
    bench.run(20)
    assert (bench.state, bench.emergencies, bench.read(at.ERROR_CODE)) == (FAULT, [0x8612], 0x8612)
    assert abs(bench.position) <= 2


def test_a_new_mode_forgets_the_set_point_of_the_one_before(bench: ServoBench) -> None:
    turning(bench)
    bench.write(od.MODE, Mode.PROFILE_POSITION)
    bench.run(300)
    assert bench.read(od.VELOCITY_DEMAND) == 0
    assert bench.state is ENABLED


# Errors


def test_a_following_error_counts_after_its_time(bench: ServoBench) -> None:
    bench.write(od.MAX_FOLLOWING_ERROR, 50)
    bench.write(at.FOLLOWING_ERROR_TIME, 100)
    bench.enable(Mode.PROFILE_POSITION)
    # More than the motor can hold: it is turned away.
    bench.plant.load[0] = -1.0
    lasted = 0
    while not bench.has(BIT_13):
        bench.run(1)
    while bench.state is ENABLED:
        bench.run(1)
        lasted += 1
    assert 95 <= lasted <= 105
    bench.run(50)
    assert (bench.state, bench.emergencies, bench.has(BIT_13)) == (FAULT, [0x8611], True)
    bench.plant.load[0] = 0.0
    bench.run(500)
    bench.command(0, RESET)
    assert (bench.state, bench.emergencies[-1], bench.read(at.ERROR_CODE)) == (OFF, 0, 0)


def test_a_reset_is_an_edge(bench: ServoBench) -> None:
    bench.enable(Mode.PROFILE_POSITION)
    bench.command(RESET)
    bench.servo.motion.communication_fault(0x2310)
    bench.run(20)
    assert bench.state is FAULT
    bench.command(RESET)
    assert bench.state is FAULT, "bit 7 has been up before"
    bench.command(0, RESET)
    assert bench.state is OFF


@pytest.mark.parametrize(
    ("switch", "rpm", "code"), [(Switch.POSITIVE_LIMIT, 600, 0x5442), (Switch.NEGATIVE_LIMIT, -600, 0x5443)]
)
def test_a_limit_switch_stops_the_motion_into_it_and_lets_the_shaft_out(
    bench: ServoBench, switch: Switch, rpm: int, code: int
) -> None:
    turning(bench, rpm)
    bench.axis.pins = PINS[switch]
    bench.run(100)
    assert (bench.state, bench.emergencies) == (FAULT, [code])
    assert bench.read(at.INPUTS) == switch.bit
    bench.write(od.TARGET_VELOCITY, -rpm)
    bench.command(0, RESET, SHUTDOWN, SWITCH_ON, ENABLE)
    bench.run(200)
    assert bench.state is ENABLED
    assert abs(bench.read(od.VELOCITY_ACTUAL) + rpm) <= 60


def test_values_of_before_the_restart_do_not_move_it(bench: ServoBench) -> None:
    turning(bench)
    bench.write(Address(0x1010, 1), int.from_bytes(b"save", "little"))
    bench.send("000#8105")
    bench.run(20)
    assert (bench.read(od.TARGET_VELOCITY), bench.read(od.MODE), bench.state) == (0, 0, OFF)
