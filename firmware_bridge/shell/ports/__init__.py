"""Ports: where packets leave this process. CAN over every interface of python-can, datagrams over UDP."""

from firmware_bridge.shell.ports.can import open_can
from firmware_bridge.shell.ports.port import LostPort, Port, PortError
from firmware_bridge.shell.ports.udp import UdpPort

__all__ = ["LostPort", "Port", "PortError", "UdpPort", "open_can"]
