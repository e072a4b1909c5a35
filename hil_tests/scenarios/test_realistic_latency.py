"""The robot with drives that take their real time to answer: set up, armed and driven as with fast ones."""

import pytest

from emulators.bench.mission import Mission
from emulators.bench.step import Input
from emulators.testing.inherited.scripted import scripted
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from hil_tests.scenarios.ride import ARMED, STANDS, step


def test_the_robot_drives_with_the_published_answer_times() -> None:
    mission = Mission(
        title="a straight line",
        duration_s=8.0,
        input=Input.STICK,
        step=(STANDS, ARMED, step(3.5, speed_mps=0.2)),
    )
    with scripted(find("rars"), mission, realistic_latency=True) as rig:
        rig.run(from_seconds(8.0))
        assert rig.samples[-1]["armed"]
        assert rig.samples[-1]["speed_mps"] == pytest.approx(0.2, abs=0.01)
        assert [event for event in rig.interlock_events if event.ended is None] == []
