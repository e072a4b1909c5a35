"""The capture systems that see a robot: for each of its links to one, its body on the plant's truth."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.motion_capture.bodies import TrackedBody
from emulators.motion_capture.exposure import Cameras, Up
from emulators.motion_capture.film import FLOOR, SPACE, Film, Physics
from emulators.motion_capture.system import DATA, DEFAULT, MotionCapture, Timing
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureDriver, CaptureLink
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from fmu.plant import FmuPlant

CAPTURE_STREAM: Final = 3
"""Stream of random numbers for the capture systems, beside the run's seed."""
TRUTH: Final = tuple(dict.fromkeys(FLOOR + SPACE))
"""The plant's outputs that a body is seen by; `FLOOR` or `SPACE` will do."""
NAME: Final = "robot"
"""Name of a body that the robot file knows by its number."""


@dataclass(frozen=True, slots=True)
class Captured:
    """Capture systems by the links' names, and the physics below them, which they have on film."""

    systems: Mapping[str, MotionCapture]
    physics: Physics


def captured(
    robot: AnyRobot,
    physics: Physics,
    plant: FmuPlant,
    seed: int,
    *,
    version: Version = DEFAULT,
    data_link: str = DATA,
    markers: bool = True,
) -> Captured:
    """Return the capture systems that see a robot; RobotFileError where the plant has no place.

    The body is where the robot is, its axes those of the robot: the mount in the robot file is not emulated.
    So it is refused where it is not zero. With `markers` the stream has the bodies' markers, too.
    """
    for name, link in CaptureLink.all_of(robot).items():
        _possible(robot, name, link.driver, plant)
    if not CaptureLink.all_of(robot):
        return Captured({}, physics)
    timing, found = Timing(), dict[str, MotionCapture]()
    film = Film(physics, plant, plant.output_names, timing.exposed_at)
    for number, name in enumerate(CaptureLink.all_of(robot)):
        seen = [
            sensor.settings
            for sensor in robot.sensors
            if sensor.link == name and isinstance(sensor.settings, CaptureBody)
        ]
        bodies = [
            TrackedBody(body, NAME, film) if isinstance(body, int) else TrackedBody(place, body, film)
            for place, body in enumerate(dict.fromkeys(one.body for one in seen), 1)
        ]
        found[name] = MotionCapture(
            bodies,
            # A stream for each system: one more camera link changes no other's noise.
            np.random.default_rng([seed, CAPTURE_STREAM, number]),
            version=version,
            cameras=Cameras(up=Up(seen[0].up.value), markers=markers),
            timing=timing,
            data_link=data_link,
        )
    return Captured(found, film)


def _possible(robot: AnyRobot, name: str, driver: CaptureDriver, plant: FmuPlant) -> None:
    if driver is not CaptureDriver.NATNET:
        raise RobotFileError(robot.name, Problem(f"links.{name}.driver", f"'{driver}' is not emulated"))
    lacks = [output for output in FLOOR if output not in plant.output_names]
    if lacks and not set(SPACE) <= set(plant.output_names):
        problem = f"a captured body needs the plant's outputs {', '.join(lacks)}"
        raise RobotFileError(robot.name, Problem("plant.fmu", problem))
    for index, sensor in enumerate(robot.sensors):
        if (
            isinstance(sensor.settings, CaptureBody)
            and sensor.settings.mount != type(sensor.settings.mount)()
        ):
            problem = "the emulated body sits on the robot's reference point; leave mount out"
            raise RobotFileError(robot.name, Problem(f"sensors[{index}].settings.mount", problem))
