"""Wires of the virtual world: a CAN bus, a serial line, a datagram link, each in its own exact time."""

from emulators.wires.can import CanWire
from emulators.wires.datagram import DatagramWire, Impairment
from emulators.wires.disturbance import Disturbance, Effect
from emulators.wires.ends import Observer
from emulators.wires.faulty_can import FaultyCanWire
from emulators.wires.played import PlayedLine
from emulators.wires.serial import Inbox, SerialWire
from emulators.wires.usb import usb_line

__all__ = [
    "CanWire",
    "DatagramWire",
    "Disturbance",
    "Effect",
    "FaultyCanWire",
    "Impairment",
    "Inbox",
    "Observer",
    "PlayedLine",
    "SerialWire",
    "usb_line",
]
