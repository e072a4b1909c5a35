"""Wires of the virtual world: a CAN bus, a serial line, a datagram link, each in its own exact time."""

from emulators.wires.can import CanWire
from emulators.wires.datagram import DatagramWire
from emulators.wires.ends import Observer
from emulators.wires.serial import Inbox, SerialWire
from emulators.wires.usb import usb_line

__all__ = ["CanWire", "DatagramWire", "Inbox", "Observer", "SerialWire", "usb_line"]
