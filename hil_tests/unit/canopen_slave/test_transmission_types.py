"""When a PDO is sent and taken over: every transmission type of CiA 301, inhibit time and event timer."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.canopen_slave.plain_slave import PlainSlave

SYNC = "080#"
REQUEST = "40000185#"  # bit 30: a remote request
START = "000#0105"
POWERED = 0x0021


def written(slave: PlainSlave, index: int, sub: int, value: int, size: int) -> str:
    head = {1: "2F", 2: "2B", 4: "23"}[size]
    frame = f"605#{head}{index.to_bytes(2, 'little').hex().upper()}{sub:02X}"
    (answer,) = slave.takes(frame + value.to_bytes(4, "little").hex().upper())
    return answer


def sending(transmission: int, inhibit: int = 0, event: int = 0) -> PlainSlave:
    """Return a started slave whose only PDO has this type; `inhibit` in 100 us, `event` in ms."""
    slave = PlainSlave()
    slave.wakes(0)
    for sub, value, size in ((2, transmission, 1), (3, inhibit, 2), (5, event, 2)):
        assert written(slave, 0x1800, sub, value, size).startswith("585#60")
    written(slave, 0x1800, 1, 0x185, 4)
    return slave


@pytest.mark.parametrize("transmission", [0, 1, 2, 240, 252, 253, 254, 255])
def test_the_types_of_the_standard_are_taken(transmission: int) -> None:
    sending(transmission)


@pytest.mark.parametrize(
    ("index", "transmission"), [(0x1800, 241), (0x1800, 251), (0x1400, 241), (0x1400, 252), (0x1400, 253)]
)
def test_the_reserved_types_are_refused_and_those_without_sense_for_receiving(
    index: int, transmission: int
) -> None:
    slave = PlainSlave()
    slave.wakes(0)
    assert written(slave, index, 2, transmission, 1).endswith("30000906")


def test_type_0_is_sent_at_a_sync_after_a_change_only() -> None:
    slave = sending(0)
    assert slave.takes(START) == []
    assert slave.takes(SYNC) == ["185#4000"]
    assert slave.takes(SYNC) == []
    slave.store.set(od.STATUSWORD, POWERED)
    assert slave.wakes(MILLISECOND) == []
    assert slave.takes(SYNC) == ["185#2100"]
    assert slave.takes(SYNC) == []


@pytest.mark.parametrize("every", [1, 2, 3, 240])
def test_types_1_to_240_are_sent_at_every_so_many_syncs(every: int) -> None:
    slave = sending(every)
    slave.takes(START)
    sent = [slave.takes(SYNC) for _ in range(2 * every + 1)]
    assert sent == [["185#4000"] if place % every == 0 else [] for place in range(2 * every + 1)]
    # The count begins again with the next start.
    slave.takes("000#8005")
    slave.takes(START)
    assert slave.takes(SYNC) == ["185#4000"]


def test_type_252_answers_with_the_values_of_the_last_sync() -> None:
    slave = sending(252)
    slave.takes(START)
    assert slave.takes(SYNC) == []
    slave.store.set(od.STATUSWORD, POWERED)
    assert slave.takes(REQUEST) == ["185#4000"]
    assert slave.takes(SYNC) == []
    assert slave.takes(REQUEST) == ["185#2100"]


def test_type_253_answers_with_the_values_of_the_request() -> None:
    slave = sending(253)
    slave.takes(START)
    slave.takes(SYNC)
    slave.store.set(od.STATUSWORD, POWERED)
    assert slave.wakes(MILLISECOND) == []
    assert slave.takes(REQUEST) == ["185#2100"]


@pytest.mark.parametrize("transmission", [254, 255])
def test_the_event_timer_sends_what_has_not_changed_and_begins_again_with_each_message(
    transmission: int,
) -> None:
    slave = sending(transmission, event=10)
    assert slave.takes(START) == ["185#4000"]
    sent = {now: slave.wakes(now * MILLISECOND) for now in range(1, 31)}
    assert {now for now, frames in sent.items() if frames} == {10, 20, 30}
    slave.now = 34 * MILLISECOND
    slave.store.set(od.STATUSWORD, POWERED)
    assert slave.wakes(34 * MILLISECOND) == ["185#2100"]
    assert [now for now in range(35, 60) if slave.wakes(now * MILLISECOND)] == [44, 54]


def test_the_event_timer_waits_for_the_inhibit_time() -> None:
    slave = sending(255, inhibit=50, event=2)
    slave.takes(START)
    assert [now for now in range(1, 16) if slave.wakes(now * MILLISECOND)] == [5, 10, 15]


def test_the_slave_wakes_for_its_event_timer() -> None:
    slave = sending(255, event=10)
    slave.takes(START)
    assert slave.slave.wake(MILLISECOND).wake_at == 10 * MILLISECOND


@pytest.mark.parametrize("transmission", [0, 1, 240])
def test_a_synchronous_receive_pdo_is_taken_over_at_the_next_sync(transmission: int) -> None:
    slave = PlainSlave()
    slave.wakes(0)
    written(slave, 0x1400, 2, transmission, 1)
    slave.takes(START)
    slave.takes("205#0600")
    assert slave.store.get(od.CONTROLWORD) == 0
    slave.takes(SYNC)
    assert slave.store.get(od.CONTROLWORD) == 6


def test_a_receive_pdo_that_stays_away_for_its_event_timer_is_an_emergency_once() -> None:
    slave = PlainSlave()
    slave.wakes(0)
    written(slave, 0x1400, 5, 10, 2)
    slave.takes(START)
    # The watch begins with the first message.
    assert slave.wakes(50 * MILLISECOND) == []
    slave.takes("205#0600")
    found = {now: slave.wakes(now * MILLISECOND) for now in range(51, 80)}
    assert {now: frames for now, frames in found.items() if frames} == {60: ["085#5082100000000000"]}
    slave.takes("205#0600")
    # A late wake: the message that comes after the time does not hide that it was missed.
    slave.now = 95 * MILLISECOND
    assert slave.takes("205#0600") == ["085#5082100000000000"]


def test_no_receive_pdo_is_missed_outside_operational() -> None:
    slave = PlainSlave()
    slave.wakes(0)
    written(slave, 0x1400, 5, 10, 2)
    slave.takes(START)
    slave.takes("205#0600")
    slave.takes("000#8005")
    assert all(slave.wakes(now * MILLISECOND) == [] for now in range(1, 30))


def test_sync_comes_with_the_identifier_of_its_object() -> None:
    slave = sending(1)
    assert written(slave, 0x1005, 0, 0x90, 4).startswith("585#60")
    # It cannot send SYNC itself.
    assert written(slave, 0x1005, 0, 0x4000_0080, 4).endswith("30000906")
    slave.takes(START)
    assert slave.takes(SYNC) == []
    assert slave.takes("090#") == ["185#4000"]
