"""Settings that take effect with a restart only: node number and bit rate; and layer setting services.

Sources: EPOS Firmware Specification (by analogy); CiA 305 for the frames of layer setting.
"""

import pytest

from emulators.canopen.saved_parameters import Volatile
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.epos2.quiet_motion import Desk

STOP, RESET_NODE, RESET_COMMUNICATION = "000#0200", "000#8100", "000#8200"


def desk(node: int = 1, bus_rate: int | None = None, storage: Volatile | None = None) -> Desk:
    made = Desk(node=node, storage=storage, bus_rate=bus_rate)
    made.powers()
    return made


def test_a_saved_number_counts_after_a_restart_while_the_switch_is_0() -> None:
    storage = Volatile()
    drive = desk(0, storage=storage)
    assert drive.reads(0x2009) == 0
    assert drive.writes(0x2000, 0, b"\x07") == "ok"
    assert drive.reads(0x2000) == 7, "written, and not in use"
    assert drive.receives(RESET_NODE) == ["701#00"]
    drive.writes(0x2000, 0, b"\x07")
    drive.writes(0x1010, 1, b"save")
    assert drive.receives(RESET_NODE) == ["707#00"]
    assert drive.receives("601#4000100000000000") == []
    assert drive.receives("607#4000100000000000") == ["587#4300100092010200"]
    assert Desk(node=0, storage=storage).powers() == ["707#00"]


def test_a_saved_number_is_nothing_against_the_switch() -> None:
    drive = desk(1)
    drive.writes(0x2000, 0, b"\x07")
    drive.writes(0x1010, 1, b"save")
    assert drive.receives(RESET_NODE) == ["701#00"]
    assert drive.reads(0x2000) == 7


def test_saved_cob_ids_stay_with_the_old_number_until_they_are_restored() -> None:
    drive = desk(0)
    drive.writes(0x2000, 0, b"\x07")
    drive.writes(0x1010, 1, b"save")
    drive.receives(RESET_NODE)
    answer = "607#4000140100000000"
    assert drive.receives(answer) == ["587#4300140101020000"]
    assert drive.receives("607#231110056C6F6164") == ["587#6011100500000000"]
    assert drive.receives("607#2310100173617665") == ["587#6010100100000000"]
    drive.receives(RESET_NODE)
    assert drive.receives(answer) == ["587#4300140107020000"]


def test_a_saved_bit_rate_takes_the_drive_off_the_bus_at_the_restart() -> None:
    storage = Volatile()
    drive = desk(bus_rate=1_000_000, storage=storage)
    assert drive.writes(0x2001, 0, b"\x02\0") == "ok"
    drive.writes(0x1010, 1, b"save")
    assert drive.reads(0x200A) == 0, "in use until the restart"
    assert drive.receives(RESET_NODE) == []
    assert drive.receives("601#4000100000000000") == []
    assert Desk(storage=storage, bus_rate=1_000_000).powers() == []
    found = desk(bus_rate=500_000, storage=storage)
    assert found.reads(0x200A) == 2


def test_reserved_and_unknown_bit_rates_are_refused() -> None:
    drive = desk()
    assert drive.writes(0x2001, 0, b"\x05\0") == "06090030"
    assert drive.writes(0x2001, 0, b"\x09\0") == "06090031"


# Layer setting: only while Stopped.

SERIAL = f"{EPOS2_70_10.serial_number & 0xFFFF_FFFF:08x}"
SELECT = ("40FB000000000000", "4100002064000000", "4200002621000000", "4354590180000000")


def configuring(drive: Desk) -> Desk:
    drive.receives(STOP)
    assert drive.receives("7E5#0401000000000000") == []
    return drive


@pytest.mark.parametrize("state", ["000#0100", "000#8000"])
def test_layer_setting_rests_outside_stopped(state: str) -> None:
    drive = desk()
    drive.receives(state)
    assert drive.receives("7E5#0401000000000000") == []
    assert drive.receives("7E5#5E00000000000000") == []


def test_the_inquiries_report_identity_and_number() -> None:
    assert SERIAL == "80015954"
    drive = configuring(desk(5))
    assert drive.receives("7E5#5A00000000000000") == ["7E4#5AFB000000000000"]
    assert drive.receives("7E5#5B00000000000000") == ["7E4#5B00002064000000"]
    assert drive.receives("7E5#5C00000000000000") == ["7E4#5C00002621000000"]
    assert drive.receives("7E5#5D00000000000000") == ["7E4#5D54590180000000"]
    assert drive.receives("7E5#5E00000000000000") == ["7E4#5E05000000000000"]


