"""`epos2 scan`: who answers on a bus, or behind a serial line."""

import json
from typing import Annotated, Any, Final

import typer

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, INTERRUPTED, refusal, say
from firmware_bridge.cli.node_numbers import listed, numbers
from firmware_bridge.families.epos2.commands.drive_options import JsonOption
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.scan import (
    HARDWARE,
    SERIAL_NUMBER,
    SOFTWARE,
    TIMEOUT,
    Scan,
    ScannedNode,
)
from firmware_bridge.families.epos2.wire.hardware import type_of
from firmware_bridge.units import MILLISECOND, from_seconds

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 scan -i socketcan -c can0`

`firmware-bridge epos2 scan --node 1-8 --timeout 200 -i slcan -c /dev/ttyACM0`

`firmware-bridge epos2 scan --node 1-4 --serial /dev/ttyUSB0` queries the drive there, and those behind it."""

_HEADINGS: Final = ("node", "device", "version", "serial number", "network", "state")
_GAP: Final = 2
"""Blanks between two columns."""
_SILENCE: Final = "are they on, on this bus, at this bit rate (-b)? In Stopped they are silent, too"


@command(EXAMPLES)
@one_drive(None)
def scan(
    drive: OneDrive,
    *,
    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Nodes to query: 1, or 1-8, or 1,3,5-7.")
    ] = "1-127",
    timeout: Annotated[
        float,
        typer.Option(
            min=1.0,
            max=10_000.0,
            metavar="MS",
            help="Timeout of an answer on the CAN bus. On a line the drive decides.",
        ),
    ] = TIMEOUT / MILLISECOND,
    listen: Annotated[
        float,
        typer.Option(
            min=0.0, max=60.0, metavar="SECONDS", help="Listen for heartbeats on the CAN bus first."
        ),
    ] = 1.0,
    as_json: JsonOption = False,
) -> None:
    """List the nodes on a CAN bus, or behind a serial line: device, versions, serial number, states.

    Nothing is written. Each node's identity is read by SDO, one after the other, so a bus without any takes
    127 timeouts, 7 s; a serial line waits as long as its drive does for each node that is not there. Beside a
    master with an SDO transfer to the same node at that moment, either may get the other's answer. Exit
    status 1 where no node answers.
    """
    nodes = numbers(node)
    if isinstance(drive.link, CanAccess):
        drive.link.requests_once(from_seconds(timeout / 1000.0))
    found = Scan(drive.link, nodes, from_seconds(listen))
    client = drive.converse(found.script(), overhear=found.overhear)
    say(json.dumps(_record(found), indent=2) if as_json else _text(found))
    if not client.finished:
        raise refusal("interrupted; not all nodes were queried", INTERRUPTED)
    if not any(each.answers for each in found.found):
        raise refusal(f"no one answers on {drive.where}: {_SILENCE}", FAILED)


def _text(scan: Scan) -> str:
    rows = [_HEADINGS, *(_row(found) for found in scan.found)]
    widths = [max(map(len, column)) + _GAP for column in zip(*rows, strict=True)]
    table = ["".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)) for row in rows]
    lines = [line.rstrip() for line in table] if scan.found else []
    return "\n".join([*lines, f"silent: {listed(scan.silent) or 'none'}"])


def _row(found: ScannedNode) -> tuple[str, ...]:
    network = " or ".join(each.title for each in found.network) or "unknown"
    if not found.answers:
        return (f"{found.node}", "received, does not answer", "-", "-", network, "-")
    return (f"{found.node}", _device(found), _version(found), _serial_number(found), network, _state(found))


def _device(found: ScannedNode) -> str:
    """Return the device's maker and type, as it reports them."""
    name, product, vendor = (found.value(one) for one in (od.DEVICE_NAME, od.PRODUCT_CODE, od.VENDOR_ID))
    known = type_of(product) if found.maxon and isinstance(product, int) else None
    if known is not None:
        return known
    maker = "of an unknown maker" if vendor is None else f"of vendor 0x{vendor:08X}"
    kind = {None: "", 0: ", no device profile"}.get(found.profile, f", profile {found.profile}")
    return f"'{name or 'no name'}' {'of maxon' if found.maxon else maker}{kind}"


def _version(found: ScannedNode) -> str:
    if found.maxon:
        return f"software {_hex(found, SOFTWARE, 4)}, hardware {_hex(found, HARDWARE, 4)}"
    return f"revision {_hex(found, od.REVISION, 8)}"


def _serial_number(found: ScannedNode) -> str:
    return _hex(found, SERIAL_NUMBER, 1) if found.maxon else _hex(found, od.SERIAL_NUMBER, 1)


def _hex(found: ScannedNode, address: Address, digits: int) -> str:
    """Return a number as maxon prints it, in hexadecimal digits."""
    value = found.number(address)
    return "-" if value is None else f"0x{value:0{digits}X}"


def _state(found: ScannedNode) -> str:
    if found.number(od.STATUSWORD) is None:
        return "-"
    return "no state of a drive" if found.state is None else found.state.title


def _record(scan: Scan) -> dict[str, Any]:
    return {
        "nodes": [
            {
                "node": found.node,
                "answers": found.answers,
                "device": _device(found) if found.answers else None,
                "device_type": found.value(od.DEVICE_TYPE),
                "vendor": found.value(od.VENDOR_ID),
                "product_code": found.value(od.PRODUCT_CODE),
                "revision": found.value(od.REVISION),
                "software": found.value(SOFTWARE),
                "hardware": found.value(HARDWARE),
                "serial_number": found.value(SERIAL_NUMBER if found.maxon else od.SERIAL_NUMBER),
                "network": [each.title for each in found.network],
                "network_heard": found.received is not None,
                "state": None if found.state is None else found.state.title,
                "statusword": found.value(od.STATUSWORD),
            }
            for found in scan.found
        ],
        "silent": list(scan.silent),
    }
