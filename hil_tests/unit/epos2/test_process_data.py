"""PDOs on the bus: when they are taken, and when they leave."""

from dataclasses import replace

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.epos2.quiet_motion import Desk, operational, powered, set_up, u32

TELEMETRY = (
    # The robot's transmit PDO 2: statusword, position, averaged current with each SYNC.
    (0x1801, 1, u32(0xC000_0281)),
    (0x1A01, 0, b"\0"),
    (0x1A01, 1, u32(0x6041_0010)),
    (0x1A01, 2, u32(0x6064_0020)),
    (0x1A01, 3, u32(0x2027_0010)),
    (0x1A01, 0, b"\x03"),
    (0x1801, 2, b"\x01"),
    (0x1801, 1, u32(0x4000_0281)),
)
POSITION_ON_CHANGE = ((0x1802, 1, u32(0x4000_0381)),)


@pytest.fixture
def desk() -> Desk:
    return operational()


# Receive PDOs


def test_a_pdo_writes_its_objects_in_their_order(desk: Desk) -> None:
    desk.receives("401#0F00D2040000")
    assert desk.motion.written == [0x000F]
    assert desk.store.get(od.TARGET_POSITION) == 1234


def test_a_longer_pdo_is_taken_and_its_surplus_ignored(desk: Desk) -> None:
    desk.receives("201#0F00FFFF")
    assert desk.motion.written == [0x000F]


def test_a_longer_pdo_can_be_made_to_be_ignored() -> None:
    desk = operational(replace(EPOS2_70_10, accepts_long_pdo=False))
    assert desk.receives("201#0F00FF") == []
    assert desk.motion.written == []


@pytest.mark.parametrize("frame", ["201#", "201#0F", "501#0F00000000"])
@pytest.mark.emergency(0x8210)
def test_a_shorter_pdo_writes_nothing_and_is_an_emergency(desk: Desk, frame: str) -> None:
    assert desk.receives(frame) == ["081#1082100000000000"]
    assert desk.motion.written == []


def test_a_value_out_of_range_is_dropped_and_the_others_count(desk: Desk) -> None:
    desk.receives("000#8001")
    set_up(
        desk,
        (0x1400, 1, u32(0x8000_0201)),
        (0x1600, 0, b"\0"),
        (0x1600, 1, u32(0x6410_0110)),
        (0x1600, 2, u32(0x6040_0010)),
        (0x1600, 0, b"\x02"),
        (0x1400, 1, u32(0x201)),
    )
    desk.receives("000#0101")
    desk.receives("201#11270F00")
    assert desk.store.get(at.CONTINUOUS_CURRENT_LIMIT) == 10_000
    assert desk.motion.written == [0x000F]


@pytest.mark.parametrize("command", ["8001", "0201"])
def test_outside_operational_a_pdo_is_not_received(desk: Desk, command: str) -> None:
    desk.receives(f"000#{command}")
    assert desk.receives("201#0F00") == []
    assert desk.receives("201#0F") == []
    assert desk.motion.written == []


def test_a_synchronous_pdo_waits_for_sync_and_the_latest_counts() -> None:
    desk = set_up(operational(), (0x1400, 2, b"\x01"))
    desk.receives("201#0600")
    desk.receives("201#0F00")
    assert desk.motion.written == []
    desk.receives("080#")
    assert desk.motion.written == [0x000F]
    desk.receives("080#")
    assert desk.motion.written == [0x000F]


def test_a_synchronous_pdo_is_forgotten_outside_operational() -> None:
    desk = set_up(operational(), (0x1400, 2, b"\x01"))
    desk.receives("201#0600")
    for frame in ("000#8001", "000#0101", "080#"):
        desk.receives(frame)
    assert desk.motion.written == []


def test_two_pdos_may_share_an_identifier() -> None:
    desk = set_up(operational(), (0x1402, 1, u32(0x201)))
    desk.receives("201#0F0001000000")
    assert desk.motion.written == [0x000F, 0x000F]
    assert desk.store.get(od.TARGET_POSITION) == 1


# Transmit PDOs


def test_with_sync_the_telemetry_leaves_every_time() -> None:
    desk = set_up(powered(), *TELEMETRY)
    desk.receives("000#0101")
    desk.store.on_read(od.POSITION_ACTUAL, lambda: -2)
    desk.store.on_read(at.CURRENT_AVERAGED, lambda: 300)
    assert desk.receives("080#") == ["281#4007FEFFFFFF2C01"]
    assert desk.receives("080#00") == ["281#4007FEFFFFFF2C01"]
    assert desk.waits(100 * MILLISECOND) == []


