"""Many drives on one bus, as the benchmarks put them there: the measured tasks are those in the tables."""

import ctypes
from collections import Counter
from pathlib import Path

from benchmarks.drives import crowd, only_sync
from firmware_bridge.canopen.cia301 import ERROR_CONTROL, RECEIVE_PDO, SYNC, TRANSMIT_PDO
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.unit.servo.side_by_side import PLANT, compiled

HUNDRED_MS = 100 * MILLISECOND


def test_each_drive_is_commanded_and_turns(tmp_path: Path) -> None:
    many = crowd(3, motors=ctypes.CDLL(str(compiled(tmp_path, PLANT, "-O2"))))
    many.runs_a_second()
    assert many.turning == 3


def test_in_a_second_each_drive_reports_ten_times_what_it_sees_and_that_it_lives() -> None:
    many = crowd(127, every=HUNDRED_MS, heartbeat_ms=100, cycle=only_sync)
    received: Counter[int] = Counter()

    def count(_now: Nanoseconds, _sender: str, packet: Packet) -> None:
        received[packet.address] += 1

    many.wire.observe(count)
    many.runs_a_second()
    assert received[SYNC] == 10
    for node in range(1, 128):
        assert received[TRANSMIT_PDO[3] + node] == 10
        assert received[ERROR_CONTROL + node] == 10
        assert received[RECEIVE_PDO[3] + node] == 0
    assert received.total() == 10 * (1 + 2 * 127)
