"""The plain servo's cyclic modes: set-points followed, shortened at limits, and not followed in a halt."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode, PowerState
from firmware_bridge.families.cia402.wire import address as at
from hil_tests.unit.cia402.servo_bench import COUNTS, ENABLE, SHUTDOWN, SWITCH_ON, ServoBench

TURN = COUNTS
ENABLED = PowerState.OPERATION_ENABLED
LIMITED, BIT_12 = 11, 12


@pytest.fixture
def bench() -> ServoBench:
    return ServoBench()


def test_cyclic_positions_are_followed_with_one_speed_between_them(bench: ServoBench) -> None:
    bench.enable(Mode.CYCLIC_POSITION)
    bench.write(at.PERIOD, 10)
    speeds = set()
    for place in range(1, 31):
        bench.write(od.TARGET_POSITION, 100 * place)
        for _ in range(10):
            bench.run(1)
            speeds.add(bench.read(od.VELOCITY_DEMAND))
    # 100 counts in 10 ms are 300 rpm.
    assert speeds == {300}
    assert (bench.has(BIT_12), bench.has(LIMITED)) == (True, False)
    bench.run(100)
    assert abs(bench.position - 3000) <= 40
    assert bench.read(od.VELOCITY_DEMAND) == 0


def test_too_short_a_period_stops_and_goes(bench: ServoBench) -> None:
    bench.enable(Mode.CYCLIC_POSITION)
    bench.write(at.PERIOD, 5)
    speeds = []
    for place in range(1, 6):
        bench.write(od.TARGET_POSITION, 100 * place)
        for _ in range(10):
            bench.run(1)
            speeds.append(bench.read(od.VELOCITY_DEMAND))
    assert {0, 600} <= set(speeds)


def test_a_jump_is_shortened_to_the_fastest_speed_and_shown(bench: ServoBench) -> None:
    bench.enable(Mode.CYCLIC_POSITION)
    bench.write(od.MAX_PROFILE_VELOCITY, 600)
    bench.write(od.TARGET_POSITION, 10 * TURN)
    bench.run(0.5)
    assert bench.has(LIMITED)
    bench.run(2)
    assert bench.read(od.POSITION_DEMAND) <= 20
    bench.write(od.TARGET_POSITION, bench.read(od.POSITION_DEMAND))
    bench.run(1)
    assert not bench.has(LIMITED)


@pytest.mark.parametrize(
    ("mode", "target", "value"),
    [
        (Mode.CYCLIC_POSITION, od.TARGET_POSITION, 10 * TURN),
        (Mode.CYCLIC_VELOCITY, od.TARGET_VELOCITY, 500),
        (Mode.CYCLIC_TORQUE, at.TARGET_TORQUE, 500),
        (Mode.PROFILE_VELOCITY, od.TARGET_VELOCITY, 500),
    ],
)
@pytest.mark.parametrize("enabled_before", [False, True])
def test_a_set_point_of_before_moves_nothing_while_it_is_halted(
    bench: ServoBench, mode: Mode, target: Address, value: int, *, enabled_before: bool
) -> None:
    bench.write(target, value)
    if enabled_before:
        bench.enable(Mode.NONE)
        bench.command(ENABLE | 0x100)
        bench.write(od.MODE, mode)
    else:
        bench.write(od.MODE, mode)
        bench.command(SHUTDOWN | 0x100, SWITCH_ON | 0x100, ENABLE | 0x100)
    assert bench.state is ENABLED
    for _ in range(100):
        bench.run(1)
        assert abs(bench.axis.encoder) <= 2
    bench.command(ENABLE)
    bench.run(100)
    assert bench.axis.encoder > 100


@pytest.mark.parametrize(
    ("rpm", "limited"), [(599, False), (600, False), (601, True), (-600, False), (-601, True)]
)
def test_a_velocity_is_limited_beyond_the_fastest_and_not_at_it(
    bench: ServoBench, rpm: int, *, limited: bool
) -> None:
    bench.enable(Mode.CYCLIC_VELOCITY)
    bench.write(od.MAX_PROFILE_VELOCITY, 600)
    bench.write(od.TARGET_VELOCITY, rpm)
    bench.servo.wake(bench.now)
    assert bench.has(LIMITED) is limited


def test_offsets_add_to_cyclic_set_points(bench: ServoBench) -> None:
    bench.enable(Mode.CYCLIC_POSITION)
    bench.write(at.POSITION_OFFSET, 7)
    bench.run(50)
    assert bench.read(od.POSITION_DEMAND) == 7
    bench.write(od.MODE, Mode.CYCLIC_VELOCITY)
    bench.write(od.TARGET_VELOCITY, 100)
    bench.write(at.VELOCITY_OFFSET, 50)
    assert bench.read(od.VELOCITY_DEMAND) == 150
    bench.write(od.TARGET_VELOCITY, 0)
    bench.write(at.VELOCITY_OFFSET, 0)
    bench.write(od.MODE, Mode.CYCLIC_TORQUE)
    bench.write(at.TARGET_TORQUE, 100)
    bench.write(at.TORQUE_OFFSET, 50)
    bench.run(5)
    # 150/1000 of 2 A.
    assert abs(bench.read(od.CURRENT_ACTUAL) - 150) <= 10


def test_torque_is_limited_and_shown(bench: ServoBench) -> None:
    bench.enable(Mode.CYCLIC_TORQUE)
    bench.write(at.MAX_TORQUE, 200)
    bench.write(at.TARGET_TORQUE, 900)
    bench.run(3)
    assert bench.has(LIMITED)
    assert abs(bench.read(at.TORQUE_DEMAND) - 200) <= 10
