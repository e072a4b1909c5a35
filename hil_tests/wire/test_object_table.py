"""The object table as a whole: how many, of which types, and every row by itself."""

from collections import Counter

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow, Provenance
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.differences import objects_of
from hil_tests.rows import every

ROWS = every("row", objects_of().values(), ids=lambda row: row.address)


def test_the_table_has_the_objects_of_the_eds() -> None:
    assert len(objects_of().indexes) == 156
    assert len(objects_of()) == 430


def test_the_table_has_the_types_of_the_eds() -> None:
    assert Counter(row.type for row in objects_of().values()) == {
        DataType.UNSIGNED8: 87,
        DataType.UNSIGNED16: 125,
        DataType.UNSIGNED32: 140,
        DataType.UNSIGNED64: 2,
        DataType.INTEGER8: 10,
        DataType.INTEGER16: 31,
        DataType.INTEGER32: 32,
        DataType.VISIBLE_STRING: 1,
        DataType.DOMAIN: 2,
    }


def test_the_table_has_the_access_of_the_eds() -> None:
    assert Counter(row.access for row in objects_of().values()) == {
        Access.RO: 141,
        Access.RW: 231,
        Access.RWW: 38,
        Access.CONST: 14,
        Access.WO: 6,
    }


@pytest.mark.parametrize("index", [0x605A, 0x605D, 0x6071, 0x6077, 0x60FD, 0x60FE, 0x60C1, 0x1006, 0x1019])
def test_objects_of_other_drives_do_not_exist(index: int) -> None:
    assert index not in objects_of().indexes


def test_the_velocity_gains_have_a_gap() -> None:
    assert [address.subindex for address in objects_of() if address.index == 0x60F9] == [0, 1, 2, 4, 5]


def test_every_named_address_is_an_object() -> None:
    named = {name: value for name, value in vars(at).items() if isinstance(value, Address)}
    assert {name for name, value in named.items() if value not in objects_of()} == set()


@ROWS
def test_a_row_is_sound(row: ObjectRow) -> None:
    assert row.name
    if row.type.size == 0:
        assert isinstance(row.default, bytes)
        return
    low, high = row.bounds
    assert row.type.lowest <= low <= high <= row.type.highest
    default = row.default_for(127)
    assert isinstance(default, int)
    assert row.type.lowest <= default <= row.type.highest
    if row.access.writable:
        assert low <= default <= high
    assert row.type.decode(row.type.encode(default)) == default


@ROWS
def test_a_row_states_how_far_its_default_is_known(row: ObjectRow) -> None:
    invented = row.default_provenance is Provenance.ASSUMED
    assert invented == (row.default_source == "own assumption")
    if invented:
        assert row.default in (0, b"")


@every(
    ("address", "default"),
    [
        (Address(0x1000), 0x0002_0192),
        (Address(0x1018, 1), 0xFB),
        (Address(0x1400, 1), 0x201),
        (Address(0x1403, 1), 0x501),
        (Address(0x1603, 2), 0x60FF_0020),
        (Address(0x1800, 1), 0x4000_0181),
        (Address(0x1803, 1), 0xC000_0481),
        (Address(0x1803, 3), 10),
        (Address(0x1A01, 2), 0x6061_0008),
        (Address(0x1014), 0x81),
        (Address(0x1200, 2), 0x581),
        (Address(0x2210, 1), 500),
        (Address(0x6007), 3),
        (Address(0x605E), 2),
        (Address(0x6065), 2000),
        (Address(0x6067), 0xFFFF_FFFF),
        (Address(0x6083), 10_000),
        (Address(0x60C0), -1),
        (Address(0x60F6, 1), 300),
        (Address(0x6410, 5), 40),
        (Address(0x6502), 0x003F_0065),
    ],
)
def test_defaults_are_those_of_the_eds_and_the_real_drive(address: Address, default: int) -> None:
    assert objects_of()[address].default_for(1) == default


@pytest.mark.parametrize(
    ("address", "transmit", "receive"),
    [
        (od.STATUSWORD, True, False),
        (od.CONTROLWORD, False, True),
        (Address(0x20C1), False, True),
        (at.ENCODER_PULSES, False, False),
    ],
)
def test_which_pdo_carries_an_object_follows_its_access(
    address: Address, *, transmit: bool, receive: bool
) -> None:
    assert objects_of()[address].transmittable is transmit
    assert objects_of()[address].receivable is receive
