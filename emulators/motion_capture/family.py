"""Motion capture as a family of emulated devices: for each link to a system, a body on the plant's truth."""

from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from emulators.family import Beside, BuildOrder, Devices, EmulatedFamily, Observed, Station, Way
from emulators.motion_capture.bodies import TrackedBody
from emulators.motion_capture.exposure import Cameras, Up
from emulators.motion_capture.film import FLOOR, SPACE, Film, Physics
from emulators.motion_capture.system import COMMAND, DATA, MotionCapture, Timing
from emulators.servo.fmu_axes import PlantNeeds
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureDriver, CaptureLink
from firmware_bridge.families.motion_capture.wire.messages import DATA_PORT
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.wire.internet import place_of
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from emulators.bench.faults.kind import FaultKind

CAPTURE_STREAM: Final = 3
"""Stream of random numbers for the capture systems, beside the run's seed."""
TRUTH: Final = tuple(dict.fromkeys(FLOOR + SPACE))
"""The plant's outputs that a body is seen by; `FLOOR` or `SPACE` will do."""
NAME: Final = "robot"
"""Name of a body that the robot file knows by its number."""


def station_of(link: str) -> str:
    """Return the name of the capture system on a link as a station."""
    return f"cameras of {link}"


def _observe(order: BuildOrder, plant: FmuPlant, physics: Physics) -> Observed:
    """Return the capture systems that see a robot; RobotFileError where the plant has no place.

    The body is where the robot is, its axes those of the robot: the mount in the robot file is not emulated.
    So it is refused where it is not zero. On real ports the stream has the bodies' markers, too.
    """
    robot, links = order.robot, CaptureLink.all_of(order.robot)
    for name, link in links.items():
        _possible(robot, name, link.driver, plant)
    timing, stations = Timing(), dict[str, Station]()
    film = Film(physics, plant, plant.output_names, timing.exposed_at)
    for number, name in enumerate(links):
        seen = [
            sensor.settings
            for sensor in robot.sensors
            if sensor.link == name and isinstance(sensor.settings, CaptureBody)
        ]
        bodies = [
            TrackedBody(body, NAME, film) if isinstance(body, int) else TrackedBody(place, body, film)
            for place, body in enumerate(dict.fromkeys(one.body for one in seen), 1)
        ]
        system = MotionCapture(
            bodies,
            # A stream for each system: one more camera link changes no other's noise.
            np.random.default_rng([order.seed, CAPTURE_STREAM, number]),
            cameras=Cameras(up=Up(seen[0].up.value), markers=not order.on_bench),
            timing=timing,
            data_link=COMMAND if order.on_bench else DATA,
        )
        stations[station_of(name)] = Station(system, name, {COMMAND: Way.DATAGRAMS})
    return Observed(stations, film)


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


def _beside(robot: AnyRobot, below: Devices) -> Beside:
    """Return the systems that see a robot, for real ports; each listens at its link's `server`."""
    from firmware_bridge.runtime.ports import UdpPort  # noqa: PLC0415 - the bench has no ports

    systems, links, openers = below.nodes(MotionCapture), {}, {}
    for name, link in CaptureLink.all_of(robot).items():
        command, data = f"{name} commands", f"{name} frames"
        host, _, _ = place_of(link.server_number).rpartition(":")
        links[station_of(name)] = {COMMAND: command, DATA: data}
        openers[command] = partial(UdpPort, f"udpin:{link.server}")
        openers[data] = partial(UdpPort, f"udpin:{host}:{DATA_PORT}")
    where = tuple(f"{link.server} ({name})" for name, link in CaptureLink.all_of(robot).items())
    return Beside({name: systems[name] for name in links}, links, openers, where)


def _faults() -> "tuple[FaultKind, ...]":
    from emulators.motion_capture.fault_rows import (  # noqa: PLC0415 - only who injects faults needs them
        CAPTURE_ROWS,
    )

    return CAPTURE_ROWS


FAMILY: Final = EmulatedFamily(
    links=(CaptureLink,),
    sees=PlantNeeds(optional_outputs=TRUTH),
    observe=_observe,
    datagrams=True,
    faults=_faults,
    beside=_beside,
)
