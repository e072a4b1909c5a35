"""The plain servo homes: to the edge of its switch, round a limit switch, and where it stands."""

import pytest

from emulators.canopen.homing_methods import Switch
from emulators.cia402.inputs import PINS
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import Mode, PowerState
from hil_tests.unit.cia402.servo_bench import ENABLE, SWITCH_ON, ServoBench

ENABLED = PowerState.OPERATION_ENABLED
REACHED, BIT_12, BIT_13 = 10, 12, 13


@pytest.fixture
def bench() -> ServoBench:
    return ServoBench()


def homed(bench: ServoBench, method: int, switch: Switch, beyond: int) -> None:
    """Home by a switch that is active beyond a place, in counts; its sign is the direction."""
    assert bench.write(od.HOMING_METHOD, method) == 0
    bench.enable(Mode.HOMING)
    assert (bench.has(REACHED), bench.has(BIT_12), bench.has(BIT_13)) == (True, False, False)
    bench.write(od.CONTROLWORD, ENABLE | 0x10)
    # In the same cycle: a master that finds bit 10 without 12 takes the homing for interrupted.
    assert not bench.has(REACHED)
    place = 0
    for _ in range(4000):
        bench.run(1)
        # Of the encoder, which goes on through a homing.
        place = bench.axis.encoder
        met = place >= beyond if beyond > 0 else place <= beyond
        bench.axis.pins = PINS[switch] if met else 0
        if bench.has(BIT_12):
            break
    bench.run(300)
    assert (bench.has(REACHED), bench.has(BIT_12), bench.has(BIT_13)) == (True, True, False)


@pytest.mark.parametrize(
    ("method", "switch", "beyond"),
    [
        (17, Switch.NEGATIVE_LIMIT, -300),
        (18, Switch.POSITIVE_LIMIT, 300),
        (19, Switch.HOME, 300),
        (20, Switch.HOME, 300),
        (21, Switch.HOME, -300),
        (22, Switch.HOME, -300),
    ],
)
def test_homing_ends_at_the_edge_of_its_switch(
    bench: ServoBench, method: int, switch: Switch, beyond: int
) -> None:
    homed(bench, method, switch, beyond)
    assert bench.state is ENABLED
    assert abs(bench.position) <= 20
    # At 10 rpm the edge is passed by a third of a count in a ms.
    assert abs(bench.axis.encoder - beyond) <= 25


def test_a_search_turns_at_the_limit_switch(bench: ServoBench) -> None:
    """The home switch lies behind the start: the positive limit leads back to it."""
    bench.write(od.HOMING_METHOD, 23)
    bench.write(od.HOMING_SPEED_SWITCH, 300)
    bench.enable(Mode.HOMING)
    bench.write(od.CONTROLWORD, ENABLE | 0x10)
    seen = set()
    for _ in range(3000):
        bench.run(1)
        place = bench.axis.encoder
        limit = PINS[Switch.POSITIVE_LIMIT] if place >= 400 else 0
        home = PINS[Switch.HOME] if -500 <= place <= -300 else 0
        bench.axis.pins = limit | home
        seen |= {bool(limit), bool(home)}
        if bench.has(BIT_12):
            break
    assert seen == {False, True}
    assert bench.emergencies == []
    # The left edge of the switch.
    assert abs(bench.axis.encoder + 500) <= 60


@pytest.mark.parametrize("method", [35, 37])
def test_the_actual_position_becomes_home_at_once(bench: ServoBench, method: int) -> None:
    bench.enable(Mode.PROFILE_VELOCITY)
    bench.write(od.TARGET_VELOCITY, 600)
    bench.run(300)
    bench.command(SWITCH_ON)
    bench.run(200)
    assert bench.position > 2000
    bench.write(od.HOMING_METHOD, method)
    bench.enable(Mode.HOMING)
    bench.command(ENABLE | 0x10)
    assert abs(bench.position) <= 5
    assert bench.has(BIT_12)


def test_unknown_methods_are_refused(bench: ServoBench) -> None:
    taken = [method for method in range(-128, 128) if bench.write(od.HOMING_METHOD, method) == 0]
    assert taken == [0, *range(1, 15), *range(17, 31), 33, 34, 35, 37]
