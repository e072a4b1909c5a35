"""The set-up rows of every axis: complete, in order, in range, and true to the robot file."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen_drive.driver.process_data import pdos
from firmware_bridge.canopen_drive.driver.setup import farewell
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.families.epos2.driver.product import configuration, identity
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import (
    OUTPUT_MASK,
    OUTPUT_PINS,
    OUTPUT_POLARITY,
    OUTPUT_STATE,
)
from firmware_bridge.robot import Axis, CommandForm, Output
from hil_tests.unit.drivers.robots import LINK, RARS, with_axis

TABLE = Epos2Link.of_link(RARS, LINK)
AXES = pytest.mark.parametrize("axis", RARS.axes, ids=[axis.name for axis in RARS.axes])
SAFETY = (
    od.CONSUMER_HEARTBEAT_1, od.ABORT_CONNECTION_OPTION, od.FAULT_REACTION_OPTION, od.PROFILE_DECELERATION,
    od.QUICK_STOP_DECELERATION, od.MAX_PROFILE_VELOCITY, at.OUTPUT_CURRENT_LIMIT, at.CONTINUOUS_CURRENT_LIMIT,
    od.MAX_FOLLOWING_ERROR, at.ENCODER_PULSES, od.MODE, od.MIN_POSITION_LIMIT, od.MAX_POSITION_LIMIT,
)  # fmt: skip


def rows(axis: Axis) -> tuple[SetupObject, ...]:
    return configuration(axis if axis.travel else with_axis(axis, travel=(-9.0, 9.0)), TABLE)


@AXES
def test_every_value_fits_its_type(axis: Axis) -> None:
    for row in (*identity(axis), *rows(axis), *farewell()):
        assert row.type.lowest <= row.value <= row.type.highest, row
        assert row.type.decode(row.raw) == row.value


@AXES
@pytest.mark.parametrize("address", SAFETY, ids=str)
def test_what_safety_hangs_on_is_read_back(axis: Axis, address: Address) -> None:
    assert [row.read_back for row in rows(axis) if row.address == address] == [True]


@AXES
def test_every_row_states_why_and_from_where(axis: Axis) -> None:
    assert all(row.name and row.why and row.source for row in rows(axis))


@AXES
def test_a_mapping_is_written_while_its_pdo_is_off_and_empty(axis: Axis) -> None:
    for pdo in pdos(axis, at.CURRENT_AVERAGED):
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
def test_the_pdos_that_are_on(axis: Axis) -> None:
    on = {
        pdo.cob_id: (pdo.layout.size, pdo.transmission)
        for pdo in pdos(axis, at.CURRENT_AVERAGED)
        if pdo.layout
    }
    wheel = axis.command is CommandForm.SPEED
    set_point = 0x500 if wheel else 0x400
    # The wheels take their quick stop deceleration; the steering sends its position between the samples.
    braking = {0x200: (4, 255)} if wheel else {}
    leads = {0x380: (4, 255)} if axis.name == "steer" else {}
    assert on == {set_point: (6, 255), 0x180: (2, 255), 0x280: (8, 1), **braking, **leads}


def test_a_position_between_the_samples_has_the_inhibit_time_of_the_file() -> None:
    inhibit = {row.address: row.value for row in rows(RARS.axis("steering")) if row.address.subindex == 3}
    # In units of 100 us (CiA 301): 10 ms, and 1 ms for what else is sent on change.
    assert inhibit[Address(0x1802, 3)] == 100
    assert inhibit[Address(0x1800, 3)] == 10


def test_the_heartbeat_consumer_names_the_bridge_and_its_time_out() -> None:
    (watch,) = [row for row in rows(RARS.axes[0]) if row.address == od.CONSUMER_HEARTBEAT_1]
    assert watch.value == 100 << 16 | 200


def test_an_axis_without_travel_has_no_position_limits() -> None:
    without = configuration(RARS.axes[0], TABLE)
    assert not {od.MIN_POSITION_LIMIT, od.MAX_POSITION_LIMIT} & {row.address for row in without}


@pytest.mark.parametrize(
    ("named", "found", "right"),
    [
        # The 50/5 has two hardware versions: 0x6322 by its EDS, 0x6320 by names of firmware files.
        (0x6320_0000, 0x6322_0000, True),
        (0x6322_0000, 0x6320_0000, True),
        (0x6322_0000, 0x6322_0000, True),
        (0x6322_0000, 0x6322_0001, False),
        (0x6322_0000, 0x6420_0000, False),
        (0x6420_0000, 0x6322_0000, False),
        # What no source names is like itself alone.
        (0x1234_0000, 0x1234_0000, True),
        (0x1234_0000, 0x1235_0000, False),
        (0x6120_0000, 0x6220_0000, False),
    ],
)
def test_the_identity_is_the_types_whatever_its_hardware_version(
    named: int, found: int, *, right: bool
) -> None:
    epos2 = Epos2Axis.of(RARS.axes[0]).model_copy(update={"product_code": named})
    product = identity(RARS.axes[0].model_copy(update={"settings": epos2}))[2]
    assert product.expected == f"product code 0x{named:08X}"
    assert product.has(found.to_bytes(4, "little")) is right


def test_an_answer_of_the_wrong_length_is_shown_as_bytes() -> None:
    row = identity(RARS.axes[0])[2]
    assert row.expected == "product code 0x64200000"
    assert row.show(b"\1\2") == "2 bytes 01 02"


@pytest.mark.parametrize("direction", [1, -1])
def test_the_position_limits_are_the_travel_and_the_following_error(direction: int) -> None:
    """RARS's lift: extended, it has turned its motor by 2890879 quadcounts (thesis 2.5)."""
    lift = with_axis(RARS.axis("lift"), direction=direction)
    limits = {row.address: row.value for row in configuration(lift, TABLE)}
    low, high = sorted((0, direction * 2_890_879))
    assert limits[od.MIN_POSITION_LIMIT] == low - 4_000
    assert limits[od.MAX_POSITION_LIMIT] == high + 4_000


def output(pin: int) -> Output:
    settings = {"axis": "left", "output": pin}
    return Output.model_validate({"name": f"lamp{pin}", "title": "lamp", "link": LINK, "settings": settings})


def test_a_drive_without_outputs_keeps_its_pins() -> None:
    pins = {0x2078, 0x2079}
    assert not [row for row in configuration(RARS.axes[0], TABLE) if row.address.index in pins]


def test_an_output_gets_a_pin_and_a_bit_in_the_mask() -> None:
    """Pin 1 is general purpose A, bit 15, as in the EDS; polarity and state are left alone."""
    rows = {row.address: row for row in configuration(RARS.axes[0], TABLE, (output(1), output(4)))}
    assert [rows[OUTPUT_PINS[pin - 1]].value for pin in (1, 4)] == [15, 12]
    assert rows[OUTPUT_MASK].value == 0x9000
    assert rows[OUTPUT_MASK].read_back
    assert not {OUTPUT_POLARITY, OUTPUT_STATE, OUTPUT_PINS[1]} & set(rows)
