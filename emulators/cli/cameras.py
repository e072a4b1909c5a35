"""The capture systems of a robot file, beside its other emulated devices, where the file says they are."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from emulators.arduino_omni.board import Board
from emulators.captured import systems_of
from emulators.gateway import Cluster
from emulators.motion_capture.system import COMMAND, DATA, MotionCapture
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.shell.ports import Port, UdpPort
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.internet import place_of
from firmware_bridge.wire.natnet.messages import DATA_PORT
from fmu.plant import FmuPlant


@dataclass(frozen=True, slots=True)
class Cameras:
    """Capture systems as members of a cluster: their nodes, what their links are called, what opens those."""

    members: dict[str, MotionCapture]
    links: dict[str, dict[str, str]]
    openers: dict[str, Callable[[], Port]]
    where: tuple[str, ...]
    """In words."""


class _Turning:
    """A board's motors as the physics of a cluster: cameras see them where they are now."""

    def __init__(self, board: Board) -> None:
        self._board: Final = board

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on; a board wakes by itself."""
        self._board.advance(until)
        return until, ()


def beside_board(name: str, board: Board, cameras: Cameras) -> Node:
    """Return a board on the link "serial" and the cameras around what it drives, as one node."""
    if not cameras.members:
        return board
    members: dict[str, Node] = {name: board, **cameras.members}
    return Cluster(members, _Turning(board), links={name: {SERIAL: SERIAL}, **cameras.links})


def cameras_of(robot: AnyRobot, plant: FmuPlant, seed: int = 0) -> Cameras:
    """Return those that see this plant; RobotFileError. Each listens at its link's `server`."""
    cameras = Cameras(
        {}, {}, {}, tuple(f"{link.server} ({name})" for name, link in robot.capture_links.items())
    )
    for name, system in systems_of(robot, plant, seed).items():
        link = robot.capture_links[name]
        command, data = f"{name} commands", f"{name} frames"
        host, _, _ = place_of(link.server_number).rpartition(":")
        cameras.members[f"cameras of {name}"] = system
        cameras.links[f"cameras of {name}"] = {COMMAND: command, DATA: data}
        cameras.openers[command] = partial(UdpPort, f"udpin:{link.server}")
        cameras.openers[data] = partial(UdpPort, f"udpin:{host}:{DATA_PORT}")
    return cameras
