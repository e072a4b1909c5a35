"""The bridge alone: on each of its links it hears what everybody else was recorded to have said there.

The bench's own recordings begin with the run. In one of a real robot the bridge was switched on as long before
its first word to a device as a bridge that hears nothing takes for it. A bus carries both ways in one. To a
line the bridge speaks through the wire that was there, and what it has heard comes at its recorded instant.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Final

from emulators.line import line_of
from emulators.replay.comparison import Comparison, Frames, Messages
from emulators.replay.files import Files, files_of
from emulators.replay.order import Order
from emulators.replay.player import Player
from emulators.replay.recordings import Entry, Recording, RecordingFileError, read_can, read_lines, read_telemetry
from emulators.replay.senders import BRIDGE, OPERATOR_STATION, Sent, chunks_of, frames_of, messages_of
from emulators.replay.stage import (
    RECORDING,
    Stage,
    begin_of,
    call_at,
    end_of,
    first_of,
    not_after,
    script_of,
    to_compare,
)
from emulators.wires import CanWire, DatagramWire, SerialWire
from emulators.world import Wire, World
from firmware_bridge.bridge import Bridge
from firmware_bridge.dissector import kinds_of
from firmware_bridge.dissector.canopen import service_name
from firmware_bridge.kinds import kind_of
from firmware_bridge.node import CAN, OPERATOR, Node
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.settings.capture import CaptureDriver
from firmware_bridge.robot.settings.epos2 import Epos2Driver
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import SECOND, Nanoseconds

UNHEARD: Final[Nanoseconds] = 60 * SECOND
"""A bridge that says nothing for so long says nothing."""