def test_a_waiting_slave_is_silent() -> None:
    drive = configuring(desk())
    assert drive.receives("7E5#0400000000000000") == []
    assert drive.receives("7E5#5E00000000000000") == []


def test_a_slave_is_selected_by_its_four_numbers_in_their_order() -> None:
    drive = desk()
    drive.receives(STOP)
    stated = [drive.receives(f"7E5#{frame}") for frame in SELECT]
    assert stated == [[], [], [], ["7E4#4400000000000000"]]
    assert drive.receives("7E5#5E00000000000000") == ["7E4#5E01000000000000"]


@pytest.mark.parametrize("wrong", range(4))
def test_one_wrong_number_selects_no_one(wrong: int) -> None:
    drive = desk()
    drive.receives(STOP)
    frames = list(SELECT)
    frames[wrong] = frames[wrong][:2] + "01" + frames[wrong][4:]
    assert [drive.receives(f"7E5#{frame}") for frame in frames] == [[], [], [], []]
    assert drive.receives("7E5#5E00000000000000") == []


def test_a_slave_is_identified_by_ranges() -> None:
    drive = desk()
    drive.receives(STOP)
    frames = (
        "46FB000000000000",
        "4700002064000000",
        "4800000000000000",
        "49FFFFFFFF000000",
        "4A54590180000000",
        "4B54590180000000",
    )
    stated = [drive.receives(f"7E5#{frame}") for frame in frames]
    assert stated == [[], [], [], [], [], ["7E4#4F00000000000000"]]
    frames = (*frames[:4], "4A55590180000000", frames[5])
    assert [drive.receives(f"7E5#{frame}") for frame in frames] == [[]] * 6
    assert drive.receives("7E5#4C00000000000000") == [], "it has a number"


def test_a_number_is_set_and_counts_with_the_next_reset_of_communication() -> None:
    drive = configuring(desk(0))
    assert drive.receives("7E5#1109000000000000") == ["7E4#1100000000000000"]
    assert drive.receives("7E5#1180000000000000") == ["7E4#1101000000000000"]
    assert drive.receives("7E5#1100000000000000") == ["7E4#1101000000000000"]
    assert drive.receives(RESET_COMMUNICATION) == ["709#00"]
    assert drive.receives("000#8109") == ["701#00"], "not stored"


def test_a_stored_number_survives() -> None:
    storage = Volatile()
    drive = configuring(desk(0, storage=storage))
    drive.receives("7E5#1109000000000000")
    assert drive.receives("7E5#1700000000000000") == ["7E4#1700000000000000"]
    assert Desk(node=0, storage=storage).powers() == ["709#00"]


def test_a_bit_rate_is_activated_after_a_delay() -> None:
    drive = configuring(desk(bus_rate=1_000_000))
    assert drive.receives("7E5#1300050000000000") == ["7E4#1301000000000000"], "reserved"
    assert drive.receives("7E5#1301020000000000") == ["7E4#1301000000000000"], "no such table"
    assert drive.receives("7E5#1300000000000000") == ["7E4#1300000000000000"]
    assert drive.receives("7E5#150A000000000000") == []
    assert drive.receives("7E5#5E00000000000000") == [], "quiet before the change"
    assert drive.waits(15 * MILLISECOND) == []
    assert drive.receives("7E5#5E00000000000000") == [], "and after it"
    drive.waits(6 * MILLISECOND)
    assert drive.receives("7E5#5E00000000000000") == ["7E4#5E01000000000000"]
    drive.receives("7E5#1300020000000000")
    drive.receives("7E5#1500000000000000")
    drive.waits(MILLISECOND)
    assert drive.receives("7E5#5E00000000000000") == [], "the bus runs at another rate"


@pytest.mark.parametrize("frame", ["", "04", "04010000000000", "FF00000000000000", "0600000000000000"])
def test_what_is_no_layer_setting_request_gets_no_answer(frame: str) -> None:
    drive = configuring(desk())
    assert drive.receives(f"7E5#{frame}") == []
    assert drive.receives("7E5#5E00000000000000") == ["7E4#5E01000000000000"]


def test_a_drive_that_loses_its_supply_sends_nothing_and_starts_again() -> None:
    drive = desk()
    drive.receives("000#0100")
    resets = drive.motions[0].resets
    drive.drive.switch_off()
    assert drive.motions[0].resets == resets + 1, "its motor is without power"
    assert drive.receives("601#4000100000000000") == ["701#00"], "the first frame finds it switched on again"
    assert drive.reads(0x1000) == 0x20192
