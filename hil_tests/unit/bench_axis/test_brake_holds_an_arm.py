"""A weight on an arm: the holding brake keeps it up when the motor lets go, and is open when it turns."""

from typing import Final

import pytest

from emulators.epos2.io.holding_brake import FALL_TIME, RISE_TIME
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire.functions import OUTPUT_PINS, OutputFunction
from firmware_bridge.families.epos2.wire.modes import Mode
from hil_tests.unit.bench_axis.axis_bench import GEAR, AxisBench

ARM: Final = {"unbalance": 10.0, "stop_low": -10.0, "stop_high": 10.0, "backlash": 0.0}
START: Final = 0x1F


def level(braked: int) -> AxisBench:
    """An arm that the drive holds near the horizontal, with or without a brake."""
    bench = AxisBench(0.0, ARM)
    if braked:
        bench.write(OUTPUT_PINS[0], OutputFunction.HOLDING_BRAKE)
        bench.write(RISE_TIME, 20)
        bench.write(FALL_TIME, 20)
        bench.run(10)
    bench.write(od.PROFILE_ACCELERATION, 1000)
    bench.write(od.PROFILE_DECELERATION, 1000)
    bench.enable(Mode.PROFILE_POSITION)
    bench.run(100)
    bench.write(od.TARGET_POSITION, round(1.4 * GEAR * 2000 / 6.2832))
    bench.write(od.CONTROLWORD, START)
    bench.run(3000)
    assert bench.word & 1 << 10
    return bench


@pytest.mark.parametrize("word", [0x00, 0x06, 0x07])
def test_the_brake_takes_the_load_over_before_power_goes(word: int) -> None:
    bench = level(braked=1)
    before = bench.axis.encoder
    bench.write(od.CONTROLWORD, word)
    bench.run(1000)
    assert not bench.axis.powered
    assert abs(bench.axis.encoder - before) < 30


def test_without_a_brake_it_falls() -> None:
    bench = level(braked=0)
    before = bench.axis.encoder
    bench.write(od.CONTROLWORD, 0x00)
    bench.run(1000)
    assert bench.axis.encoder < before - 1000


def test_a_fault_that_cuts_the_power_leaves_it_to_the_brake() -> None:
    bench = level(braked=1)
    before = bench.axis.encoder
    bench.control.communication_fault(0x2310)
    assert bench.control.state is PowerState.FAULT
    bench.run(1000)
    assert abs(bench.axis.encoder - before) < 60
