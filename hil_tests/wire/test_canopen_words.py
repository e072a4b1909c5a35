"""Network management, heartbeat, emergency, and PDO contents as bytes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import (
    EmergencyMessage,
    NmtCommand,
    NmtState,
    decode_emergency,
    decode_heartbeat,
    decode_nmt,
    encode_emergency,
    encode_heartbeat,
    encode_nmt,
)
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.emergency import FaultReaction
from firmware_bridge.canopen.pdo import Layout, MappingEntry
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES


@pytest.mark.parametrize(
    ("command", "node", "wire"),
    [
        # Recorded at an EPOS2, kay01-kwon/EPOS2_CAN_TEST_CPP.
        (NmtCommand.RESET_NODE, 0, "8100"),
        (NmtCommand.START, 0, "0100"),
        (NmtCommand.STOP, 0, "0200"),
        # CiA 301 v4.02; computed.
        (NmtCommand.ENTER_PRE_OPERATIONAL, 5, "8005"),
        (NmtCommand.RESET_COMMUNICATION, 127, "827F"),
    ],
)
def test_network_commands(command: NmtCommand, node: int, wire: str) -> None:
    assert encode_nmt(command, node).hex().upper() == wire
    assert decode_nmt(bytes.fromhex(wire)) == (command, node)


@pytest.mark.parametrize("payload", [b"", b"\x01", b"\x03\x00", b"\xff\x00"])
def test_what_is_no_network_command(payload: bytes) -> None:
    assert decode_nmt(payload) is None


@pytest.mark.parametrize(
    ("payload", "state"),
    [
        ("00", NmtState.BOOT_UP),
        ("04", NmtState.STOPPED),
        ("05", NmtState.OPERATIONAL),
        ("85", NmtState.OPERATIONAL),
        ("7F", NmtState.PRE_OPERATIONAL),
        ("06", None),
        ("", None),
    ],
)
def test_heartbeats(payload: str, state: NmtState | None) -> None:
    assert decode_heartbeat(bytes.fromhex(payload)) is state


@pytest.mark.parametrize("state", NmtState)
def test_a_heartbeat_there_and_back(state: NmtState) -> None:
    assert decode_heartbeat(encode_heartbeat(state)) is state


def test_an_emergency_recorded_at_loss_of_power() -> None:
    message = EmergencyMessage(0x3220, 0x04)
    assert encode_emergency(message).hex() == "2032040000000000"
    assert decode_emergency(bytes.fromhex("2032040000000000")) == message
    assert decode_emergency(b"\x20\x32") is None


def test_the_emergencies_of_the_device() -> None:
    assert len(EMERGENCIES) == 36
    assert EMERGENCIES[0x8611].reaction is FaultReaction.QUICK_STOP
    assert EMERGENCIES[0x8130].register == 0x10
    for code, row in EMERGENCIES.items():
        assert row.code == code
        assert 0 < row.register <= 0xFF


def test_a_mapping_entry_as_in_the_eds() -> None:
    assert MappingEntry(od.TARGET_VELOCITY, 32).encode() == 0x60FF_0020
    assert MappingEntry.decode(0x6410_0108) == MappingEntry(Address(0x6410, 1), 8)


@given(st.integers(0, 0xFFFF_FFFF))
def test_every_word_is_an_entry(word: int) -> None:
    assert MappingEntry.decode(word).encode() == word


WHEEL = Layout(
    (od.STATUSWORD, DataType.UNSIGNED16),
    (od.POSITION_ACTUAL, DataType.INTEGER32),
    (at.CURRENT_AVERAGED, DataType.INTEGER16),
)


def test_a_full_pdo_low_byte_first() -> None:
    assert WHEEL.size == 8
    assert WHEEL.pack(0x0737, -2, 300).hex().upper() == "3707FEFFFFFF2C01"
    assert [hex(entry.encode()) for entry in WHEEL.entries()] == ["0x60410010", "0x60640020", "0x20270010"]


@given(st.integers(0, 0xFFFF), st.integers(-(2**31), 2**31 - 1), st.integers(-(2**15), 2**15 - 1))
def test_a_pdo_there_and_back(status: int, position: int, current: int) -> None:
    assert WHEEL.unpack(WHEEL.pack(status, position, current) + b"more") == (status, position, current)


def test_a_number_too_large_for_its_field_does_not_touch_the_next() -> None:
    assert WHEEL.pack(0x1_0001, 2**31, -1) == WHEEL.pack(1, -(2**31), -1)


def test_a_short_pdo_is_an_error() -> None:
    with pytest.raises(ValueError, match="7 bytes where 8"):
        WHEEL.unpack(bytes(7))


def test_what_fits_no_pdo_is_an_error() -> None:
    with pytest.raises(ValueError, match="72 bits"):
        Layout((od.MODE, DataType.INTEGER8), (Address(0x20C1), DataType.UNSIGNED64))
    with pytest.raises(ValueError, match="VISIBLE_STRING"):
        Layout((od.DEVICE_NAME, DataType.VISIBLE_STRING))
