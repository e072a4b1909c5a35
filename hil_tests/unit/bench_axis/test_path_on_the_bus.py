"""A path by frames, put together by hand: the same bits from both servos, and again when time is put back."""

from struct import pack

import pytest

from emulators.servo import kernel
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.bench_axis.axis_on_bus import AxisOnBus

STEP_MS = 100
POSITIONS = (0, 300, 900, 1500, 1800, 1800)
VELOCITIES = (0, 150, 180, 150, 0, 0)
"""rpm; 2000 qc per turn, so that 180 rpm are 6 qc/ms."""


def download(record: bytes) -> tuple[str, str, str]:
    """Write eight bytes to 0x20C1 in two segments (CiA 301, SDO download): seven bytes, then the last one."""
    return "21C1200008000000", "00" + record[:7].hex(), "1D" + record[7:].hex() + "00" * 6


def frames() -> list[tuple[int, str]]:
    """NMT start; RPDO2: shutdown and mode 7; RPDO1: enable; 0x60C4:06 := 1; the records; bit 4."""
    begin = [(0x000, "0100"), (0x301, "060007"), (0x201, "0F00"), (0x601, "2FC4600601000000")]
    records = []
    for number, (position, velocity) in enumerate(zip(POSITIONS, VELOCITIES, strict=True)):
        last = number == len(POSITIONS) - 1
        raw = pack("<i", position) + velocity.to_bytes(3, "little") + bytes([0 if last else STEP_MS])
        records += [(0x601, text) for text in download(raw)]
    return [*begin, *records, (0x201, "1F00")]


STARTED_MS = 100 + 10 * (len(frames()) - 1)


class Run(AxisOnBus):
    def __init__(self, monkeypatch: pytest.MonkeyPatch, servo: str) -> None:
        super().__init__(monkeypatch, servo, frames())

    @property
    def demand(self) -> float:
        axis = self.bank.axes[0]
        return axis.position_demand / (1 << axis.fraction)

    def ends(self) -> tuple[float, bytes, str]:
        """Run to the end; return the demand, the axis' record, and the hash of all packets."""
        self.world.run(2 * SECOND)
        return self.demand, bytes(self.bank.axes[0]), self.world.trace_sha256


def test_both_servos_run_the_same_path_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    reference, native = (Run(monkeypatch, servo).ends() for servo in (kernel.REFERENCE, kernel.NATIVE))
    assert reference == native
    assert reference[0] == POSITIONS[-1]


def test_the_demand_is_at_each_knot_in_its_millisecond(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    for number, position in enumerate(POSITIONS):
        # The frame is there within the first tick of its ms, which is the first of the path.
        run.world.run((STARTED_MS + STEP_MS * number) * MILLISECOND - MILLISECOND // 2)
        assert run.demand == position


@pytest.mark.parametrize("after_ms", [0, 50, 100, 333, 499])
def test_a_path_goes_on_as_it_went_when_time_is_put_back(
    monkeypatch: pytest.MonkeyPatch, after_ms: int
) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.world.run((STARTED_MS + after_ms) * MILLISECOND)
    before = run.world.snapshot()
    first = run.ends()
    run.world.restore(before)
    assert run.ends() == first
    assert first[0] == POSITIONS[-1]


def test_the_path_is_reported_on_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.ends()
    words = [packet.payload.hex() for _, packet in run.master.received if packet.address == 0x181]
    # Enabled and at rest; interpolated position mode active; at its end; there, one ms later.
    assert words[-4:] == ["3707", "3713", "3703", "3707"]
