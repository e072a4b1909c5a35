"""The SDO server's answers, transfer by transfer (CiA 301 v4.02)."""

from dataclasses import replace

import pytest

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from hil_tests.unit.epos2.quiet_motion import Desk, powered

DOMAIN = "1B2000"
"""0x201B, a domain of any length."""


@pytest.fixture
def desk() -> Desk:
    return powered()


def aborted(address: str, code: AbortCode) -> list[str]:
    return [f"581#80{address}{code.to_bytes(4, 'little').hex().upper()}"]


def test_the_device_name_comes_in_one_segment(desk: Desk) -> None:
    assert desk.receives("601#4008100000000000") == ["581#4108100005000000"]
    assert desk.receives("601#6000000000000000") == ["581#0545504F53320000"]


def test_a_64_bit_number_comes_in_two_segments(desk: Desk) -> None:
    assert desk.receives("601#4004200000000000") == ["581#4104200008000000"]
    assert desk.receives("601#6000000000000000") == ["581#0054590180206600"]
    assert desk.receives("601#7000000000000000") == ["581#1D00000000000000"]


def test_after_the_last_segment_there_is_no_next(desk: Desk) -> None:
    desk.receives("601#4008100000000000")
    desk.receives("601#6000000000000000")
    assert desk.receives("601#7000000000000000") == aborted("000000", AbortCode.UNKNOWN_COMMAND)


def test_an_upload_segment_with_the_same_toggle_ends_the_transfer(desk: Desk) -> None:
    desk.receives("601#4004200000000000")
    desk.receives("601#6000000000000000")
    assert desk.receives("601#6000000000000000") == aborted("042000", AbortCode.TOGGLE)
    assert desk.receives("601#7000000000000000") == aborted("000000", AbortCode.UNKNOWN_COMMAND)


def test_a_number_may_come_in_segments(desk: Desk) -> None:
    assert desk.receives("601#2140600002000000") == ["581#6040600000000000"]
    assert desk.receives("601#0B06000000000000") == ["581#2000000000000000"]
    assert desk.motion.written == [6]


def test_a_domain_takes_many_segments_with_alternating_toggle(desk: Desk) -> None:
    assert desk.receives(f"601#21{DOMAIN}09000000") == [f"581#60{DOMAIN}00000000"]
    assert desk.receives("601#0001020304050607") == ["581#2000000000000000"]
    assert desk.receives("601#1B08090000000000") == ["581#3000000000000000"]
    assert desk.store.read(Address(0x201B)) == bytes(range(1, 10))


def test_a_download_segment_with_the_same_toggle_ends_the_transfer(desk: Desk) -> None:
    desk.receives(f"601#21{DOMAIN}0E000000")
    desk.receives("601#0001020304050607")
    assert desk.receives("601#0101020304050607") == aborted(DOMAIN, AbortCode.TOGGLE)


@pytest.mark.parametrize(
    ("announced", "segment", "code"),
    [
        ("03000000", None, AbortCode.TOO_LONG),
        ("01000000", None, AbortCode.TOO_SHORT),
        ("02000000", "0906000000000000", AbortCode.TOO_LONG),
        ("02000000", "0D06000000000000", AbortCode.TOO_SHORT),
    ],
)
def test_sizes_are_checked_when_announced_and_when_sent(
    desk: Desk, announced: str, segment: str | None, code: AbortCode
) -> None:
    first = desk.receives(f"601#21406000{announced}")
    assert (desk.receives(f"601#{segment}") if segment else first) == aborted("406000", code)
    assert desk.motion.written == []


def test_a_domain_that_stays_short_of_its_announcement_is_refused(desk: Desk) -> None:
    assert desk.receives(f"601#23{DOMAIN}0102") == aborted(DOMAIN, AbortCode.TOO_SHORT)
    desk.receives(f"601#21{DOMAIN}09000000")
    assert desk.receives("601#0101020304050607") == aborted(DOMAIN, AbortCode.TOO_SHORT)
    assert desk.store.read(Address(0x201B)) == b""


def test_a_download_without_a_size_is_checked_at_its_end(desk: Desk) -> None:
    desk.receives("601#2040600000000000")
    assert desk.receives("601#0906000000000000") == aborted("406000", AbortCode.TOO_LONG)


def test_a_domain_without_a_size_has_an_end(desk: Desk) -> None:
    desk.receives(f"601#20{DOMAIN}00000000")
    answers = [desk.receives(f"601#{'10' if odd % 2 else '00'}00000000000000") for odd in range(600)]
    assert aborted(DOMAIN, AbortCode.OUT_OF_MEMORY) in answers


