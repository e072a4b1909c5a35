"""The set-up rows of every axis: complete, in order, in range, and true to the robot file."""

import pytest

from firmware_bridge import robot as robots
from firmware_bridge.drivers import epos2_setup as setup
from firmware_bridge.drivers.epos2_pdo import pdos
from firmware_bridge.drivers.epos2_setup import Travel
from firmware_bridge.robot import Axis, Mode
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address

ROBOT = robots.find("rars")
AXES = pytest.mark.parametrize("axis", ROBOT.axes, ids=[axis.name for axis in ROBOT.axes])
TRAVEL = Travel(-100_000, 100_000)
SAFETY = (
    at.CONSUMER_HEARTBEAT_1, at.ABORT_CONNECTION_OPTION, at.FAULT_REACTION_OPTION, at.PROFILE_DECELERATION,
    at.QUICK_STOP_DECELERATION, at.MAX_PROFILE_VELOCITY, at.OUTPUT_CURRENT_LIMIT, at.CONTINUOUS_CURRENT_LIMIT,
    at.MAX_FOLLOWING_ERROR, at.ENCODER_PULSES, at.MODE, at.MIN_POSITION_LIMIT, at.MAX_POSITION_LIMIT,
)  # fmt: skip


def rows(axis: Axis) -> tuple[setup.Row, ...]:
    return setup.configuration(axis, ROBOT.bus, TRAVEL)


@AXES
def test_every_value_fits_its_type(axis: Axis) -> None:
    for row in (*setup.identity(axis), *rows(axis), *setup.farewell()):
        assert row.type.lowest <= row.value <= row.type.highest, row
        assert row.type.decode(row.raw) == row.value


@AXES
@pytest.mark.parametrize("address", SAFETY, ids=str)
def test_what_safety_hangs_on_is_read_back(axis: Axis, address: Address) -> None:
    assert [row.read_back for row in rows(axis) if row.address == address] == [True]


@AXES
def test_every_row_says_why_and_from_where(axis: Axis) -> None:
    assert all(row.name and row.why and row.source for row in rows(axis))


@AXES
def test_a_mapping_is_written_while_its_pdo_is_off_and_empty(axis: Axis) -> None:
    for pdo in pdos(axis.mode):
        steps = [row for row in rows(axis) if row.address.index in (pdo.communication, pdo.mapping)]
        cob_ids = [row.value for row in steps if row.address == Address(pdo.communication, 1)]
        assert cob_ids[0] >> 31 == 1
        if pdo.layout is None:
            assert len(steps) == 1
            continue
        counts = [row.value for row in steps if row.address == Address(pdo.mapping, 0)]
        assert steps[0].address == steps[-1].address == Address(pdo.communication, 1)
        assert cob_ids[-1] >> 31 == 0
        assert counts == [0, len(pdo.layout.addresses)]


@AXES
def test_one_set_point_one_status_and_one_sample_are_on(axis: Axis) -> None:
    on = {pdo.cob_id: (pdo.layout.size, pdo.transmission) for pdo in pdos(axis.mode) if pdo.layout}
    set_point = 0x500 if axis.mode is Mode.VELOCITY else 0x400
    assert on == {set_point: (6, 255), 0x180: (2, 255), 0x280: (8, 1)}


def test_the_heartbeat_consumer_names_the_bridge_and_its_time_out() -> None:
    (watch,) = [row for row in rows(ROBOT.axes[0]) if row.address == at.CONSUMER_HEARTBEAT_1]
    assert watch.value == 100 << 16 | 200


def test_a_wheel_has_no_position_limits() -> None:
    without = setup.configuration(ROBOT.axes[0], ROBOT.bus, None)
    assert not {at.MIN_POSITION_LIMIT, at.MAX_POSITION_LIMIT} & {row.address for row in without}


def test_an_answer_of_the_wrong_length_is_shown_as_bytes() -> None:
    row = setup.identity(ROBOT.axes[0])[2]
    assert row.expected == "product code 0x64200000"
    assert row.show(b"\1\2") == "2 bytes 01 02"


@pytest.mark.parametrize(
    ("wish", "allowed"), [(-100_001, -100_000), (-100_000, -100_000), (0, 0), (100_001, 100_000)]
)
def test_a_travel_clips_at_both_ends(wish: int, allowed: int) -> None:
    assert TRAVEL.clip(wish) == allowed
