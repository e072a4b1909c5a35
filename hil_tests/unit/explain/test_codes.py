"""A number explained: every reading that it has, and one message where it has none."""

import pytest

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.dissector.dictionary import dictionaries
from firmware_bridge.explain.codes import names, readings, values_of
from firmware_bridge.explain.remedies import ABORT_CHECKS, REMEDIES
from hil_tests.rows import every

READINGS: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("0x8130", ("error code", "statusword"), "EMCY / error code 0x8130: life guard or heartbeat"),
    ("8130h", ("error code", "statusword"), "heartbeat or node guarding failed; reaction chosen by 0x6007"),
    ("8130", ("error code", "statusword"), "meaning: life guard or heartbeat (cia402)"),
    ("0xFF0A", ("error code",), "position sensor breach"),
    ("0x2310", ("error code", "statusword"), "over-current"),
    ("emcy 0x2345", ("error code",), "class: current"),
    ("error 0", ("error code",), "no error is left"),
    ("0x06090011", ("abort code",), "SDO abort code 0x06090011 no such sub-index"),
    ("0x0F00FFC0", ("abort code",), "device error of maxon's drives 0x0F00FFC0 not in this NMT state"),
    ("0x0F00FFC1", ("abort code",), "of maxon's range 0x0F00FFxx; this one is in no list"),
    ("statusword 0x0537", ("statusword", "statusword"), "statusword 0x0537: operation enabled (epos2)"),
    ("statusword 0x0537", ("statusword", "statusword"), "bit 9 (remote) is 0"),
    ("statusword 0x0740", ("statusword", "statusword"), "controlword 0x0006 (shutdown)"),
    ("statusword 0x0708", ("statusword", "statusword"), "a 0 -> 1 change of bit 7"),
    ("statusword 0x1237", ("statusword",), "bit 12, by mode: set-point acknowledged (profile position)"),
    ("controlword 0x1F", ("controlword",), "controlword 0x001F: enable operation"),
    ("controlword 0x1F", ("controlword",), "new set-point (profile position), start (homing)"),
    ("controlword 0x010F", ("controlword",), "bit: halt"),
    ("controlword 0x80", ("controlword",), "bit: fault reset"),
    ("mode 0xFE", ("mode",), "mode of operation -2: velocity (epos2)"),
    ("mode 9", ("mode",), "mode of operation 9: cyclic velocity (cia402)"),
    ("nmt 0x85", ("nmt",), "NMT state 0x85: operational"),
    ("register 0x11", ("register",), "error register 0x11: generic, communication"),
    ("0x60400010", ("mapping",), "PDO mapping entry 0x60400010: 0x6040 Controlword, 16 bits"),
    ("object 0x607A", ("object",), "object 0x607A: Target Position"),
    ("0x281", ("controlword", "identifier"), "CAN identifier 0x281: TPDO 2, node 1, by the predefined set"),
)
"""Words, the kinds of the readings in their order, and a text among them."""


@every(("words", "kinds", "text"), READINGS)
def test_a_number_has_all_its_readings(words: str, kinds: tuple[str, ...], text: str) -> None:
    found = readings(tuple(words.split()))
    assert found
    assert tuple(one.kind for one in found) == kinds
    assert any(text in line for one in found for line in (one.title, *one.lines))


@every("code", sorted({code for one in dictionaries().values() for code in one.words.causes}), hex)
def test_each_error_of_a_family_has_its_causes_and_a_check(code: int) -> None:
    assert code in REMEDIES
    found = readings((f"0x{code:04X}",))
    assert found
    assert found[0].kind == "error code"
    assert any(line.startswith("check first: ") for line in found[0].lines)
    assert any(line.startswith("remedy: ") for line in found[0].lines)


@every("code", list(AbortCode), lambda code: code.name)
def test_each_abort_code_has_its_reading(code: AbortCode) -> None:
    found = readings((f"0x{code:08X}",))
    assert found
    assert code.meaning in found[0].title


def test_checks_are_of_codes_that_there_are() -> None:
    assert set(ABORT_CHECKS) <= set(AbortCode)


@pytest.mark.parametrize(
    "words", ["0xDEADBEEF", "abort 0x12345678", "mode 0x44", "12345678901", "statusword 0x10000"]
)
def test_an_unknown_number_has_none(words: str) -> None:
    assert not readings(tuple(words.split()))


@pytest.mark.parametrize("words", ["can.log", "0x", "statusword", "0x1FFFFFFFFF"])
def test_what_is_no_number_is_none(words: str) -> None:
    assert readings(tuple(words.split())) is None


def test_a_number_without_prefix_is_hexadecimal_first() -> None:
    assert values_of("8130") == (0x8130, 8130)
    assert values_of("06090011h") == (0x0609_0011,)
    assert values_of("100925457") == (100_925_457,)


def test_each_word_chooses_its_reading() -> None:
    numbers = ("0x6040", "0x05", "0x06", "0x281", "0x8130", "0x60400010", "0x06090011")
    assert [name for name in names() if not any(readings((name, number)) for number in numbers)] == []
