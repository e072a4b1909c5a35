"""CiA 402 drives of any maker for a dissector: their objects, and their set-up by a robot file."""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import STATES, Mode
from firmware_bridge.canopen.drive_words import BIT_12, BIT_13, BITS, DriveWords
from firmware_bridge.canopen_drive.driver.setup import MODE
from firmware_bridge.dissector.dictionary import Dictionary
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.families.cia402.driver.product import configuration
from firmware_bridge.families.cia402.settings import Cia402Axis
from firmware_bridge.families.cia402.wire.causes import CAUSES
from firmware_bridge.families.cia402.wire.objects import PDOS, objects_of
from firmware_bridge.robot import AnyRobot

ONE_COUNT: Final = 1
"""Edges of an encoder of which nothing is known."""
DICTIONARY: Final = Dictionary(
    None,
    objects_of(ONE_COUNT),
    PDOS,
    DriveWords(
        states=STATES,
        modes=Mode,
        no_mode="no mode of CiA 402",
        bits=BITS,
        bit_12=BIT_12,
        bit_13=BIT_13,
        causes=CAUSES,
    ),
)


def expected(robot: AnyRobot, link: str) -> Iterator[Expected]:
    """Yield the drives of a link, with what the bridge writes to each."""
    for axis in robot.axes_on(link):
        rows = [(row.address, row.raw) for row in configuration(axis, robot) if not row.awaited]
        rows.append((od.MODE, int(MODE[axis.command]).to_bytes(1, "little", signed=True)))
        yield Expected(Cia402Axis.of(axis).node, axis.title, tuple(rows), DICTIONARY)
