"""How long a stop may last, by its stages."""

from dataclasses import replace

import pytest

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.stop_stages import StopStage, gentle_within, sequence, sums
from firmware_bridge.units import MILLISECOND, SECOND

MS = MILLISECOND
RAMP = StopStage("ramp", "a ramp", Stop.STANDSTILL, 200 * MS, deceleration=2.0)
BRAKE = StopStage("brake", "a quick stop", Stop.QUICK_STOP, 300 * MS, deceleration=4.0)
OFF = StopStage("off", "power off", Stop.POWER_OFF, 400 * MS, ends_power=True)
RESET = StopStage("reset", "a reset", Stop.POWER_OFF, 1_000 * MS, ends_power=True)
CUT = StopStage("cut", "silence", Stop.POWER_OFF, 50 * MS)
SLOW = replace(RAMP, deceleration=0.1)


@pytest.mark.parametrize(
    ("stages", "speed", "taken", "together"),
    [
        # Ramp 0.2 + 1.0/2.0 s, brake 0.3 + 1.0/4.0 s, off 0.4 s; what comes after it counts in all.
        ((RAMP, BRAKE, OFF, RESET), 1.0, 1_650, 2_650),
        ((RAMP, BRAKE, OFF, RESET), -1.0, 1_650, 2_650),
        ((RAMP, BRAKE, OFF, RESET), 0.0, 900, 1_900),
        ((RAMP, OFF, RESET, CUT), 1.0, 1_100, 2_150),
        ((OFF, RESET), 1.0, 400, 1_400),
        # The gentle stages end after 5 s less the time of the first that disables the power.
        ((SLOW, OFF), 1.0, 5_000, 5_000),
        ((SLOW, BRAKE, OFF, CUT), 1.0, 5_000, 5_050),
        # Without one that disables the power the last one counts as it.
        ((RAMP, BRAKE), 1.0, 1_250, 1_250),
        ((CUT,), 1.0, 50, 50),
    ],
)
def test_the_time_of_a_stop_until_the_power_is_taken_and_in_all(
    stages: tuple[StopStage, ...], speed: float, taken: int, together: int
) -> None:
    assert sums(stages, speed) == (taken * MS, together * MS)


def test_the_gentle_stages_have_five_seconds_less_the_first_that_disables_the_power() -> None:
    assert gentle_within((RAMP, OFF, RESET)) == 4_600 * MS
    assert gentle_within((RAMP, BRAKE)) == 5 * SECOND


def test_an_ordered_power_off_goes_through_the_stages_that_disable_it() -> None:
    ordered = replace(OFF, ordered_off=True)
    assert sequence((RAMP, ordered, RESET, CUT), off=True) == (ordered, RESET)
    assert sequence((RAMP, ordered, RESET, CUT), off=False) == (RAMP, RESET, CUT)


@pytest.mark.parametrize(("slows_within", "judged"), [(None, 700), (0, 500), (100 * MS, 600)])
def test_an_axis_that_does_not_slow_down_is_judged_after_its_ramp(
    slows_within: int | None, judged: int
) -> None:
    assert replace(RAMP, slows_within=slows_within).judged_after(-1.0) == judged * MS
    assert (
        replace(RAMP, slows_within=slows_within, deceleration=None).judged_after(1.0) == (judged - 500) * MS
    )
