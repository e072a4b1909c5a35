"""Chooses who reads a packet, by the kind of its link, and writes one carried packet as a line.

A dissector follows what goes by, as a protocol analyser does: it is given every packet of a link in order.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Protocol

from firmware_bridge.dissector.boards import Ar2Line, ArduinoIoLine, FirmataLine, MwLine, RosLine
from firmware_bridge.dissector.canopen import Canopen
from firmware_bridge.dissector.mavlink import Mavlink
from firmware_bridge.dissector.maxon import MaxonCommands, MaxonLine
from firmware_bridge.dissector.natnet import NatNet
from firmware_bridge.node import CAN, MAXON, OPERATOR, SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.recording import candump_frame
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.settings.ar2 import Ar2Firmware, Ar2Link
from firmware_bridge.robot.settings.capture import CaptureDriver, CaptureLink
from firmware_bridge.robot.settings.epos2 import Epos2Driver, Epos2Link
from firmware_bridge.robot.settings.shield import ShieldLink, ShieldProtocol
from firmware_bridge.units import SECOND, Nanoseconds

SHOWN: Final = 16
"""So many bytes of a packet without an identifier stand before its text."""


class Reader(Protocol):
    """A reader of one link's packets, one after the other."""

    def read(self, sender: str, packet: Packet) -> str:
        """Return the decoded text of a packet; every packet has one."""


@dataclass(frozen=True, slots=True)
class Protocols:
    """Protocol of a kind of link: the format of its packets, and their reader."""

    written: Callable[[Packet], str]
    reader: Callable[[], Reader]


def _bytes(packet: Packet) -> str:
    payload = packet.payload
    return payload[:SHOWN].hex().upper() + (f"... ({len(payload)} bytes)" if len(payload) > SHOWN else "")


KINDS: Final[Mapping[str, Protocols]] = MappingProxyType(
    {
        CAN: Protocols(candump_frame, Canopen),
        OPERATOR: Protocols(_bytes, Mavlink),
        SERIAL: Protocols(_bytes, MaxonLine),
        MAXON: Protocols(lambda packet: f"{packet.address:02X}#{_bytes(packet)}", MaxonCommands),
        ShieldProtocol.MW: Protocols(_bytes, MwLine),
        ShieldProtocol.ROS_ARDUINO_BRIDGE: Protocols(_bytes, RosLine),
        ShieldProtocol.ARDUINOIO: Protocols(_bytes, ArduinoIoLine),
        ShieldProtocol.FIRMATA: Protocols(_bytes, FirmataLine),
        Ar2Firmware.AR2_2_0: Protocols(_bytes, Ar2Line),
        CaptureDriver.NATNET: Protocols(_bytes, NatNet),
        CaptureDriver.MAVLINK: Protocols(_bytes, Mavlink),
    }
)
"""The kinds of links; the protocols of boards and cameras are kinds by their names in robot files."""


def kinds_of(robot: AnyRobot) -> dict[str, str]:
    """Return the kind of each of a robot's links, by its name, as it is on the wire."""
    drives = {Epos2Driver.CAN: CAN, Epos2Driver.SERIAL: SERIAL}
    return {
        **{name: drives[link.driver] for name, link in Epos2Link.all_of(robot).items()},
        **{name: link.protocol for name, link in (ShieldLink.all_of(robot) | Ar2Link.all_of(robot)).items()},
        **{name: link.driver for name, link in CaptureLink.all_of(robot).items()},
    }


class _Unread:
    """A reader for a link of unknown protocol."""

    def read(self, _sender: str, _packet: Packet) -> str:
        """Return the note that it is unknown."""
        return "on a link of unknown kind"


_UNKNOWN: Final = Protocols(_bytes, _Unread)


@dataclass(frozen=True, slots=True)
class Carried:
    """A packet that a link has carried, wholly arrived at `at`, in nanoseconds from the start of the run."""

    at: Nanoseconds
    link: str
    sender: str
    packet: Packet


def _one_line(text: str) -> str:
    """Return a text without what would break its line, or command a terminal: it may be a third party's."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else repr(one)[1:-1] for one in text)


class Dissector:
    """A dissector of several links' packets; `kinds` gives a link's kind where it is not its name."""

    def __init__(self, kinds: Mapping[str, str] = MappingProxyType({})) -> None:
        self._kinds = kinds
        self._readers: dict[str, Reader] = {}

    def read(self, carried: Carried) -> str:
        """Return a carried packet as a line: when, where, who, the bytes, and what they say."""
        link, packet = carried.link, carried.packet
        protocols = KINDS.get(self._kinds.get(link, link), _UNKNOWN)
        reader = self._readers.get(link)
        if reader is None:
            reader = self._readers[link] = protocols.reader()
        seconds, rest = divmod(carried.at, SECOND)
        line = _one_line(reader.read(carried.sender, packet))
        return f"{seconds}.{rest:09d} s  {link}  {carried.sender}  {protocols.written(packet)}  {line}"
