"""The capture systems that see a robot: for each of its links to one, its body on the plant's truth."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from emulators.motion_capture.bodies import Body, OnFloor
from emulators.motion_capture.exposure import Cameras, Up
from emulators.motion_capture.system import DATA, DEFAULT, MotionCapture
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.settings.capture import CaptureBody, CaptureDriver
from firmware_bridge.wire.natnet.layout import Version
from fmu.plant import FmuPlant

CAPTURE_STREAM: Final = 3
"""Which stream of random numbers the capture systems draw from, beside the run's seed."""
TRUTH: Final = ("x", "y", "heading")
"""The plant's outputs that a body on a floor is seen by."""
NAME: Final = "robot"
"""Of a body that the robot file knows by its number."""


def systems_of(
    robot: AnyRobot,
    plant: FmuPlant,
    seed: int,
    *,
    version: Version = DEFAULT,
    data_link: str = DATA,
    markers: bool = True,
) -> Mapping[str, MotionCapture]:
    """Return the capture systems by the links' names; RobotFileError where the plant has no place.

    The body is where the robot is, its axes those of the robot: what the robot file says of a mount is not
    emulated. So it is refused where it is not zero. With `markers` the stream has the bodies' markers, too.
    """
    found: dict[str, MotionCapture] = {}
    for number, (name, link) in enumerate(robot.capture_links.items()):
        _possible(robot, name, link.driver, plant)
        seen = [
            sensor.settings
            for sensor in robot.sensors
            if sensor.link == name and isinstance(sensor.settings, CaptureBody)
        ]
        truth = OnFloor(plant, plant.output_names)
        bodies = [
            Body(body, NAME, truth) if isinstance(body, int) else Body(place, body, truth)
            for place, body in enumerate(dict.fromkeys(one.body for one in seen), 1)
        ]
        found[name] = MotionCapture(
            bodies,
            np.random.default_rng([seed, CAPTURE_STREAM, number]),
            version=version,
            cameras=Cameras(up=Up(seen[0].up.value), markers=markers),
            data_link=data_link,
        )
    return found


def _possible(robot: AnyRobot, name: str, driver: CaptureDriver, plant: FmuPlant) -> None:
    if driver is not CaptureDriver.NATNET:
        raise RobotFileError(robot.name, Problem(f"links.{name}.driver", f"'{driver}' is not emulated"))
    lacks = [output for output in TRUTH if output not in plant.output_names]
    if lacks:
        problem = f"a captured body needs the plant's outputs {', '.join(lacks)}"
        raise RobotFileError(robot.name, Problem("plant.fmu", problem))
    for index, sensor in enumerate(robot.sensors):
        if (
            isinstance(sensor.settings, CaptureBody)
            and sensor.settings.mount != type(sensor.settings.mount)()
        ):
            problem = "the emulated body sits on the robot's reference point; leave mount out"
            raise RobotFileError(robot.name, Problem(f"sensors[{index}].settings.mount", problem))
