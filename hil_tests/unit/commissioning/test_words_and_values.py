"""Objects by name, values with units, bits in words: tables, and properties over the whole object table."""

from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.commissioning.client import CommissioningError
from firmware_bridge.families.epos2.commissioning.motion import why_it_may_move
from firmware_bridge.families.epos2.commissioning.names import BY_NAME, dashed, find, squashed
from firmware_bridge.families.epos2.commissioning.values import LONGEST_WRITE, parse
from firmware_bridge.families.epos2.commissioning.words import WORDS
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE, objects_of
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.lanes import examples
from hil_tests.rows import every

UNIQUE = [row for row in objects_of().values() if len(BY_NAME[squashed(row.name)]) == 1]
NUMBERS = [row for row in objects_of().values() if 0 < row.type.size <= LONGEST_WRITE]
ON = "operation enabled|power stage on"
GO = "enable operation"
QUICK = settings(max_examples=examples(300), derandomize=True, database=None)


@every("row", UNIQUE, ids=lambda row: row.name)
def test_every_name_finds_its_object_however_it_is_spelt(row: ObjectRow) -> None:
    for text in (row.name, row.name.upper(), row.name.lower(), dashed(row.name), row.name.replace(" ", "_")):
        assert find(text) == row.address


@every("row", objects_of().values(), ids=lambda row: row.address)
def test_every_address_is_read_as_it_is_printed(row: ObjectRow) -> None:
    assert find(str(row.address)) == row.address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("0x6081", Address(0x6081)),
        ("0X60f6:1", Address(0x60F6, 1)),
        ("0x60F6.2", Address(0x60F6, 2)),
        ("0x60F6/0x02", Address(0x60F6, 2)),
        ("0x202E:10", Address(0x202E, 10)),
        ("0x202E:0A", Address(0x202E, 10)),
        ("0x5555", Address(0x5555)),
        ("0x1:255", Address(1, 255)),
        ("statusword", od.STATUSWORD),
        ("profile velocity", od.PROFILE_VELOCITY),
    ],
)
def test_objects_by_number_and_by_name(text: str, address: Address) -> None:
    assert find(text) == address


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("stausword", r"did you mean statusword \(0x6041\)\?"),
        (
            "serial number",
            r"is the name of serial-number \(0x1018:04\) or serial-number \(0x2004\); use the",
        ),
        ("velocity", r"did you mean target-velocity .* or "),
        ("quickstop", r"did you mean quickstop-deceleration"),
        ("banana", "no object is called 'banana'; give a name of"),
        ("", "no object is called ''"),
        ("---", "no object is called '---'"),
        ("6081", "no object is called '6081'"),
        ("0x60F6:256", "a sub-index is 0 to 255"),
        ("0x12345", "no object is called"),
        ("0x6081:", "no object is called"),
    ],
)
def test_a_name_that_is_none_is_answered_with_those_that_come_near(text: str, reported: str) -> None:
    with pytest.raises(CommissioningError, match=reported):
        find(text)


@QUICK
@given(text=st.text(max_size=30))
def test_any_text_is_an_object_or_refused_by_name(text: str) -> None:
    with suppress(CommissioningError):
        assert isinstance(find(text), Address)


@QUICK
@given(row=st.sampled_from(NUMBERS), data=st.data())
def test_a_number_that_is_written_is_the_one_that_is_read(row: ObjectRow, data: st.DataObject) -> None:
    value = data.draw(st.integers(row.type.lowest, row.type.highest))
    raw = parse(row.address, str(value))
    assert len(raw) == row.type.size
    assert ANY_TYPE.decoded(row.address, raw) == value
    assert parse(row.address, f"0x{int.from_bytes(raw, 'little'):X}") == raw
    if row.unit:
        unit = f"x {row.unit}" if row.unit[0].isdigit() else row.unit
        assert parse(row.address, f"{value}{unit}") == parse(row.address, f"{value} {unit}") == raw


