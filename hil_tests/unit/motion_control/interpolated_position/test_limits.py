"""Records beyond a limit: of velocity, acceleration or position, and a limit switch on the way."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.objects.device_profile import BUFFER_FREE
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire.functions import INPUT_EXECUTION
from hil_tests.unit.motion_control.interpolated_position.conftest import (
    ACCELERATION,
    ACCELERATION_WARNING,
    ACTIVE,
    ACTIVE_BIT,
    ENABLED,
    ERROR,
    UNDERFLOW_WARNING,
    VELOCITY,
    VELOCITY_WARNING,
    feed,
    status,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.parametrize(
    ("limit", "value", "bits", "error"),
    [
        (od.PROFILE_VELOCITY, 900, 0, 0),
        (od.PROFILE_VELOCITY, 899, VELOCITY_WARNING, 0),
        (od.PROFILE_ACCELERATION, 36_000, 0, 0),
        (od.PROFILE_ACCELERATION, 35_999, ACCELERATION_WARNING, 0),
        (od.MAX_PROFILE_VELOCITY, 900, 0, 0),
        (od.MAX_PROFILE_VELOCITY, 899, 0, VELOCITY),
        (od.MAX_ACCELERATION, 36_000, 0, 0),
        (od.MAX_ACCELERATION, 35_999, ACCELERATION_WARNING, ACCELERATION),
    ],
)
@pytest.mark.emergency(0xFF0C)
def test_limits_of_velocity_and_acceleration(
    ready: "Drive", limit: Address, value: int, bits: int, error: int
) -> None:
    # From rest to rest over 2000 qc in 100 ms: 1.5 x 20 qc/ms = 900 rpm, and 6 x 2000/100^2 = 1.2 qc/ms2.
    ready.write(od.PROFILE_ACCELERATION, 100_000)
    ready.write(limit, value)
    feed(ready, (0, 0, 100), (2000, 0, 0))
    ready.command(0x1F)
    ready.run(50)
    if error:
        assert status(ready) == error
        assert ready.reported == [ERROR]
        assert ready.read(od.POSITION_DEMAND) == 0
    else:
        assert status(ready) & ~UNDERFLOW_WARNING == ENABLED | ACTIVE | bits
        assert ready.reported == []


@pytest.mark.emergency(0xFF0C)
def test_a_first_record_far_away_is_a_velocity_error_and_moves_nothing(ready: "Drive") -> None:
    feed(ready, (5000, 0, 100), (5100, 0, 0))
    ready.command(0x1F)
    ready.run(50)
    assert status(ready) == VELOCITY
    assert ready.read(od.POSITION_DEMAND) == pytest.approx(0, abs=1)


@pytest.mark.emergency(0xFF09)
def test_a_record_beyond_the_software_limits_is_not_run_to(ready: "Drive") -> None:
    ready.write(od.MAX_POSITION_LIMIT, 1000)
    feed(ready, (0, 0, 100), (1000, 0, 100), (1001, 0, 0))
    ready.command(0x1F)
    ready.run(250)
    assert ready.reported == [0xFF09]
    assert ready.read(od.POSITION_DEMAND) <= 1000


@pytest.mark.emergency(0xFF0C)
@pytest.mark.parametrize("first", [(10, 0), (0, 300), (-10, 0)])
def test_a_first_record_that_is_a_jolt_is_an_acceleration_error(
    ready: "Drive", first: tuple[int, int]
) -> None:
    ready.write(od.MAX_ACCELERATION, 100_000)
    position, velocity = first
    feed(ready, (position, velocity, 100), (position + 20, 0, 0))
    ready.command(0x1F)
    ready.run(20)
    assert status(ready) == ACCELERATION
    assert ready.reported == [ERROR]
    assert ready.read(BUFFER_FREE) == 64


@pytest.mark.emergency(0xFF07)
def test_a_path_into_a_limit_switch_ends_there(ready: "Drive") -> None:
    ready.write(INPUT_EXECUTION, 0x0003)
    feed(ready, (0, 0, 100), *[(1000 + 2000 * k, 600, 100) for k in range(8)])
    ready.command(0x1F)
    ready.run(250)
    assert ready.reported == []
    ready.axis.pins = 1 << 4
    ready.run(20)
    assert ready.reported == [0xFF07]
    assert not ready.statusword & ACTIVE_BIT


@pytest.mark.parametrize(
    ("third", "code"),
    [((900, 0, 0), 0), ((901, 0, 0), 0xFF09), ((900, 25_001, 0), ERROR), ((2**31 - 1, 0, 0), 0xFF09)],
)
@pytest.mark.emergency(0xFF0C, 0xFF09)
def test_the_axis_never_gets_a_segment_that_may_not_run(
    ready: "Drive", third: tuple[int, int, int], code: int
) -> None:
    ready.write(od.MAX_POSITION_LIMIT, 900)
    ready.write(od.MAX_PROFILE_VELOCITY, 2000)
    feed(ready, (0, 0, 50), (500, 0, 50), third)
    ready.command(0x1F)
    ready.run(20)
    assert ready.axis.next_ms == (0 if code else 50)
    assert ready.reported == []
    ready.run(100)
    assert ready.reported == ([code] if code else [])
    # Without power the demand is where the shaft is.
    assert ready.read(od.POSITION_DEMAND) == pytest.approx(500 if code else 900, abs=5)