def test_with_sync_values_are_sampled_before_set_values_are_taken_over() -> None:
    desk = set_up(powered(), *TELEMETRY, (0x1400, 2, b"\x01"))
    desk.receives("000#0101")
    desk.store.on_write(od.CONTROLWORD, lambda _: desk.store.set(od.STATUSWORD, 0x0721))
    desk.waits(10 * MILLISECOND)
    desk.receives("201#0600")
    assert desk.receives("080#") == ["281#4007000000000000", "181#2107"]


def test_in_pre_operational_sync_moves_no_pdo() -> None:
    desk = set_up(powered(), *TELEMETRY)
    assert desk.receives("080#") == []


def test_on_entering_operational_a_pdo_on_change_is_sent_once() -> None:
    desk = powered()
    assert desk.receives("000#0100") == ["181#4007"]
    assert desk.receives("000#0100") == []
    assert desk.waits(1000 * MILLISECOND) == []
    assert desk.receives("000#8000") == []
    assert desk.receives("000#0100") == ["181#4007"]


def test_the_first_message_can_be_left_out() -> None:
    assert powered(replace(EPOS2_70_10, sends_on_start=False)).receives("000#0100") == []


def test_a_pdo_switched_on_in_operational_begins_as_on_entering_it() -> None:
    desk = operational()
    (answer, message) = desk.receives("601#2301180181020040")
    assert (answer[:6], message) == ("581#60", "281#400701")
    desk = operational(replace(EPOS2_70_10, sends_on_start=False))
    assert len(desk.receives("601#2301180181020040")) == 1


def test_the_inhibit_time_keeps_changes_apart_and_the_last_value_is_reported(desk: Desk) -> None:
    desk.store.set(od.STATUSWORD, 0x0721)
    assert desk.receives("080#") == ["181#2107"]
    desk.store.set(od.STATUSWORD, 0x0723)
    assert desk.receives("080#") == []
    desk.store.set(od.STATUSWORD, 0x0737)
    assert desk.waits(MILLISECOND - 1) == []
    assert desk.waits(1) == ["181#3707"]
    assert desk.waits(10 * MILLISECOND) == []


def test_a_change_that_went_away_is_not_reported(desk: Desk) -> None:
    desk.store.set(od.STATUSWORD, 0x0721)
    assert desk.receives("080#") == ["181#2107"]
    desk.store.set(od.STATUSWORD, 0x0723)
    desk.receives("080#")
    desk.store.set(od.STATUSWORD, 0x0721)
    assert desk.waits(10 * MILLISECOND) == []


def test_the_inhibit_time_is_in_units_of_100_us() -> None:
    desk = set_up(operational(), (0x1800, 3, (25).to_bytes(2, "little")))
    desk.waits(10 * MILLISECOND)
    desk.store.set(od.STATUSWORD, 0x0721)
    assert desk.receives("080#") == ["181#2107"]
    desk.store.set(od.STATUSWORD, 0x0723)
    desk.receives("080#")
    assert desk.waits(2_500_000 - 1) == []
    assert desk.waits(1) == ["181#2307"]


def test_a_value_that_moves_by_itself_is_polled_every_millisecond() -> None:
    desk = set_up(powered(), *POSITION_ON_CHANGE)
    desk.store.on_read(od.POSITION_ACTUAL, lambda: desk.now // (2 * MILLISECOND))
    assert desk.receives("000#0101") == ["181#4007", "381#400700000000"]
    assert desk.waits(5 * MILLISECOND) == ["381#400701000000", "381#400702000000"]


def test_without_moving_values_the_drive_is_not_woken(desk: Desk) -> None:
    desk.receives("080#")
    assert desk.due > 10**18


def test_an_invalid_pdo_states_and_receives_nothing() -> None:
    desk = set_up(powered(), (0x1800, 1, u32(0xC000_0181)), (0x1400, 1, u32(0x8000_0201)))
    assert desk.receives("000#0101") == []
    assert desk.receives("201#0F") == []
    assert desk.motion.written == []


def test_an_empty_pdo_sends_nothing() -> None:
    desk = set_up(powered(), (0x1800, 1, u32(0xC000_0181)), (0x1A00, 0, b"\0"), (0x1800, 1, u32(0x4000_0181)))
    assert desk.receives("000#0101") == []


@pytest.mark.parametrize(("cob_id", "answers"), [(0x4000_0181, []), (0x181, ["181#4007"])])
def test_a_remote_request_is_answered_where_it_is_allowed(cob_id: int, answers: list[str]) -> None:
    desk = set_up(operational(), (0x1800, 1, u32(cob_id)))
    desk.waits(10 * MILLISECOND)
    assert desk.receives("181#R2") == answers
    desk.receives("000#8001")
    assert desk.receives("181#R2") == []


@pytest.mark.emergency(0x8150)
def test_someone_else_with_the_drive_s_identifier_is_an_emergency(desk: Desk) -> None:
    assert desk.receives("181#4007") == ["081#5081100000000000"]
