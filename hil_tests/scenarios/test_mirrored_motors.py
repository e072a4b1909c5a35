"""A motor that is mounted the other way round, as declared in the robot file, moves the robot as before."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import numpy as np
import pytest

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Samples
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from emulators.servo.pins import SWITCHES, input_lines
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.scenarios.homed import LIFT, homed
from hil_tests.scenarios.ride import ARMED, Ridden, fault, step

MISSIONS: Final = {
    "rars": ("line", 7.0),
    "rome": ("line", 7.0),
    "climber": ("vertical", 9.0),
    "diff_drive": ("line", 7.0),
    "ar2": ("pose", 9.0),
    "rome_arm": ("pose", 9.0),
}
PLACES: Final = {"x_m", "y_m", "tool_x_m", "tool_y_m", "tool_z_m"}
SAME_M: Final = 0.003
"""A shield's regulator steps by whole counts: a wheel that counts down is up to a cycle's step apart."""
MOVED_M: Final = 0.005
TURNS_RAD_S: Final = 50.0


def mirrored(robot: AnyRobot, *names: str) -> AnyRobot:
    """Return the robot with these motors, or all, mounted the other way round."""
    turned = [
        axis.model_copy(update={"direction": -axis.direction}) if not names or axis.name in names else axis
        for axis in robot.axes
    ]
    return robot.model_copy(update={"axes": tuple(turned)})


@contextmanager
def driven(robot: AnyRobot) -> Iterator[Samples]:
    """Give what became of the first seconds of one of its missions."""
    bench_setup = bench_setup_of(robot)
    name, seconds = MISSIONS[robot.name]
    plan = mission.find(name, robot, bench_setup)
    operator = ScriptedOperator(plan.on(robot), bench_setup, plan, np.random.default_rng(1))
    rig = Rig(plan.on(robot), bench_setup, operator, seed=1, noise=plan.noise)
    try:
        rig.runs(seconds)
        yield rig.samples
    finally:
        rig.finish()


@pytest.mark.long(keeps=["rars", "rome", "diff_drive", "climber"])
@pytest.mark.parametrize("name", MISSIONS)
def test_the_robot_moves_as_with_motors_that_are_not_mirrored(name: str) -> None:
    robot = find(name)
    with driven(robot) as usual, driven(mirrored(robot)) as turned:
        columns = {column.name for column in usual.columns}
        places, speeds = PLACES & columns, [name for name in columns if name.startswith("motor_speed_")]
        for one, other in zip(usual, turned, strict=True):
            assert one["armed"] == other["armed"]
            for key in places:
                assert one[key] == pytest.approx(other[key], abs=SAME_M), f"{key} at {one.at / 1e9:g} s"
        assert max(abs(usual[-1][key] - usual[0][key]) for key in places) > MOVED_M
        for key in speeds:
            if max(abs(one[key]) for one in usual) > TURNS_RAD_S:
                turns = sum(one[key] * other[key] for one, other in zip(usual, turned, strict=True))
                assert turns < 0.0, f"{key} is the motor's own"


def test_a_mirrored_lift_is_homed_by_its_drives_other_direction(rides: Ridden) -> None:
    robot = mirrored(homed(LIFT.replace("method = -4", "method = -3")), "lift")
    restart = fault("drive_restart", 5.2, node="lift", for_s=0.2)
    raised = step(4.0, lift_m=0.05), step(7.0, lift_m=0.0), step(9.0, home=["lift"])
    one = rides(ARMED, *raised, seconds=20, robot=robot, faults=[restart])
    one.runs_until(8.9)
    assert one.now["lift_m"] > 0.04
    one.runs_until(19.0)
    assert one.held("homing: lift")
    assert not {"homing: lift", "not homed: lift"} & one.holding
    assert one.now["lift_m"] == pytest.approx(0.0, abs=2e-3)
    assert one.rig.bridge.seen.body.lift_m == pytest.approx(0.0, abs=1e-3)


def test_each_limit_switch_ends_the_motion_towards_it() -> None:
    outputs = ("negative_limit_a", "positive_limit_a", "home_a", "negative_limit_b", "positive_limit_b")
    wired = {(line.axis, outputs[line.variable]): line.mask for line in input_lines(outputs, "ab", "b")}
    low, high, home = (1 << SWITCHES[name] - 1 for name in ("negative_limit", "positive_limit", "home"))
    assert wired == {
        (0, "negative_limit_a"): low,
        (0, "positive_limit_a"): high,
        (0, "home_a"): home,
        (1, "negative_limit_b"): high,
        (1, "positive_limit_b"): low,
    }
