"""Coverage of a search: which joint states of the bridge were met with which faults."""

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.bridge.joint_state import Life, Motion
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND
from hil_tests.adversary.coverage import JOINT_STATES, Coverage
from hil_tests.adversary.search import Life as Driven
from hil_tests.adversary.truth import invariants

MISSION = """
title = "a stop while a drive is silent, and a restart while the stop is latched"
duration_s = 8
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 4.3
title = "stop"
emergency_stop = true
[[fault]]
kind = "datagram_late"
at_s = 4.0
for_s = 0.5
by_ms = 10
[[fault]]
kind = "drive_restart"
at_s = 5.0
node = "left"
"""


def test_each_fault_is_counted_with_the_joint_states_in_which_it_was_on() -> None:
    robot = find("diff_drive")
    bench_setup, met = bench_setup_of(robot), Coverage()
    mission = missions.parse(MISSION, "coverage.toml", robot, bench_setup)
    driven = Driven(robot, bench_setup, mission, 0, invariants(robot), coverage=met)
    try:
        assert driven.run(8 * SECOND) is None
    finally:
        driven.rig.finish()
    assert met.met == {
        (Life.RUNNING, Motion.ARMED, "datagram_late"),
        (Life.RUNNING, Motion.STOPPED, "datagram_late"),
        (Life.RUNNING, Motion.STOPPED, "drive_restart"),
    }
    share = met.share(frozenset({"datagram_late", "drive_restart"}))
    assert share.startswith(f"3 of {2 * len(JOINT_STATES)} ")
    assert "running: armed" not in met.never
    assert "running: terminated" in met.never
