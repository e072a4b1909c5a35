"""A third party feeds a path: the `canopen` library from PyPI in interpolated position mode, in virtual time.

The records are put together here by hand from the layout that maxon documents: position as INT32, velocity as
INT24, time as U8, low byte first.
"""

from collections.abc import Callable, Iterator
from math import cos, pi, sin
from struct import pack

import canopen
import pytest

from hil_tests.interop.test_canopen_master import NODE, Bench

STEP_MS = 20
STEPS = 60
AMPLITUDE = 4000
"""Quadcounts; 2000 are one turn."""
ENABLED, ACTIVE = 0x4000, 0x8000
UNDERFLOW, OVERFLOW = 0x100, 0x200


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    made.tune()
    made.node.nmt.state = "OPERATIONAL"
    made.node.setup_402_state_machine(read_pdos=False)
    made.node.sdo[0x6060].raw = 7
    made.node.sdo.download(0x6065, 0, pack("<I", 1500))
    for word in (0x06, 0x0F):
        made.node.sdo[0x6040].raw = word
    made.bus.runs(0.05)
    made.node.sdo.download(0x60C4, 6, b"\x01")
    yield made
    made.network.bus = None


def record(position: int, velocity: int, milliseconds: int) -> bytes:
    return pack("<i", position) + velocity.to_bytes(3, "little", signed=True) + bytes([milliseconds])


def path() -> list[bytes]:
    """Once to and fro, from rest to rest."""
    records = []
    for step in range(STEPS + 1):
        phase = 2 * pi * step / STEPS
        position = AMPLITUDE * (1 - cos(phase)) / 2
        # qc/ms to rpm at 2000 qc per turn: times 30.
        velocity = AMPLITUDE / 2 * sin(phase) * 2 * pi / (STEPS * STEP_MS) * 30
        records.append(record(round(position), round(velocity), STEP_MS if step < STEPS else 0))
    return records


def status(bench: Bench) -> int:
    return int.from_bytes(bench.node.sdo.upload(0x20C4, 1), "little")


def free(bench: Bench) -> int:
    return int.from_bytes(bench.node.sdo.upload(0x60C4, 2), "little")


def by_sdo(bench: Bench, raw: bytes) -> None:
    bench.node.sdo.download(0x20C1, 0, raw)


def by_pdo(bench: Bench, raw: bytes) -> None:
    bench.network.send_message(0x500 + NODE, raw)


def map_records(bench: Bench) -> None:
    """RPDO 4 carries records and nothing else."""
    sdo = bench.node.sdo
    bench.node.nmt.state = "PRE-OPERATIONAL"
    sdo[0x1403][1].raw = 1 << 31 | 0x500 + NODE
    sdo[0x1603][0].raw = 0
    sdo.download(0x1603, 1, pack("<I", 0x20C1_0040))
    sdo[0x1603][0].raw = 1
    sdo[0x1403][1].raw = 0x500 + NODE
    bench.node.nmt.state = "OPERATIONAL"


@pytest.mark.parametrize("feed", [by_sdo, by_pdo])
def test_a_path_is_fed_while_it_runs_and_followed_to_its_end(
    bench: Bench, feed: Callable[[Bench, bytes], None]
) -> None:
    if feed is by_pdo:
        map_records(bench)
    records = path()
    for raw in records[:8]:
        feed(bench, raw)
    assert free(bench) == 56
    assert status(bench) == ENABLED
    bench.node.sdo[0x6040].raw = 0x1F
    assert status(bench) == ENABLED | ACTIVE
    highest = 0
    for raw in records[8:]:
        while free(bench) < 55:
            bench.bus.runs(0.002)
        feed(bench, raw)
        assert not status(bench) & (UNDERFLOW | OVERFLOW)
        assert bench.node.sdo[0x6041].raw & 0x1400 == 0x1000
        highest = max(highest, bench.node.sdo[0x6064].raw)
    bench.bus.runs(0.3)
    assert highest == pytest.approx(AMPLITUDE, abs=60)
    assert bench.node.sdo[0x6041].raw & 0x1400 == 0x0400
    assert bench.node.sdo[0x6064].raw == pytest.approx(0, abs=10)
    assert status(bench) & ~1 == ENABLED
    assert bench.node.emcy.log == []


def test_a_master_that_goes_quiet_is_an_emergency_and_the_drive_stops(bench: Bench) -> None:
    for raw in path()[:12]:
        by_sdo(bench, raw)
    bench.node.sdo[0x6040].raw = 0x1F
    bench.bus.runs(1.0)
    assert [error.code for error in bench.node.emcy.log] == [0xFF0C]
    assert bench.node.state == "FAULT"
    assert status(bench) == UNDERFLOW
    # Without power the rest rolls out.
    bench.bus.runs(1.0)
    assert bench.speed_rpm() == pytest.approx(0, abs=1)


def test_one_record_too_many_is_refused_and_an_emergency(bench: Bench) -> None:
    for _ in range(64):
        by_sdo(bench, record(0, 0, 10))
    with pytest.raises(canopen.SdoAbortedError) as refused:
        by_sdo(bench, record(0, 0, 10))
    assert refused.value.code == 0x0504_0005
    assert [error.code for error in bench.node.emcy.log] == [0xFF0C]
    assert status(bench) == OVERFLOW


def test_a_record_has_eight_bytes_and_is_not_read_back(bench: Bench) -> None:
    for raw, code in ((b"\0" * 7, 0x0607_0013), (b"\0" * 9, 0x0607_0012)):
        with pytest.raises(canopen.SdoAbortedError) as refused:
            by_sdo(bench, raw)
        assert refused.value.code == code
    with pytest.raises(canopen.SdoAbortedError) as refused:
        bench.node.sdo.upload(0x20C1, 0)
    assert refused.value.code == 0x0601_0001
    assert free(bench) == 64


def test_the_clock_is_set_by_a_pdo(bench: Bench) -> None:
    sdo = bench.node.sdo
    bench.node.nmt.state = "PRE-OPERATIONAL"
    sdo[0x1402][1].raw = 1 << 31 | 0x400 + NODE
    sdo[0x1602][0].raw = 0
    sdo.download(0x1602, 1, pack("<I", 0x1013_0020))
    sdo[0x1602][0].raw = 1
    sdo[0x1402][1].raw = 0x400 + NODE
    bench.node.nmt.state = "OPERATIONAL"
    bench.network.send_message(0x80, b"")
    bench.network.send_message(0x400 + NODE, pack("<I", 5_000_000))
    assert int.from_bytes(sdo.upload(0x1013, 0), "little") == 5_000_000
    begun = bench.world.now
    bench.network.send_message(0x80, b"")
    passed = int.from_bytes(sdo.upload(0x1013, 0), "little") - 5_000_000
    assert 4000 <= passed <= begun // 1000
