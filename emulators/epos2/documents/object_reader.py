"""Reader of every object of a running drive over its bus, one SDO transfer after the other.

It works with a real drive as well.
"""

from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import JobClient
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.families.epos2.wire.differences import objects_of
from firmware_bridge.node import CAN
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import Port
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import MILLISECOND, Nanoseconds

TIMEOUT: Final[Nanoseconds] = 500 * MILLISECOND


class SilentNodeError(Exception):
    """The node does not answer."""


def read_all(port: Port, node: int) -> dict[Address, int | bytes]:
    """Return the value of every object that can be read, and close the port; what is refused is left out.

    SilentNodeError where the node does not answer; LostPort; KeyboardInterrupt.
    """
    rows = {
        address: row.type
        for address, row in objects_of().items()
        if row.access.readable and row.type is not DataType.DOMAIN
    }
    reading = Reading(tuple(rows))
    client = JobClient(CanAccess(node, TIMEOUT), reading.once())
    run(client, {CAN: port}, Clock())
    if client.failure is not None:
        raise SilentNodeError(f"node {node} on {port.name} does not answer: {client.failure}")
    if not client.finished:
        raise KeyboardInterrupt
    return {
        address: kind.decode(raw) if kind.size else raw
        for address, kind in rows.items()
        if isinstance(raw := reading.found[address], bytes)
    }
