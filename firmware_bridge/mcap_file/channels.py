"""Channels of a recording: their topics, and the names of their schemas."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from firmware_bridge.robot import AnyRobot

FRAMES: Final = "/can/frames"
SERIAL: Final = "/serial"
DATAGRAMS: Final = "/datagrams"
POSE: Final = "/robot/pose"
ODOMETRY: Final = "/robot/odometry"
JOINTS: Final = "/robot/joints"
LOG: Final = "/log"
EVENTS: Final = "/events"

OWN: Final[Mapping[str, str]] = MappingProxyType(
    {FRAMES: "CanFrame", SERIAL: "SerialChunk", DATAGRAMS: "Datagram", EVENTS: "Event"}
)
"""Messages of `recording.proto`."""
DRIVE_STATE: Final = "DriveState"
"""The message of each drive's channel."""
FOXGLOVE: Final[Mapping[str, str]] = MappingProxyType(
    {POSE: "PoseInFrame", ODOMETRY: "PoseInFrame", JOINTS: "JointStates", LOG: "Log"}
)
"""Messages of Foxglove's."""

LIBRARY: Final = "firmware-bridge"
"""Writer of the file, in its header; without a version, so that one run has one checksum."""
FORMAT: Final = "1"
"""In the metadata `recording`: it grows when a channel or a key gets another meaning."""
SUFFIX: Final = ".mcap"


def drive_topics(robot: "AnyRobot") -> dict[str, str]:
    """Return the topic of each axis' drive, by the axis' name.

    It has the number of the drive, behind the link where two links have one of this number.
    """
    numbers = [axis.settings.number for axis in robot.axes]
    return {
        axis.name: f"/drive/{axis.settings.number}/state"
        if numbers.count(axis.settings.number) == 1
        else f"/drive/{axis.link}/{axis.settings.number}/state"
        for axis in robot.axes
    }
