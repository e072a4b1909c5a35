"""The slave of the standards without any product's rows: what it needs of a dictionary, and its defaults."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.canopen_slave.plain_slave import NODE_NUMBER, PlainSlave


@pytest.fixture
def slave() -> PlainSlave:
    made = PlainSlave()
    assert made.wakes(0) == ["705#00"]
    return made


def test_it_reads_its_device_type(slave: PlainSlave) -> None:
    assert slave.takes("605#4000100000000000") == ["585#4300100092010200"]


@pytest.mark.parametrize(
    ("request_frame", "abort"),
    [
        ("605#400C100000000000", "00000206"),  # no node guarding in this dictionary
        ("605#4003100300000000", "11000906"),  # a history of two errors
        ("605#2310100100000000", "20000008"),  # CiA 301: no signature
        ("605#2F02180000000000", "00000206"),  # one PDO of each direction
    ],
)
def test_it_refuses_as_the_standard_does(slave: PlainSlave, request_frame: str, abort: str) -> None:
    (answer,) = slave.takes(request_frame)
    assert answer == f"585#80{request_frame[6:12]}{abort}"


def test_a_mapping_changes_in_pre_operational_only_and_while_the_pdo_is_invalid(slave: PlainSlave) -> None:
    assert slave.takes("605#2F001A0000000000") == ["585#80001A0000000106"]
    assert slave.takes("605#23001801850100C0") == ["585#6000180100000000"]
    assert slave.takes("605#2F001A0000000000") == ["585#60001A0000000000"]
    assert slave.takes("000#0105") == []
    assert slave.takes("605#2F001A0001000000") == ["585#80001A0022000008"]


def test_process_data_goes_both_ways(slave: PlainSlave) -> None:
    assert slave.takes("000#0105") == ["185#4000"]
    assert slave.application.operational
    slave.takes("205#0600")
    assert slave.store.get(od.CONTROLWORD) == 6
    slave.store.set(od.STATUSWORD, 0x0021)
    assert slave.wakes(MILLISECOND) == ["185#2100"]


def test_errors_of_the_bus_side_are_emergencies_with_a_history_of_its_length(slave: PlainSlave) -> None:
    slave.takes("000#0105")
    assert slave.takes("205#06") == ["085#1082100000000000"]
    assert [slave.takes("205#06") for _ in range(2)][-1] == ["085#1082100000000000"]
    assert slave.store.get(od.ERROR_HISTORY_COUNT) == 2
    slave.takes("000#8205")
    assert slave.store.get(od.ERROR_REGISTER) == 0


def test_each_of_three_consumers_watches_its_node(slave: PlainSlave) -> None:
    for sub, node in ((1, 7), (2, 8), (3, 9)):
        assert slave.takes(f"605#231610{sub:02X}0A00{node:02X}00") == [f"585#601610{sub:02X}00000000"]
    assert slave.takes("605#231610020A000900") == ["585#8016100243000406"]
    slave.takes("709#05")
    slave.wakes(11 * MILLISECOND)
    assert slave.application.lost == 1


def test_a_number_from_the_bus_counts_where_the_hardware_gives_none() -> None:
    slave = PlainSlave(hardware_node=0)
    assert slave.wakes(0) == ["701#00"]
    slave.takes("000#0200")
    slave.takes("7E5#0401000000000000")
    assert slave.takes("7E5#1109000000000000") == ["7E4#1100000000000000"]
    assert slave.takes("7E5#1700000000000000") == ["7E4#1700000000000000"]
    assert slave.takes("000#8100") == ["709#00"]
    assert slave.store.get(NODE_NUMBER) == 9
