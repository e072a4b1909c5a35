"""The robot's rows at the edges of their thresholds; the tests that every robot gets go through them."""

from collections.abc import Iterator

from emulators.bench import differential
from emulators.bench.cases import Case
from firmware_bridge.differential.geometry import Geometry
from firmware_bridge.robot import Robot

from diff_drive.motion import Motion, State
from diff_drive.robot import ROBOT


def cases(robot: Robot[Geometry]) -> Iterator[Case[Motion, State]]:
    """Yield at least one case for each interlock and limit; a row of its own needs its own case here."""
    yield from differential.cases(robot, Motion, State(0.0, 0.0), spin=ROBOT.spin)
