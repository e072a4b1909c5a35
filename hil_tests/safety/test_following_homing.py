"""Plausible motion of an axis that homes: as fast as commanded, either way, and then at rest."""

from typing import Final

from firmware_bridge.drivers.driver import Homed, Stop
from firmware_bridge.robot import Axis
from firmware_bridge.safety.tracking import bounds_of
from hil_tests.safety.following_bench import RARS, Axle
from hil_tests.scenarios.homed import LIFT as HOMING
from hil_tests.scenarios.homed import homed

LIFT: Final[Axis] = homed().axes[3]
FAST: Final = 4.0
SLACK: Final = 29.3 / 40.0 + FAST / 50.0
"""rad/s of the screw: a 40th of its top speed, and a 50th of this one."""


def homes() -> Axle:
    one = Axle(LIFT)
    one.commanded(Stop.STANDSTILL)
    one.does(0.0, 3)
    one.commanded(Homed())
    return one


def test_it_may_go_either_way_as_fast_as_its_file_states_and_stand() -> None:
    one = homes()
    for speed in (-FAST - 0.99 * SLACK, FAST + 0.99 * SLACK, 0.0, -1.0, -FAST):
        for _ in range(40):
            assert not one.deviates(speed), speed


def test_faster_is_uncommanded_from_the_first_sample_on() -> None:
    for speed in (-FAST - 1.01 * SLACK, FAST + 1.01 * SLACK):
        one = homes()
        assert one.deviates(speed)
        assert one.does(speed).uncommanded


def test_to_stand_is_no_debt() -> None:
    known = homes().does(0.0, 100)
    assert known.settled_at == known.sampled_at
    assert known.backlog == 0.0


def test_reported_to_rest_it_may_ramp_down_and_no_longer_run() -> None:
    one = homes()
    one.does(-FAST, 5)
    one.commanded(Stop.STANDSTILL)
    assert not one.deviates(-FAST)
    one.does(-0.1, 20)
    assert one.deviates(-FAST)


def test_a_gentle_homing_is_awaited_as_gently() -> None:
    """Half of what it is halted with; without a homing half of what its drive ramps with."""
    gentle = homed().axes[3]
    assert bounds_of(RARS, gentle).ramp == 0.5 * 40.0
    steep = RARS.axes[3]
    assert bounds_of(RARS, steep).ramp > 0.5 * 40.0


def test_a_steep_homing_is_awaited_as_its_drive_ramps() -> None:
    steep = homed(HOMING.replace("acceleration = 40.0", "acceleration = 2000.0")).axes[3]
    assert bounds_of(RARS, steep).ramp == bounds_of(RARS, RARS.axes[3]).ramp


def test_an_axis_without_a_homing_has_no_speed_for_it() -> None:
    assert {axis.name: bounds_of(RARS, axis).homing for axis in RARS.axes} == {
        axis.name: 0.0 for axis in RARS.axes
    }
    assert bounds_of(RARS, LIFT).homing == FAST