@QUICK
@given(row=st.sampled_from(NUMBERS), beyond=st.integers(1, 1 << 40))
def test_what_the_type_does_not_hold_is_refused(row: ObjectRow, beyond: int) -> None:
    for value in (row.type.highest + beyond, row.type.lowest - beyond):
        with pytest.raises(CommissioningError, match="does not fit"):
            parse(row.address, str(value))


@pytest.mark.parametrize(
    ("address", "text", "raw"),
    [
        (od.PROFILE_VELOCITY, "500rpm", "f4010000"),
        (od.PROFILE_VELOCITY, "0x1F4", "f4010000"),
        (od.TARGET_VELOCITY, "-20 rpm", "ecffffff"),
        (od.TARGET_VELOCITY, "+20", "14000000"),
        (od.TARGET_VELOCITY, "0xFFFFFFEC", "ecffffff"),
        (at.CONTINUOUS_CURRENT_LIMIT, "2.5A", "c409"),
        (at.CONTINUOUS_CURRENT_LIMIT, "2500mA", "c409"),
        (at.THERMAL_TIME_CONSTANT, "4s", "2800"),
        (at.THERMAL_TIME_CONSTANT, "400ms", "0400"),
        (od.MODE, "profile velocity", "03"),
        (od.MODE, "Profile-Velocity", "03"),
        (od.MODE, "-1", "ff"),
        (od.MODE, "current", "fd"),
        (Address(0x1010, 1), "save", b"save".hex()),
        (Address(0x1011, 1), "load", b"load".hex()),
        (od.CONTROLWORD, "0x10F", "0f01"),
        (Address(0x5555), "-1", "ffffffff"),
    ],
)
def test_values_as_people_write_them(address: Address, text: str, raw: str) -> None:
    assert parse(address, text).hex() == raw


@pytest.mark.parametrize(
    ("address", "text", "reported"),
    [
        (od.PROFILE_VELOCITY, "500mA", r"wrong unit: 0x6081 Profile Velocity is in rpm"),
        (at.CONTINUOUS_CURRENT_LIMIT, "1rpm", "is in mA, A"),
        (od.CONTROLWORD, "5rpm", "is in no unit"),
        (od.PROFILE_VELOCITY, "2.5", "not a whole number of rpm"),
        (at.CONTINUOUS_CURRENT_LIMIT, "0.0001A", "not a whole number of mA"),
        (od.PROFILE_VELOCITY, "fast", "give a number, as 500"),
        (od.PROFILE_VELOCITY, "", "is no value"),
        (od.PROFILE_VELOCITY, "0x", "wrong unit"),
        (od.PROFILE_VELOCITY, "-1", "4 bytes hold 0 to 4294967295"),
        (od.MODE, "swift", "profileposition"),
        (Address(0x1010, 1), "load", "one of: save"),
        (od.CONTROLWORD, "65536", "2 bytes hold 0 to 65535"),
        (od.CONTROLWORD, "0x10000", "does not fit"),
        (Address(0x2004), "1", "has 8 bytes; values of up to 4"),
        (od.DEVICE_NAME, "EPOS", "no fixed length"),
    ],
)
def test_values_that_cannot_be(address: Address, text: str, reported: str) -> None:
    with pytest.raises(CommissioningError, match=reported):
        parse(address, text)


def test_another_size_can_be_requested() -> None:
    assert parse(od.CONTROLWORD, "6", 4).hex() == "06000000"
    assert parse(od.CONTROLWORD, "6", 1).hex() == "06"
    with pytest.raises(CommissioningError, match="1 bytes hold"):
        parse(od.CONTROLWORD, "256", 1)


