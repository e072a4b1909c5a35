"""Parameters: listed, read by name and by index, and the few that may be set."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.teleop.streams import parameters_of
from firmware_bridge.units import SECOND
from hil_tests.unit.teleop.bench import rars
from hil_tests.unit.teleop.received import texts

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

RATES = Schedule(((331, SECOND // 20), (32, SECOND // 20), (30, SECOND // 20)), SECOND // 20)
PARAMETERS = parameters_of(rars().robot, rars().rows.parameters, RATES)


def test_parameters_are_listed_once_each_and_slowly(bench: RarsBench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    cycles = [[one for one in bench.report() if one.get_type() == "PARAM_VALUE"] for _ in range(10)]
    assert max(map(len, cycles)) <= 6
    listed = [one for cycle in cycles for one in cycle]
    assert [one.param_index for one in listed] == list(range(len(PARAMETERS)))
    assert [one.param_id for one in listed] == [row.name for row in PARAMETERS]
    assert {one.param_count for one in listed} == {len(PARAMETERS)}
    assert {one.param_type for one in listed} == {9}


def test_a_list_requested_again_begins_again(bench: RarsBench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    bench.report()
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    listed = [one.param_index for _ in range(10) for one in bench.report() if one.get_type() == "PARAM_VALUE"]
    assert listed == list(range(len(PARAMETERS)))


def test_parameter_names_fit_and_are_distinct() -> None:
    names = [row.name for row in PARAMETERS]
    assert len(set(names)) == len(names)
    assert all(1 <= len(name) <= 16 for name in names)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("WHEEL_R", 0.05),
        ("SPD_MAX", 0.5),
        ("STR_MAX", 60.0),
        ("RAD_MIN", 0.415),
        ("CMD_TMO", 0.5),
        ("ACC_MAX", 1.41264),
    ],
)
def test_a_parameter_is_read_by_name_and_by_index(bench: RarsBench, name: str, value: float) -> None:
    [by_name] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, name.encode(), -1))
    assert by_name.param_value == pytest.approx(value)
    [by_index] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, b"", by_name.param_index))
    assert by_index.param_id == name


@pytest.mark.parametrize(
    ("name", "index"), [("NO_SUCH", -1), ("", -1), ("WHEEL_R", len(PARAMETERS)), ("WHEEL_R", -2)]
)
def test_an_unknown_parameter_is_an_error(bench: RarsBench, name: str, index: int) -> None:
    [error] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, name.encode(), index))
    assert (error.get_type(), error.error, error.param_id) == ("PARAM_ERROR", 1, name)
    assert (error.target_system, error.target_component) == (255, 190)


def set_parameter(bench: RarsBench, name: str, value: float) -> list[Any]:
    return bench.say(dialect.MAVLink_param_set_message(1, 1, name.encode(), value, 9))


@pytest.mark.parametrize("row", [row for row in PARAMETERS if row.writable is None], ids=lambda row: row.name)
def test_a_limit_cannot_be_changed_from_afar(bench: RarsBench, row: Any) -> None:
    replies = set_parameter(bench, row.name, 99.0)
    [value] = [one for one in replies if one.get_type() == "PARAM_VALUE"]
    assert value.param_value == struct.unpack("<f", struct.pack("<f", row.first))[0]
    assert any("read-only" in text for text in texts(replies))


@pytest.mark.parametrize("wrong", [20.1, -0.1, float("nan"), float("inf"), -float("inf")])
def test_a_rate_out_of_range_is_answered_with_the_old_value(bench: RarsBench, wrong: float) -> None:
    replies = set_parameter(bench, "RATE_ODOM", wrong)
    [value] = [one for one in replies if one.get_type() == "PARAM_VALUE"]
    assert value.param_value == 20.0
    assert any("0 to 20 Hz" in text for text in texts(replies))


@pytest.mark.parametrize(("rate", "messages"), [(20.0, 20), (5.0, 1 + 5), (0.0, 0)])
def test_a_rate_is_set_and_kept(bench: RarsBench, rate: float, messages: int) -> None:
    [value] = set_parameter(bench, "RATE_ODOM", rate)
    assert value.param_value == rate
    assert sum(one.get_type() == "ODOMETRY" for _ in range(20) for one in bench.report()) == messages


def test_a_name_goes_up_to_its_first_nul(bench: RarsBench) -> None:
    [value] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, b"SPD_MAX\0junk", -1))
    assert value.param_id == "SPD_MAX"
