"""Each variation does what its row has, where the plain servo does not; and all turn their motor."""

import pytest

from emulators.canopen.homing_methods import Switch
from emulators.cia402.inputs import PINS
from emulators.cia402.variations import VARIATIONS, VariationError, traits_of
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode, PowerState
from firmware_bridge.families.cia402.wire import address as at
from hil_tests.unit.cia402.servo_bench import ENABLE, QUICK_STOP, SHUTDOWN, SWITCH_ON, ServoBench

ENABLED, ON, OFF = PowerState.OPERATION_ENABLED, PowerState.SWITCHED_ON, PowerState.SWITCH_ON_DISABLED
REMOTE, BIT_12 = 9, 12
HALT, NEW = 0x100, 0x10


def both(name: str) -> tuple[ServoBench, ServoBench]:
    """Return the servo with a variation, and the plain one."""
    return ServoBench(name), ServoBench()


def test_a_name_that_no_variation_has_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(VariationError, match=r"late: no such variation; there are .*late-boot-up"):
        traits_of(["late"])


def test_there_are_twelve_at_least_each_with_where_it_was_seen() -> None:
    assert len(VARIATIONS) >= 12
    assert all(row.text.endswith(".") and row.seen and row.traits for row in VARIATIONS.values())


def test_two_variations_are_both_there() -> None:
    traits = traits_of(["no-supported-modes", "no-option-codes", "period-first"])
    assert traits.period_first
    assert {0x6502, 0x605A} <= traits.absent


@pytest.mark.parametrize("name", VARIATIONS)
def test_with_each_the_motor_turns_and_stops_by_a_patient_master(name: str) -> None:
    bench = ServoBench(name)
    bench.run(2000)
    bench.send("000#0105")
    bench.write(at.PERIOD, 10)
    bench.write(od.MODE, Mode.PROFILE_VELOCITY)
    bench.run(5100)
    assert bench.read(od.MODE_DISPLAY) == Mode.PROFILE_VELOCITY
    bench.command(SHUTDOWN, SWITCH_ON, ENABLE)
    assert bench.state is ENABLED
    bench.write(od.TARGET_VELOCITY, 300)
    bench.run(300)
    assert abs(bench.read(od.VELOCITY_ACTUAL) - 300) <= 60
    bench.command(QUICK_STOP)
    # Where the power goes with the ramp's end, the shaft coasts for the rest.
    bench.run(800)
    assert bench.read(od.VELOCITY_ACTUAL) == 0
    bench.command(0)
    assert (bench.state, bench.axis.powered) == (OFF, 0)


def test_its_boot_up_is_late() -> None:
    late, plain = both("late-boot-up")
    assert (late.frames, plain.frames) == ([], ["705#00"])
    late.run(1489)
    assert late.frames == []
    late.run(2)
    assert late.frames == ["705#00"]


def test_it_wants_its_period_before_it_is_enabled() -> None:
    for bench, before in zip(both("period-first"), (ON, ENABLED), strict=True):
        bench.write(od.MODE, Mode.CYCLIC_POSITION)
        bench.command(SHUTDOWN, SWITCH_ON, ENABLE)
        assert bench.state is before
        bench.write(at.PERIOD, 10)
        bench.command(ENABLE)
        assert bench.state is ENABLED


def test_it_wants_a_mode_before_it_is_enabled() -> None:
    for bench, before in zip(both("mode-first"), (ON, ENABLED), strict=True):
        bench.command(SHUTDOWN, SWITCH_ON, ENABLE)
        assert bench.state is before


def test_it_is_remote_when_operational() -> None:
    for bench, before in zip(both("remote-when-operational"), (False, True), strict=True):
        assert bench.has(REMOTE) is before
        bench.send("000#0105")
        bench.run(1)
        assert bench.has(REMOTE)


def test_no_mode_is_taken_while_it_is_halted() -> None:
    for bench, taken in zip(
        both("no-mode-while-halted"), (Mode.PROFILE_VELOCITY, Mode.PROFILE_POSITION), strict=True
    ):
        bench.enable(Mode.PROFILE_VELOCITY)
        bench.command(ENABLE | HALT)
        assert bench.write(od.MODE, Mode.PROFILE_POSITION) == 0
        assert bench.read(od.MODE_DISPLAY) == taken
        bench.command(ENABLE)
        bench.write(od.MODE, Mode.PROFILE_POSITION)
        assert bench.read(od.MODE_DISPLAY) == Mode.PROFILE_POSITION


