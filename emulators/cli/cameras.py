"""Capture systems of a robot file, beside its other emulated devices, at the addresses in the file."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from emulators.family import Devices
from emulators.gateway import Cluster
from emulators.motion_capture.family import station_of
from emulators.motion_capture.system import COMMAND, DATA, MotionCapture
from emulators.world import Physics
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.families.motion_capture.wire.messages import DATA_PORT
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.runtime.ports import Port, UdpPort
from firmware_bridge.wire.internet import place_of


@dataclass(frozen=True, slots=True)
class Cameras:
    """Capture systems as members of a cluster: their nodes, what their links are called, what opens those."""

    members: dict[str, MotionCapture]
    links: dict[str, dict[str, str]]
    openers: dict[str, Callable[[], Port]]
    where: tuple[str, ...]
    """Description of each system's addresses."""
    physics: Physics
    """The robot's physics, which the cameras film."""


def beside_boards(boards: Mapping[str, Node], links: Mapping[str, str], cameras: Cameras) -> Node:
    """Return boards and the cameras around what they drive, as one node; `links` are the boards' outside."""
    if len(boards) == 1 and not cameras.members:
        return next(iter(boards.values()))
    members: dict[str, Node] = {**boards, **cameras.members}
    lines = {name: {SERIAL: link} for name, link in links.items()}
    return Cluster(members, cameras.physics, links={**lines, **cameras.links})


def cameras_of(robot: AnyRobot, below: Devices) -> Cameras:
    """Return those that see a robot. Each listens at its link's `server`."""
    links, systems = CaptureLink.all_of(robot), below.nodes(MotionCapture)
    where = tuple(f"{link.server} ({name})" for name, link in links.items())
    cameras = Cameras({}, {}, {}, where, below.physics)
    for name, link in links.items():
        command, data = f"{name} commands", f"{name} frames"
        host, _, _ = place_of(link.server_number).rpartition(":")
        cameras.members[station_of(name)] = systems[station_of(name)]
        cameras.links[station_of(name)] = {COMMAND: command, DATA: data}
        cameras.openers[command] = partial(UdpPort, f"udpin:{link.server}")
        cameras.openers[data] = partial(UdpPort, f"udpin:{host}:{DATA_PORT}")
    return cameras
