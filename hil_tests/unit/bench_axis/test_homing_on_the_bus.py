"""A homing by frames: the same bits from both servos, and again when time is put back."""

import pytest

from emulators.servo import kernel
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.bench_axis.axis_bench import TURN
from hil_tests.unit.bench_axis.axis_on_bus import AxisOnBus

# NMT start; 0x6098 := 2; RPDO2 shutdown and homing mode; then RPDO1 enable, and start.
START = ((0x000, "0100"), (0x601, "2f98600002"), (0x301, "060006"), (0x201, "0F00"), (0x201, "1F00"))


class Run(AxisOnBus):
    def __init__(self, monkeypatch: pytest.MonkeyPatch, servo: str) -> None:
        super().__init__(monkeypatch, servo, START)

    def ends(self) -> tuple[int, bytes, str]:
        """Run to the end; return where home is, the axis' record, and the hash of all packets."""
        self.world.run(5 * SECOND)
        axis = self.bank.axes[0]
        return axis.encoder - axis.position, bytes(axis), self.world.trace_sha256


def test_both_servos_find_the_same_home_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    reference, native = (Run(monkeypatch, servo).ends() for servo in (kernel.REFERENCE, kernel.NATIVE))
    assert reference == native
    assert reference[0] == 7 * TURN


@pytest.mark.parametrize("instant_ms", [141, 900, 1800, 2600])
def test_a_homing_goes_on_as_it_went_when_time_is_put_back(
    monkeypatch: pytest.MonkeyPatch, instant_ms: int
) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.world.run(instant_ms * MILLISECOND)
    before = run.world.snapshot()
    first = run.ends()
    run.world.restore(before)
    assert run.ends() == first
    assert first[0] == 7 * TURN


def test_the_end_of_a_homing_is_reported_on_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.ends()
    words = [packet.payload.hex() for _, packet in run.master.received if packet.address == 0x181]
    # Enabled and at rest, homing, attained and referenced.
    assert words[-3:] == ["3707", "3703", "3797"]