@pytest.mark.parametrize(
    ("request_", "address", "code"),
    [
        ("405A600000000000", "5A6000", AbortCode.NO_OBJECT),
        ("40F9600300000000", "F96003", AbortCode.NO_SUBINDEX),
        ("40C1200000000000", "C12000", AbortCode.WRITE_ONLY),
        ("2B41600000000000", "416000", AbortCode.READ_ONLY),
        ("2008100000000000", "081000", AbortCode.READ_ONLY),
        ("2F40600000000000", "406000", AbortCode.TOO_SHORT),
        ("2340600000000000", "406000", AbortCode.TOO_LONG),
        ("2340600000", "406000", AbortCode.TOO_LONG),
        ("2B40600006", "406000", AbortCode.TOO_SHORT),
        ("22406000", "406000", AbortCode.TOO_SHORT),
        ("2B00200080000000", "002000", AbortCode.TOO_LONG),
        ("237F6000A9610000", "7F6000", AbortCode.TOO_HIGH),
        ("2FC4600507000000", "C46005", AbortCode.TOO_LOW),
        ("2305100081000000", "051000", AbortCode.TOO_HIGH),
        ("2305100000000000", "051000", AbortCode.TOO_LOW),
        ("2F03100001000000", "031000", AbortCode.RANGE),
        ("2F00200000000000", "002000", AbortCode.RANGE),
        ("A008100000000000", "081000", AbortCode.UNKNOWN_COMMAND),
        ("C008100000000000", "081000", AbortCode.UNKNOWN_COMMAND),
        ("E008100000000000", "081000", AbortCode.UNKNOWN_COMMAND),
        ("6000000000000000", "000000", AbortCode.UNKNOWN_COMMAND),
        ("0000000000000000", "000000", AbortCode.UNKNOWN_COMMAND),
        ("", "000000", AbortCode.UNKNOWN_COMMAND),
        ("40", "000000", AbortCode.UNKNOWN_COMMAND),
        ("404160", "416000", AbortCode.UNKNOWN_COMMAND),
    ],
)
def test_what_cannot_be_granted_is_refused_with_the_right_code(
    desk: Desk, request_: str, address: str, code: AbortCode
) -> None:
    assert desk.receives(f"601#{request_}") == aborted(address, code)


def test_an_upload_needs_no_more_than_its_address(desk: Desk) -> None:
    assert desk.receives("601#40001000") == ["581#4300100092010200"]


def test_an_abort_is_not_answered_and_ends_the_transfer(desk: Desk) -> None:
    desk.receives("601#4004200000000000")
    assert desk.receives("601#8004200000000405") == []
    assert desk.receives("601#6000000000000000") == aborted("000000", AbortCode.UNKNOWN_COMMAND)


def test_a_new_request_replaces_the_transfer(desk: Desk) -> None:
    desk.receives("601#4004200000000000")
    desk.receives("601#4041600000000000")
    assert desk.receives("601#6000000000000000") == aborted("000000", AbortCode.UNKNOWN_COMMAND)


def test_an_upload_segment_in_the_middle_of_a_download_ends_it(desk: Desk) -> None:
    desk.receives(f"601#21{DOMAIN}09000000")
    assert desk.receives("601#6000000000000000") == aborted(DOMAIN, AbortCode.UNKNOWN_COMMAND)


def test_an_empty_domain_is_read_as_nothing(desk: Desk) -> None:
    assert desk.receives(f"601#40{DOMAIN}00000000") == [f"581#41{DOMAIN}00000000"]
    assert desk.receives("601#6000000000000000") == ["581#0F00000000000000"]


def test_answers_can_be_made_to_take_time() -> None:
    desk = powered(replace(EPOS2_70_10, sdo_latency=300_000))
    assert desk.receives("601#4000100000000000") == []
    assert desk.waits(299_999) == []
    assert desk.waits(1) == ["581#4300100092010200"]


def test_an_answer_that_takes_time_is_lost_when_the_drive_is_stopped() -> None:
    desk = powered(replace(EPOS2_70_10, sdo_latency=300_000))
    desk.receives("601#4000100000000000")
    desk.receives("000#0201")
    assert desk.waits(1_000_000) == []


def test_a_store_refuses_a_default_for_an_object_that_does_not_exist() -> None:
    with pytest.raises(ValueError, match="0x5555"):
        ObjectStore(EPOS2_70_10.objects, 1, {Address(0x5555): 0})
