"""ROME's limits over its shipped missions: the speed's by the plant, the acceleration's of the set-points.

The plant's acceleration is the mean over each window of one cycle of the set-points, in whichever direction.
It has a bound above the limit, which docs/decisions/omni-limits.md states. A wheel in the air, and what
follows as it lands, is a fault's, not the ramp's: those windows are left out.
"""

from typing import Any, Final

import numpy as np
import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.rig import Rig
from emulators.testing.inherited.scripted import scripted
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds

ROW_S: Final = 0.010
BEHIND_THE_LOOP: Final = 1.45
"""The plant's acceleration over the limit of the set-points'."""
LANDED_S: Final = 0.5
"""After a wheel has come down, the loops have caught up."""
DRIVEN: Final = [
    *(
        (name, mission)
        for name in ("rome", "rome+cameras")
        for mission in ("line", "circle", "ellipse", "floor")
    ),
    *(
        (name, mission)
        for name in ("rome_arm", "rome_arm+cameras")
        for mission in ("orbit", "formation", "pose")
    ),
]


def limits_of(rig: Rig) -> Any:
    """Return the base's limits, of the base alone or under the arm."""
    geometry = rig.robot.geometry
    return getattr(geometry, "limits", None) or geometry.base.limits


def gained(velocity: np.ndarray, window: int) -> np.ndarray:
    """Return the mean acceleration of each window, m/s2."""
    change: np.ndarray = np.abs(velocity[window:] - velocity[:-window]) / (window * ROW_S)
    return change


def undisturbed(rig: Rig, window: int) -> np.ndarray:
    """Return the windows, by their first rows, that have no part in a fault."""
    begins = rig.samples.seconds[:-window]
    kept = np.ones(begins.shape, dtype=bool)
    for fault in rig.faults.records:
        began, ended = (np.inf if at is None else to_seconds(at) for at in (fault.began, fault.ended))
        kept &= (begins + window * ROW_S < began) | (begins > ended + LANDED_S)
    return kept


@pytest.mark.long(keeps=["rome-line"])
@pytest.mark.parametrize(("name", "mission"), DRIVEN, ids=["-".join(it) for it in DRIVEN])
def test_the_base_keeps_its_speed_and_the_set_points_their_acceleration_at_every_instant(
    name: str, mission: str
) -> None:
    robot = find(name)
    script = missions.find(mission, robot, bench_setup_of(robot))
    with scripted(robot, script) as rig:
        rig.run(from_seconds(script.duration_s))
        column, window = rig.samples.column, robot.cycle_ms // 10
        velocity = column("speed_mps") + 1j * column("speed_left_mps")
        in_the_room = velocity * np.exp(1j * column("heading_rad"))
        set_point = column("demanded_speed_mps") + 1j * column("demanded_left_mps")
        limits = limits_of(rig)
        assert np.abs(velocity).max() > 0.05, "it has moved"
        assert np.abs(velocity).max() <= limits.speed_mps
        # A set-point stays for a cycle, so that its step is that cycle's.
        ramp = np.nanmax(np.abs(np.diff(set_point))) / (window * ROW_S)
        assert ramp <= limits.acceleration_mps2
        assert ramp > 0.5 * limits.acceleration_mps2, "the ramp was in use"
        real = gained(in_the_room, window)[undisturbed(rig, window)]
        assert real.max() <= BEHIND_THE_LOOP * limits.acceleration_mps2