@every(
    ("address", "value", "mode", "reported"),
    [
        (od.STATUSWORD, 0x0737, None, ON + "|remote (NMT operational)|target reached"),
        (od.STATUSWORD, 0x1137, Mode.PROFILE_POSITION, ON + "|set-point acknowledged"),
        (od.STATUSWORD, 0x1137, Mode.PROFILE_VELOCITY, ON + "|speed is zero"),
        (od.STATUSWORD, 0x3137, Mode.HOMING, ON + "|homing attained|homing error"),
        (od.STATUSWORD, 0x1137, Mode.INTERPOLATED_POSITION, ON + "|interpolation active"),
        (od.STATUSWORD, 0x1140, None, "switch on disabled|bit 12"),
        (od.STATUSWORD, 0x2140, Mode.CURRENT, "switch on disabled|bit 13"),
        (od.STATUSWORD, 0x8908, None, "fault|current limited (I2t)|position referenced to home"),
        (od.STATUSWORD, 0x0042, None, "no state of the drive"),
        (od.CONTROLWORD, 0x010F, None, "enable operation|halt"),
        (od.CONTROLWORD, 0x007F, Mode.PROFILE_POSITION, GO + "|new set-point|change immediately|relative"),
        (od.CONTROLWORD, 0x001F, Mode.HOMING, "enable operation|start homing"),
        (od.CONTROLWORD, 0x0080, None, "disable voltage|fault reset"),
        (od.CONTROLWORD, 0x0002, None, "quick stop"),
        (od.CONTROLWORD, 0x0006, None, "shutdown"),
        (od.ERROR_REGISTER, 0x00, None, "no error"),
        (od.ERROR_REGISTER, 0x15, None, "generic|voltage|communication"),
        (od.MODE_DISPLAY, -3, None, "current"),
        (od.MODE, 99, None, "no mode of the EPOS2"),
        (Address(0x1003, 1), 0x3220, None, "0x3220|under-voltage"),
        (Address(0x1003, 5), 0, None, "no error"),
        (Address(0x1003, 2), 0x1234, None, "0x1234|unknown error"),
        (od.PROFILE_VELOCITY, 7, None, ""),
    ],
)  # fmt: skip
def test_bits_in_words(address: Address, value: int, mode: Mode | None, reported: str) -> None:
    assert "|".join(WORDS.words(address, value, mode)) == reported


def test_the_supported_modes_are_those_of_the_drive() -> None:
    assert set(WORDS.words(od.SUPPORTED_MODES, 0x003F0065)) == {
        mode.name.lower().replace("_", " ") for mode in Mode
    }


@every("code", EMERGENCIES, ids=hex)
def test_every_emergency_in_the_history_has_its_cause(code: int) -> None:
    assert WORDS.words(Address(0x1003, 1), code) == (f"0x{code:04X}", EMERGENCIES[code].cause)


@every(
    ("address", "raw", "moves"),
    [
        (od.CONTROLWORD, "0f00", True),
        (od.CONTROLWORD, "1f00", True),
        (od.CONTROLWORD, "0f01", True),
        (od.CONTROLWORD, "0700", False),
        (od.CONTROLWORD, "0600", False),
        (od.CONTROLWORD, "0200", False),
        (od.CONTROLWORD, "0000", False),
        (od.CONTROLWORD, "8000", False),
        (od.TARGET_VELOCITY, "01000000", True),
        (od.TARGET_VELOCITY, "00000000", False),
        (at.VELOCITY_MODE_SETTING, "00000000", False),
        (at.CURRENT_MODE_SETTING, "0000", True),
        (at.POSITION_MODE_SETTING, "00000000", True),
        (at.VELOCITY_MODE_SETTING, "01000000", True),
        (at.POSITION_MODE_SETTING, "01000000", True),
        (at.CURRENT_MODE_SETTING, "0100", True),
        (od.MODE, "03", True),
        (Address(0x2078, 1), "0000", True),
        (Address(0x207D), "0100", True),
        (od.PROFILE_VELOCITY, "01000000", False),
        (od.TARGET_POSITION, "01000000", False),
        (Address(0x1010, 1), "73617665", False),
    ],
)
def test_which_writes_may_move_something(address: Address, raw: str, moves: bool) -> None:  # noqa: FBT001 - a row
    assert (why_it_may_move(address, bytes.fromhex(raw)) is not None) is moves