def test_a_mode_is_taken_without_power_only() -> None:
    for bench, taken in zip(both("mode-without-power"), (Mode.PROFILE_VELOCITY, Mode.HOMING), strict=True):
        bench.enable(Mode.PROFILE_VELOCITY)
        bench.write(od.MODE, Mode.HOMING)
        assert bench.read(od.MODE_DISPLAY) == taken
        bench.command(SWITCH_ON)
        bench.write(od.MODE, Mode.HOMING)
        assert bench.read(od.MODE_DISPLAY) == Mode.HOMING


def test_a_mode_takes_five_seconds() -> None:
    slow, plain = both("mode-synchronizes")
    for bench in (slow, plain):
        bench.write(od.MODE, Mode.CYCLIC_POSITION)
    assert plain.read(od.MODE_DISPLAY) == Mode.CYCLIC_POSITION
    for _ in range(499):
        assert slow.read(od.MODE_DISPLAY) == -1
        slow.run(10)
    slow.run(20)
    assert slow.read(od.MODE_DISPLAY) == Mode.CYCLIC_POSITION


def test_it_resumes_after_a_quick_stop() -> None:
    for bench, after in zip(both("resumes-after-quick-stop"), (ENABLED, OFF), strict=True):
        bench.enable(Mode.PROFILE_VELOCITY)
        assert bench.read(od.QUICK_STOP_OPTION) == 2
        bench.command(QUICK_STOP)
        bench.run(100)
        bench.command(ENABLE)
        assert bench.state is after


def test_a_controlword_that_comes_too_soon_is_not_seen() -> None:
    for bench, after in zip(both("slow-controlword"), (PowerState.READY_TO_SWITCH_ON, ENABLED), strict=True):
        for word in (SHUTDOWN, SWITCH_ON, ENABLE):
            bench.write(od.CONTROLWORD, word)
            bench.run(0.4)
        assert bench.state is after


@pytest.mark.parametrize(
    ("name", "index"),
    [("no-supported-modes", 0x6502), ("no-option-codes", 0x605A), ("no-option-codes", 0x605E)],
)
def test_objects_are_missing(name: str, index: int) -> None:
    varied, plain = both(name)
    request = f"605#40{index.to_bytes(2, 'little').hex()}0000000000"
    assert varied.send(request) == [f"585#80{index.to_bytes(2, 'little').hex().upper()}0000000206"]
    assert plain.send(request)[0].startswith("585#4")


def test_a_transmit_pdo_is_not_sent_with_sync() -> None:
    for bench, refused in zip(both("statusword-by-event"), (0x0609_0030, 0), strict=True):
        assert bench.write(Address(0x1800, 2), 1) == refused
        assert bench.write(Address(0x1800, 2), 254) == 0


def test_bit_30_of_a_cob_id_stays() -> None:
    for bench, refused in zip(both("keeps-no-remote"), (0x0609_0030, 0), strict=True):
        assert bench.write(Address(0x1801, 1), 0x0000_0285) == refused
        assert bench.write(Address(0x1801, 1), 0xC000_0285) == 0


def test_bit_12_is_1_after_enabling_until_bit_4_changes() -> None:
    for bench, before in zip(both("acknowledged-when-enabled"), (True, False), strict=True):
        bench.enable(Mode.PROFILE_POSITION)
        assert bench.has(BIT_12) is before
        bench.command(ENABLE)
        assert bench.has(BIT_12) is before
        bench.write(od.TARGET_POSITION, 100)
        bench.command(ENABLE | NEW)
        assert bench.has(BIT_12)
        bench.command(ENABLE)
        assert not bench.has(BIT_12)


def test_the_sign_of_the_home_offset() -> None:
    for bench, home in zip(both("offset-added"), (500, -500), strict=True):
        bench.write(od.HOMING_METHOD, 35)
        bench.write(od.HOME_OFFSET, 500)
        bench.enable(Mode.HOMING)
        bench.command(ENABLE | NEW)
        assert abs(bench.position - home) <= 3


def test_the_offset_counts_from_the_switch_and_is_not_moved() -> None:
    bench = ServoBench()
    bench.write(od.HOMING_METHOD, 18)
    bench.write(od.HOME_OFFSET, -4000)
    bench.enable(Mode.HOMING)
    bench.write(od.CONTROLWORD, ENABLE | NEW)
    for _ in range(2000):
        bench.run(1)
        bench.axis.pins = PINS[Switch.POSITIVE_LIMIT] if bench.axis.encoder >= 300 else 0
    assert bench.has(BIT_12)
    assert abs(bench.axis.encoder - 300) <= 25
    assert abs(bench.position - 4000) <= 25


def test_method_0_is_refused() -> None:
    for bench, refused in zip(both("no-method-0"), (0x0609_0030, 0), strict=True):
        assert bench.write(od.HOMING_METHOD, 0) == refused
