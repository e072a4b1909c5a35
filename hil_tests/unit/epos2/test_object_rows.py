"""Every row of the object table at a running drive: read, write at and past both bounds, sizes, mapping.

The expectations come from the row; what the drive refuses beyond its row stands in `RESTRICTED`, with why.
"""

from functools import cache
from typing import TYPE_CHECKING

import pytest

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.pdo_settings import RECEIVE, TRANSMIT
from emulators.epos2.control.value_ranges import VALUE_RANGES, ValueRange
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import MappingEntry
from firmware_bridge.families.epos2.wire.objects_pdo import PROCESS_OBJECTS
from hil_tests.rows import Test, every
from hil_tests.unit.epos2.quiet_motion import Desk, powered

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

RESTRICTED = {
    **{rule.address: "has a rule of its own" for rule in VALUE_RANGES},
    **{row.address: "PDO settings have their procedure" for row in PROCESS_OBJECTS},
    Address(0x1010, 1): "wants a signature",
    **{Address(0x1011, sub): "wants a signature" for sub in (1, 4, 5)},
    od.ERROR_HISTORY_COUNT: "takes 0 only",
    od.COB_ID_EMERGENCY: "wants an identifier",
    od.CONSUMER_HEARTBEAT_1: "wants a node's number",
    od.CONSUMER_HEARTBEAT_2: "wants a node's number",
}
NUMBERS = [row for row in EPOS2_70_10.objects.values() if row.type.size]
FREE = [row for row in NUMBERS if row.access.writable and row.address not in RESTRICTED]
BOUNDED = [row for row in FREE if (row.minimum, row.maximum) != (None, None)]


def rows(selection: list[ObjectRow]) -> "Callable[[Test], Test]":
    return every("row", selection, ids=lambda row: row.address)


@cache
def fresh() -> ObjectStore:
    """Return a store whose hooks are those of a drive at rest; reading does not change it."""
    return powered().store


@pytest.fixture
def store() -> ObjectStore:
    return powered().store


def refusal(store: ObjectStore, address: Address, raw: bytes) -> AbortCode:
    with pytest.raises(SdoAbort) as caught:
        store.write(address, raw)
    assert caught.value.address == address
    return caught.value.code


@rows(list(EPOS2_70_10.objects.values()))
def test_a_row_can_be_read_as_its_access_states(row: ObjectRow) -> None:
    if not row.access.readable:
        with pytest.raises(SdoAbort) as caught:
            fresh().read(row.address)
        assert caught.value.code is AbortCode.WRITE_ONLY
        return
    raw = fresh().read(row.address)
    if row.type.size:
        assert len(raw) == row.type.size
    if row.address not in (od.STATUSWORD, od.ERROR_REGISTER):
        default = fresh().default(row.address)
        assert raw == (default if isinstance(default, bytes) else row.type.encode(default))


@rows([row for row in EPOS2_70_10.objects.values() if not row.access.writable])
def test_a_constant_or_read_only_row_refuses_writing(row: ObjectRow) -> None:
    assert refusal(fresh(), row.address, bytes(row.type.size or 1)) is AbortCode.READ_ONLY


@rows(FREE)
def test_a_row_takes_both_its_bounds(row: ObjectRow) -> None:
    store = powered().store
    for value in row.bounds:
        store.write(row.address, row.type.encode(value))
        assert store.get(row.address) == value
        if row.access.readable:
            assert store.read(row.address) == row.type.encode(value)


@rows(BOUNDED)
def test_a_row_refuses_what_lies_past_its_bounds(row: ObjectRow) -> None:
    low, high = row.bounds
    before = fresh().get(row.address)
    if low > row.type.lowest:
        assert refusal(fresh(), row.address, row.type.encode(low - 1)) is AbortCode.TOO_LOW
    if high < row.type.highest:
        assert refusal(fresh(), row.address, row.type.encode(high + 1)) is AbortCode.TOO_HIGH
    assert fresh().get(row.address) == before


@rows([row for row in NUMBERS if row.access.writable])
def test_a_row_refuses_every_other_size(row: ObjectRow) -> None:
    for size in range(9):
        if size != row.type.size:
            wanted = AbortCode.TOO_LONG if size > row.type.size else AbortCode.TOO_SHORT
            assert refusal(fresh(), row.address, bytes(size)) is wanted


@rows(NUMBERS)
def test_a_row_can_be_mapped_or_is_refused_as_it_states(row: ObjectRow) -> None:
    entry = MappingEntry(row.address, row.type.bits).encode()
    longer = MappingEntry(row.address, row.type.bits + 8).encode()
    for direction, allowed in ((RECEIVE, row.receivable), (TRANSMIT, row.transmittable)):
        desk = blank()
        answer = desk.writes(direction.mapping, 1, entry.to_bytes(4, "little"))
        assert answer == ("ok" if allowed else "06040041")
        assert desk.writes(direction.mapping, 1, longer.to_bytes(4, "little")) == "06040041"


@cache
def blank() -> Desk:
    """Return a drive whose first PDO of each direction is invalid and empty."""
    desk = powered()
    for direction, cob_id in ((RECEIVE, "01020080"), (TRANSMIT, "810100C0")):
        assert desk.writes(direction.parameter, 1, bytes.fromhex(cob_id)) == "ok"
        assert desk.writes(direction.mapping, 0, b"\0") == "ok"
    return desk


@every("rule", VALUE_RANGES, ids=lambda rule: rule.address)
def test_a_rule_lets_through_what_it_lists_and_nothing_else(rule: ValueRange) -> None:
    store = powered().store
    kind = EPOS2_70_10.objects[rule.address].type
    allowed = rule.allowed
    few: Collection[int] = allowed
    if isinstance(allowed, range) and len(allowed) > 1 << 16:
        few = (allowed[0], allowed[1000], allowed[-1])
    for value in few:
        store.write(rule.address, kind.encode(value))
        assert store.get(rule.address) == value
    low, high = EPOS2_70_10.objects[rule.address].bounds
    for value in (min(few) - 1, max(few) + 1, 5):
        if low <= value <= high and value not in rule.allowed:
            assert refusal(store, rule.address, kind.encode(value)) is AbortCode.RANGE
    assert store.default(rule.address) in rule.allowed


def test_every_restricted_object_exists() -> None:
    assert set(RESTRICTED) <= set(EPOS2_70_10.objects)


def test_a_domain_takes_any_bytes_up_to_its_end(store: ObjectStore) -> None:
    recorder = Address(0x201B)
    assert EPOS2_70_10.objects[recorder].type is DataType.DOMAIN
    store.write(recorder, bytes(4096))
    assert store.read(recorder) == bytes(4096)
    assert refusal(store, recorder, bytes(4097)) is AbortCode.OUT_OF_MEMORY
