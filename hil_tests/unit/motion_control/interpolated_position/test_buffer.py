"""The buffer: its levels, too few records and too many, who may write to it."""

from typing import TYPE_CHECKING

import pytest

from emulators.epos2.modes.interpolation_buffer import BUFFER_CLEAR, OVERFLOW_LEVEL, UNDERFLOW_LEVEL
from emulators.epos2.objects.device_profile import BUFFER_FREE, BUFFER_SIZE
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.cia402 import PowerState
from hil_tests.unit.motion_control.interpolated_position.conftest import (
    ACTIVE_BIT,
    ENABLED,
    ERROR,
    OVERFLOW,
    OVERFLOW_WARNING,
    UNDERFLOW,
    UNDERFLOW_WARNING,
    feed,
    status,
)

if TYPE_CHECKING:
    from hil_tests.unit.motion_control.conftest import Drive


@pytest.mark.parametrize("count", [0, 1])
@pytest.mark.emergency(0xFF0C)
def test_fewer_than_two_records_are_an_underflow(ready: "Drive", count: int) -> None:
    feed(ready, *[(0, 0, 10)] * count)
    ready.command(0x1F)
    ready.run(20)
    assert ready.reported == [ERROR]
    assert ready.stands_in(PowerState.FAULT)
    assert status(ready) == UNDERFLOW


@pytest.mark.emergency(0xFF0C)
def test_a_path_that_is_not_fed_stops_with_the_quick_stop_ramp(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 100), (3000, 600, 100))
    ready.command(0x1F)
    ready.run(199)
    assert ready.reported == []
    fastest = 0
    before = ready.read(od.POSITION_DEMAND)
    while not ready.stands_in(PowerState.FAULT):
        ready.run(1)
        here = ready.read(od.POSITION_DEMAND)
        fastest, before = max(fastest, abs(here - before)), here
    assert ready.reported == [ERROR]
    assert status(ready) == UNDERFLOW
    # 600 rpm are 20 qc/ms: nothing jumps; 60 000 rpm/s brake it in 10 ms.
    assert fastest <= 22
    assert before == pytest.approx(3100, abs=15)
    assert not ready.statusword & ACTIVE_BIT


@pytest.mark.emergency(0xFF0C)
def test_after_an_error_the_buffer_must_be_enabled_again(ready: "Drive") -> None:
    ready.command(0x1F)
    ready.run(20)
    assert ready.stands_in(PowerState.FAULT)
    with pytest.raises(SdoAbort) as refused:
        feed(ready, (0, 0, 10))
    assert refused.value.code is AbortCode.DEVICE_STATE
    ready.command(0x80, 0x06, 0x0F)
    ready.write(BUFFER_CLEAR, 1)
    assert status(ready) == ENABLED | UNDERFLOW_WARNING
    here = ready.read(od.POSITION_DEMAND)
    feed(ready, (here, 0, 100), (here + 500, 0, 0))
    ready.command(0x1F)
    ready.run(150)
    assert ready.read(od.POSITION_DEMAND) == here + 500
    assert ready.reported == [ERROR, 0]


@pytest.mark.parametrize(
    ("count", "bits"),
    [(3, UNDERFLOW_WARNING), (4, 0), (60, 0), (61, OVERFLOW_WARNING), (64, OVERFLOW_WARNING)],
)
def test_the_levels_warn(ready: "Drive", count: int, bits: int) -> None:
    feed(ready, *[(0, 0, 10)] * count)
    assert status(ready) == ENABLED | bits


def test_the_levels_are_objects(ready: "Drive") -> None:
    ready.write(UNDERFLOW_LEVEL, 2)
    ready.write(OVERFLOW_LEVEL, 1)
    feed(ready, (0, 0, 10), (0, 0, 10))
    assert status(ready) == ENABLED | OVERFLOW_WARNING


@pytest.mark.emergency(0xFF0C)
def test_the_65th_record_is_an_overflow(ready: "Drive") -> None:
    feed(ready, *[(0, 0, 10)] * 64)
    assert ready.read(BUFFER_FREE) == 0
    with pytest.raises(SdoAbort) as refused:
        feed(ready, (0, 0, 10))
    assert refused.value.code is AbortCode.OUT_OF_MEMORY
    ready.control.refresh(ready.now)
    ready.run(20)
    assert ready.reported == [ERROR]
    assert ready.stands_in(PowerState.FAULT)
    assert status(ready) == OVERFLOW


def test_a_full_buffer_in_another_mode_is_no_fault(ready: "Drive") -> None:
    ready.write(od.MODE, 1)
    feed(ready, *[(0, 0, 10)] * 64)
    with pytest.raises(SdoAbort):
        feed(ready, (0, 0, 10))
    ready.control.refresh(ready.now)
    ready.run(20)
    assert ready.reported == []


def test_records_may_be_there_before_the_drive_is_enabled(drive: "Drive") -> None:
    drive.store.set(BUFFER_SIZE, 64)
    drive.write(od.MODE, 7)
    drive.write(BUFFER_CLEAR, 1)
    feed(drive, (0, 0, 20), (100, 0, 0))
    drive.enable()
    drive.command(0x1F)
    drive.run(60)
    assert drive.read(od.POSITION_DEMAND) == 100


@pytest.mark.emergency(0xFF0C)
def test_taking_the_access_away_under_way_stops_the_path(ready: "Drive") -> None:
    feed(ready, (0, 0, 100), (1000, 600, 100), (3000, 600, 100), (4000, 0, 0))
    ready.command(0x1F)
    ready.run(120)
    ready.write(BUFFER_CLEAR, 0)
    ready.run(30)
    assert ready.reported == [ERROR]
    assert status(ready) == UNDERFLOW


def test_a_restart_empties_the_buffer(ready: "Drive") -> None:
    feed(ready, (0, 0, 10), (0, 0, 10))
    ready.control.reset()
    assert ready.read(BUFFER_FREE) == 64
    assert status(ready) == 0
