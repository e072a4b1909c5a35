"""Reads every object of a running drive over its bus, one SDO transfer after the other.

It works with a real drive as well.
"""

from typing import Final

from firmware_bridge.drivers.sdo_client import SdoClient, SdoError, SdoTimeoutError, Transfer
from firmware_bridge.shell.clock import Clock
from firmware_bridge.shell.ports import Port
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.objects import OBJECTS
from firmware_bridge.wire.epos2.rows import DataType

TIMEOUT: Final[Nanoseconds] = 500 * MILLISECOND


class SilentNodeError(Exception):
    """The node does not answer."""


def read_all(port: Port, node: int) -> dict[Address, int | bytes]:
    """Return the value of every object that can be read; what the drive refuses is left out.

    SilentNodeError where it does not answer; LostPort.
    """
    clock = Clock()
    values: dict[Address, int | bytes] = {}
    for address, row in OBJECTS.items():
        if not row.access.readable or row.type is DataType.DOMAIN:
            continue
        outcome = _read(port, clock, node, address)
        if isinstance(outcome, SdoTimeoutError):
            raise SilentNodeError(f"node {node} on {port.name} does not answer: {outcome}")
        if isinstance(outcome, bytes):
            values[address] = row.type.decode(outcome) if row.type.size else outcome
    return values


def _read(port: Port, clock: Clock, node: int, address: Address) -> bytes | SdoError | None:
    client = SdoClient(TIMEOUT)
    _send(port, clock, node, client.start(Transfer(address), clock.now()))
    while client.busy:
        clock.wait([port.fileno()], min(client.wake_at, port.retry_at))
        now = clock.now()
        if now >= port.retry_at:
            port.flush(now)
        for heard, payload in port.read(now):
            if heard == canopen.SDO_RESPONSE + node:
                _send(port, clock, node, client.hear(payload, now))
        _send(port, clock, node, client.wake(now))
    return client.take()


def _send(port: Port, clock: Clock, node: int, payloads: tuple[bytes, ...]) -> None:
    for payload in payloads:
        port.write(canopen.SDO_REQUEST + node, payload, clock.now())
