"""A link of given bandwidth: the traffic fits into half of it, and only the rate is reduced."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, rars, rars_file

RADIO = 57_600


def bench_at(bandwidth_bit_s: int | None) -> RarsBench:
    """Return RARS on a link that carries so much; with a driver, so that all telemetry is sent."""
    bench = rars()
    bench.robot = bench.robot.discriminated_by(bandwidth_bit_s)
    bench.restart()
    return bench


def sent_in(bench: RarsBench, seconds: int) -> tuple[float, Counter[str]]:
    """Return the bytes a second that go to the link's one end, and what they are."""
    size, kinds = 0, Counter[str]()
    for _ in range(seconds * SECOND // CYCLE):
        bench.now += CYCLE
        bench.facts = replace(bench.facts, now=bench.now)
        for packet in bench.operator.report(bench.snapshot(), (), bench.now):
            if packet.address == 0:
                size += len(packet.payload)
                kinds.update(one.get_type() for one in bench.station.decode(packet.payload))
    return size / seconds, kinds


def test_a_network_is_reported_everything(bench: RarsBench) -> None:
    size, _ = sent_in(bench, 20)
    assert 8_000.0 < size < 9_500.0


@pytest.mark.parametrize("bandwidth", [4_800, 9_600, 19_200, 38_400, RADIO, 115_200, 230_400])
def test_telemetry_takes_no_more_than_half_of_what_the_link_carries(bandwidth: int) -> None:
    size, kinds = sent_in(bench_at(bandwidth), 60)
    assert size <= 0.5 * bandwidth / 10
    assert kinds.keys() >= {
        "HEARTBEAT", "ODOMETRY", "ATTITUDE", "LOCAL_POSITION_NED", "SYS_STATUS", "BATTERY_STATUS", "VFR_HUD"
    }  # fmt: skip
    assert 60 <= kinds["HEARTBEAT"] <= 62, "as often as ever"


def test_a_radio_of_57600_baud_has_the_rows_slow_rates() -> None:
    _, kinds = sent_in(bench_at(RADIO), 60)
    assert 118 <= kinds["ODOMETRY"] <= 122
    assert 238 <= kinds["ATTITUDE"] <= 242
    assert 58 <= kinds["SYS_STATUS"] <= 62


def test_a_wide_link_is_reported_as_much_as_a_network() -> None:
    assert sent_in(bench_at(921_600), 10) == sent_in(bench_at(None), 10)


def test_the_parameters_report_the_rates_that_there_are() -> None:
    bench = bench_at(RADIO)
    [reported] = bench.say(dialect.MAVLink_param_request_read_message(1, 1, b"RATE_ODOM", -1))
    assert reported.param_value == 2.0


def test_a_list_of_parameters_leaves_room_for_words(bench: RarsBench) -> None:
    bench = bench_at(RADIO)
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    at = []
    for _ in range(40):
        bench.now += CYCLE
        sent = bench.operator.report(bench.snapshot(), (), bench.now)
        listed = [one for packet in sent for one in bench.station.decode(packet.payload)]
        at += [bench.now for one in listed if one.get_type() == "PARAM_VALUE"]
    assert len(at) > 10
    assert (at[-1] - at[0]) / (len(at) - 1) >= 22 * MILLISECOND, "37 bytes in 26 ms: a quarter"


def test_what_is_requested_is_sent_however_narrow_the_link_is() -> None:
    bench = bench_at(9_600)
    bench.order(511, 331, 100_000)
    _, kinds = sent_in(bench, 10)
    assert 99 <= kinds["ODOMETRY"] <= 101


def test_the_robot_file_and_the_option_say_the_same() -> None:
    table = rars_file().model_dump()
    table["operator"]["bandwidth_bit_s"] = RADIO
    of_file = type(rars_file()).model_validate(table)
    assert of_file == rars_file().discriminated_by(RADIO)
    assert of_file.discriminated_by(None) is of_file
    table["operator"]["bandwidth_bit_s"] = 4_799
    with pytest.raises(ValueError, match="bandwidth_bit_s"):
        type(rars_file()).model_validate(table)
