"""EPOS2 drives for a dissector: their objects, their set-up by a robot file, and maxon's serial protocols."""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen_drive.driver.setup import MODE
from firmware_bridge.dissector.dictionary import Dictionary
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.dissector.protocols import Protocols, in_bytes
from firmware_bridge.families.epos2.commissioning.words import WORDS
from firmware_bridge.families.epos2.dissector import MaxonCommands, MaxonLine
from firmware_bridge.families.epos2.driver.product import configuration
from firmware_bridge.families.epos2.maxon.packets import MAXON
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.families.epos2.wire import hardware
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.families.epos2.wire.objects_pdo import PDOS
from firmware_bridge.node import SERIAL
from firmware_bridge.robot import AnyRobot

DICTIONARY: Final = Dictionary(hardware.MAXON, ANY_TYPE, PDOS, WORDS)
PROTOCOLS: Final = {
    SERIAL: Protocols(MaxonLine),
    MAXON: Protocols(MaxonCommands, lambda packet: f"{packet.address:02X}#{in_bytes(packet)}"),
}


def expected(robot: AnyRobot, link: str) -> Iterator[Expected]:
    """Yield the drives of a link, with what the bridge writes to each."""
    settings = Epos2Link.of_link(robot, link)
    for axis in robot.axes_on(link):
        rows = [(row.address, row.raw) for row in configuration(axis, settings)]
        rows.append((od.MODE, int(MODE[axis.command]).to_bytes(1, "little", signed=True)))
        yield Expected(Epos2Axis.of(axis).node, axis.title, tuple(rows), DICTIONARY)
