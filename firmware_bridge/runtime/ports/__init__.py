"""Ports: where packets leave this process. CAN by python-can, datagrams by UDP, bytes by serial lines."""

from firmware_bridge.runtime.ports.can import open_can
from firmware_bridge.runtime.ports.port import LostPort, Port, PortError
from firmware_bridge.runtime.ports.pseudo_terminal import PseudoTerminal
from firmware_bridge.runtime.ports.returning_line import ReturningLine
from firmware_bridge.runtime.ports.seen_opening import SeenOpening
from firmware_bridge.runtime.ports.serial_line import SerialLine
from firmware_bridge.runtime.ports.udp import UdpPort

__all__ = [
    "LostPort",
    "Port",
    "PortError",
    "PseudoTerminal",
    "ReturningLine",
    "SeenOpening",
    "SerialLine",
    "UdpPort",
    "open_can",
]
