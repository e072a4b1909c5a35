"""Frames recorded from EPOS2 drives, or printed by maxon, replayed against the emulated drive.

Sources, as named at each test: a candump picture in the repository kay01-kwon/EPOS2_CAN_TEST_CPP; EPOS2
Application Notes Collection, April 2013; a driver of an exoskeleton with EPOS2 drives; Pejman712/CRF;
SamsonChau/Maxon-Moter-control-using-EPOS-2-and-STM32-.
"""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from hil_tests.unit.epos2.quiet_motion import Desk, operational, powered

RTR_ONLY = (
    # What the recorded drive had been given: transmit PDOs on request, TPDO3 = 606C, RPDO2 = 6040 + 6060,
    # RPDO3 = 6040 + 60FF.
    (0x1402, 1, "01040080"),
    (0x1602, 0, "00"),
    (0x1602, 1, "10004060"),
    (0x1602, 2, "2000FF60"),
    (0x1602, 0, "02"),
    (0x1402, 1, "01040000"),
    (0x1802, 1, "81030080"),
    (0x1A02, 0, "00"),
    (0x1A02, 1, "20006C60"),
    (0x1A02, 0, "01"),
    (0x1802, 2, "FD"),
    (0x1800, 2, "FD"),
    (0x1802, 1, "81030000"),
)


@pytest.fixture
def recorded() -> Desk:
    desk = powered()
    for index, subindex, raw in RTR_ONLY:
        assert desk.writes(index, subindex, bytes.fromhex(raw)) == "ok"
    return desk


def test_device_type_by_sdo_application_notes_p_164() -> None:
    assert powered().receives("601#4000100000000000") == ["581#4300100092010200"]


def test_reset_node_is_answered_by_boot_up_candump() -> None:
    desk = operational()
    assert desk.receives("000#8100") == ["701#00"]


def test_a_remote_request_is_answered_with_the_own_length_candump(recorded: Desk) -> None:
    assert recorded.receives("000#0100") == []
    recorded.store.on_read(od.VELOCITY_ACTUAL, lambda: 4102)
    assert recorded.receives("381#R6") == ["381#06100000"]


def test_pdos_on_request_never_leave_by_themselves_candump(recorded: Desk) -> None:
    assert recorded.receives("000#0100") == []
    assert recorded.receives("301#000003") == []
    assert recorded.receives("201#0600") == []
    assert recorded.receives("201#0F00") == []
    assert recorded.receives("401#0F0010100000") == []
    assert recorded.waits(1_000_000_000) == []
    assert recorded.motion.written == [0, 6, 0xF, 0xF]
    assert recorded.store.get(od.MODE) == 3
    assert recorded.store.get(od.TARGET_VELOCITY) == 4112


def test_the_statusword_follows_on_change_machinekit_589() -> None:
    """182 40 07 and so on: bit 9 remote and bit 10 target reached stand beside the state."""
    desk = powered()
    assert desk.receives("000#0101") == ["181#4007"]
    desk.waits(10_000_000)
    desk.store.set(od.STATUSWORD, 0x0721)
    assert desk.receives("201#0600") == ["181#2107"]
    desk.waits(10_000_000)
    desk.store.set(od.STATUSWORD, 0x0737)
    assert desk.receives("201#0F00") == ["181#3707"]
    assert desk.receives("601#4041600000000000") == ["581#4B41600037070000"]


def test_expedited_without_size_is_taken_exoskeleton_driver() -> None:
    desk = powered()
    assert desk.receives("601#22606000FE000000") == ["581#6060600000000000"]
    assert desk.store.get(od.MODE) == -2


def test_loss_of_power_is_reported_with_code_and_register_exoskeleton_driver() -> None:
    desk = operational()
    desk.motion.report(0x3220)
    assert desk.receives("080#") == ["081#2032040000000000"]


@pytest.mark.parametrize(
    ("request_", "answer", "value"),
    [
        ("2316100100000000", "6016100100000000", None),
        ("23161001D0070100", "6016100100000000", (od.CONSUMER_HEARTBEAT_1, 0x0001_07D0)),
        ("2B171000E8030000", "6017100000000000", (od.PRODUCER_HEARTBEAT, 1000)),
    ],
)
def test_heartbeat_set_up_pejman712_crf(
    request_: str, answer: str, value: tuple[Address, int] | None
) -> None:
    desk = powered()
    assert desk.receives(f"601#{request_}")[0] == f"581#{answer}"
    if value is not None:
        assert desk.store.get(value[0]) == value[1]


@pytest.mark.parametrize(
    "template",
    [
        "2B40600006000000",
        "2B4060000F000000",
        "2B40600000000000",
        "2B40600002000000",
        "2300140101020000",
        "2F001402FF000000",
    ],
)
def test_requests_of_a_microcontroller_are_granted_samsonchau(template: str) -> None:
    assert powered().receives(f"601#{template}") == [f"581#60{template[2:8]}00000000"]


@pytest.mark.parametrize(
    ("index", "subindex", "command"), [(0x1001, 0, "4F"), (0x6041, 0, "4B"), (0x1000, 0, "43")]
)
def test_the_upload_s_command_byte_reports_the_size_application_notes_p_150(
    index: int, subindex: int, command: str
) -> None:
    word = index.to_bytes(2, "little").hex()
    (answer,) = powered().receives(f"601#40{word}{subindex:02X}00000000")
    assert answer[4:6] == command


def test_a_download_of_six_bytes_is_taken_public_scripts() -> None:
    desk = powered()
    assert desk.receives("601#2B4060000600") == ["581#6040600000000000"]
    assert desk.motion.written == [6]
