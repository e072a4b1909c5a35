"""The robot with drives that take their real time to answer: set up, armed and driven as with fast ones."""

import numpy as np
import pytest

from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.bench.step import Input
from emulators.rig import Rig
from emulators.robots.rars import REHEARSAL
from firmware_bridge.kinds import find
from hil_tests.scenarios.ride import ARMED, STANDS, Ride, step


def test_the_robot_drives_with_the_published_answer_times() -> None:
    robot = find("rars")
    mission = Mission(
        title="a straight line",
        duration_s=8.0,
        input=Input.STICK,
        step=(STANDS, ARMED, step(3.5, speed_mps=0.2)),
    )
    operator = ScriptedOperator(robot, REHEARSAL, mission, np.random.default_rng(0))
    rig = Rig(robot, REHEARSAL, operator, realistic_latency=True)
    told = Ride(rig, operator)
    told.runs_until(8.0)
    assert told.now["armed"]
    assert told.now["speed_mps"] == pytest.approx(0.2, abs=0.01)
    assert told.holding == set()
    rig.finish()
