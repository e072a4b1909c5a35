"""`epos2 version`: which drive it is."""

import json
from typing import Any, Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import say
from firmware_bridge.families.epos2.commands.drive_options import JsonOption
from firmware_bridge.families.epos2.commands.object_text import object_record, value_text
from firmware_bridge.families.epos2.commands.one_drive import OneDrive, one_drive
from firmware_bridge.families.epos2.commissioning.names import name_of
from firmware_bridge.families.epos2.commissioning.overview import IDENTITY
from firmware_bridge.families.epos2.commissioning.reading import Reading

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 version -i socketcan -c can0 --node 3`

`firmware-bridge epos2 version --serial /dev/ttyUSB0 --protocol v2`"""


@command(EXAMPLES)
@one_drive()
def version(drive: OneDrive, *, as_json: JsonOption = False) -> None:
    """Show a drive's name, hardware, firmware and serial number."""
    reading = Reading(IDENTITY)
    drive.finish(reading.once())
    if as_json:
        found: dict[str, Any] = {"node": drive.node}
        found["objects"] = [object_record(reading, address) for address in reading.addresses]
        say(json.dumps(found, indent=2))
        return
    for address in IDENTITY:
        say(f"{name_of(address):<26}  {_text_of(reading, address)}")


def _text_of(reading: Reading, address: Address) -> str:
    """Return a version or a number as maxon prints them, in hexadecimal digits."""
    value = reading.value(address)
    return f"0x{value:04X}" if isinstance(value, int) else value_text(reading, address)
