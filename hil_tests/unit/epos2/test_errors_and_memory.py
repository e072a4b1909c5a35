"""Error register, history and emergency messages; parameters saved and restored."""

from dataclasses import replace

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from hil_tests.rows import every
from hil_tests.unit.epos2.quiet_motion import Desk, powered


def reported(desk: Desk, code: int) -> list[str]:
    desk.motion.report(code)
    return desk.receives("080#")


@every("code", EMERGENCIES, ids=hex)
def test_every_emergency_is_reported_with_its_register(code: int) -> None:
    desk = powered()
    (frame,) = reported(desk, code)
    register = EMERGENCIES[code].register
    assert bytes.fromhex(frame[4:]) == code.to_bytes(2, "little") + bytes((register,)) + bytes(5)
    assert desk.reads(0x1001) == register
    assert desk.reads(0x1003, 1) == code


def test_errors_add_up_in_the_register_until_they_are_gone() -> None:
    desk = powered()
    assert reported(desk, 0x3220) == ["081#2032040000000000"]
    assert reported(desk, 0x8611) == ["081#1186240000000000"]
    assert reported(desk, 0x0000) == ["081#0000000000000000"]
    assert desk.reads(0x1001) == 0
    assert desk.reads(0x1003) == 2


def test_the_end_of_all_errors_can_be_left_untold() -> None:
    desk = powered(replace(EPOS2_70_10, reports_reset=False))
    reported(desk, 0x8611)
    assert reported(desk, 0) == []
    assert desk.reads(0x1001) == 0


def test_the_history_keeps_the_last_five_newest_first() -> None:
    desk = powered()
    codes = [0x2310, 0x3210, 0x3220, 0x4210, 0x5113, 0x8611, 0x8611]
    for code in codes:
        reported(desk, code)
    assert desk.reads(0x1003) == 5
    assert [desk.reads(0x1003, place) for place in range(1, 6)] == codes[:1:-1]
    assert desk.writes(0x1003, 0, b"\x01") == "06090030"
    assert desk.writes(0x1003, 0, b"\0") == "ok"
    assert [desk.reads(0x1003, place) for place in range(6)] == [0] * 6


def test_reset_node_forgets_errors_and_history() -> None:
    desk = powered()
    reported(desk, 0x8611)
    desk.receives("000#8101")
    assert desk.reads(0x1001) == desk.reads(0x1003) == desk.reads(0x1003, 1) == 0


def test_reset_communication_forgets_what_it_cures() -> None:
    desk = powered()
    for code in (0x8120, 0x8150, 0x3220):
        reported(desk, code)
    desk.receives("000#8201")
    assert desk.reads(0x1001) == 0x04
    assert desk.reads(0x1003) == 3


@pytest.mark.parametrize(
    ("word", "answer", "frames"),
    [
        (0x81, "ok", ["081#1186200000000000"]),
        (0xC5, "ok", ["0C5#1186200000000000"]),
        (0x8000_0081, "ok", []),
        (0x80, "06090030", ["081#1186200000000000"]),
        (0x000, "06090030", ["081#1186200000000000"]),
        (0x601, "06090030", ["081#1186200000000000"]),
        (0x701, "06090030", ["081#1186200000000000"]),
        (0x2000_0081, "06090030", ["081#1186200000000000"]),
    ],
)
def test_the_identifier_of_emergencies_can_be_chosen(word: int, answer: str, frames: list[str]) -> None:
    desk = powered()
    assert desk.writes(0x1014, 0, word.to_bytes(4, "little")) == answer
    assert reported(desk, 0x8611) == frames


@pytest.mark.parametrize(
    ("index", "subindex", "wrong"),
    [(0x1010, 1, b"load"), (0x1010, 1, b"evas"), (0x1011, 1, b"save"), (0x1011, 5, bytes(4))],
)
def test_a_wrong_signature_is_a_wrong_password(index: int, subindex: int, wrong: bytes) -> None:
    assert powered().writes(index, subindex, wrong) == "0F00FFBE"


def test_what_is_saved_survives_reset_node_and_commands_do_not() -> None:
    desk = powered()
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    desk.writes(0x60FF, 0, (55).to_bytes(4, "little"))
    desk.writes(0x6040, 0, b"\x06\0")
    assert desk.writes(0x1010, 1, b"save") == "ok"
    desk.writes(0x6083, 0, (888).to_bytes(4, "little"))
    desk.receives("000#8101")
    assert desk.reads(0x6083) == 777
    assert desk.reads(0x60FF) == desk.reads(0x6040) == 0


def test_load_makes_the_defaults_count_with_the_reset_that_follows() -> None:
    # CiA 301: until then everything stays as it is; and the reset brings nothing back that was stored before.
    desk = powered()
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    desk.writes(0x1800, 1, (0xC000_0181).to_bytes(4, "little"))
    desk.writes(0x1010, 1, b"save")
    assert desk.writes(0x1011, 1, b"load") == "ok"
    assert desk.reads(0x6083) == 777
    assert desk.motion.resets == 1
    assert desk.receives("000#0101") == []
    assert desk.receives("000#8101") == ["701#00"]
    assert desk.reads(0x6083) == 10_000
    assert desk.receives("000#0101") == ["181#4007"]


def test_what_is_saved_after_load_and_before_the_reset_is_what_stands_there() -> None:
    desk = powered()
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    desk.writes(0x1011, 1, b"load")
    desk.writes(0x1010, 1, b"save")
    desk.receives("000#8101")
    assert desk.reads(0x6083) == 777


@pytest.mark.parametrize(("index", "subindex"), [(0x1010, 1), (0x1011, 1), (0x1011, 4), (0x1011, 5)])
def test_the_commands_read_that_they_work_on_command(index: int, subindex: int) -> None:
    desk = powered()
    assert desk.reads(index, subindex) == 1
    desk.writes(index, subindex, b"save" if index == 0x1010 else b"load")
    assert desk.reads(index, subindex) == 1


def test_load_is_refused_while_the_power_stage_is_on() -> None:
    desk = powered()
    desk.store.set(od.STATUSWORD, 0x0137)
    assert desk.writes(0x1011, 1, b"load") == "08000022"


def test_default_cob_ids_are_effective_after_save_and_reset() -> None:
    desk = powered()
    assert desk.writes(0x1400, 1, (0x301).to_bytes(4, "little")) == "ok"
    assert desk.writes(0x1402, 1, (0x8000_0401).to_bytes(4, "little")) == "ok"
    desk.writes(0x1010, 1, b"save")
    assert desk.writes(0x1011, 5, b"load") == "ok"
    assert desk.reads(0x1400, 1) == 0x201
    desk.receives("000#0101")
    desk.receives("201#0600")
    assert desk.motion.written == []
    desk.writes(0x1010, 1, b"save")
    desk.receives("000#8101")
    desk.receives("000#0101")
    desk.receives("201#0600")
    assert desk.motion.written == [6]
