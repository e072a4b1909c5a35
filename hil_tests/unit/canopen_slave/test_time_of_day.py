"""TIME: its six bytes, and the device that takes it."""

from datetime import datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen.time_of_day import EPOCH, decode_time, encode_time
from firmware_bridge.units import SECOND
from hil_tests.unit.canopen_slave.plain_slave import PlainSlave

NOON = datetime(2026, 3, 1, 12)  # noqa: DTZ001 - TIME has no time zone
PAYLOAD = "002E930227" + "3C"
"""12 h = 43,200,000 ms = 0x02932E00; 15,400 days after 1984-01-01 = 0x3C28; by hand, less one day."""


def test_the_bytes_are_those_of_the_standard() -> None:
    # 1984-01-01 to 2026-03-01: 42 years of 365 days, 11 leap days, 31 + 28 days = 15,400.
    assert encode_time(NOON).hex().upper() == "002E9302283C"
    assert decode_time(bytes.fromhex(PAYLOAD)) == NOON - timedelta(days=1)


@given(st.datetimes(EPOCH, EPOCH + timedelta(days=65_535)))
def test_what_is_encoded_is_decoded_to_the_millisecond(time: datetime) -> None:
    decoded = decode_time(encode_time(time))
    assert decoded is not None
    assert timedelta(0) <= time - decoded < timedelta(milliseconds=1)


def test_reserved_bits_do_not_count_and_a_short_message_is_none() -> None:
    assert decode_time(bytes.fromhex("002E93F2283C")) == NOON
    assert decode_time(bytes.fromhex("002E930228")) is None


@pytest.mark.parametrize("time", [EPOCH - timedelta(seconds=1), EPOCH + timedelta(days=65_536)])
def test_a_time_outside_the_message_is_refused(time: datetime) -> None:
    with pytest.raises(ValueError, match="1984-01-01 to 2163-06-06"):
        encode_time(time)


def test_a_device_keeps_the_time_until_it_is_switched_off() -> None:
    slave = PlainSlave()
    slave.wakes(0)
    assert slave.slave.time_of_day(0) is None
    slave.takes("100#002E9302283C")
    assert slave.slave.time_of_day(90 * SECOND) == NOON + timedelta(seconds=90)
    slave.takes("100#00")
    assert slave.slave.time_of_day(0) == NOON
    slave.takes("000#8105")
    assert slave.slave.time_of_day(0) is None


def test_a_device_whose_object_consumes_nothing_takes_no_time() -> None:
    slave = PlainSlave()
    slave.wakes(0)
    assert slave.takes("605#2312100000010000") == ["585#6012100000000000"]
    slave.takes("100#002E9302283C")
    assert slave.slave.time_of_day(0) is None
