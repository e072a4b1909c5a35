"""Electronic data sheet (EDS) of an emulated type, and device configuration file (DCF) of one drive.

Source of the format: CiA 306. Its words are our own: nothing is taken from maxon's files. Defaults that are
only assumed are left out, and so are serial numbers. A configuration file is there to be loaded into a
drive: it has the values of the parameters and of what can only be read, and none of commands, set values
and signatures.
"""

from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Final

from emulators.epos2.documents.object_table import ObjectEntry, entries
from emulators.epos2.objects.device_profile import BIT_RATES, SERIAL_NUMBER_64, DeviceProfile
from emulators.epos2.objects.parameters import is_parameter
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import COB_ID_MASK
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.object_row import Provenance

VAR: Final = 0x7
ARRAY: Final = 0x8
RECORD: Final = 0x9
MANDATORY: Final = (0x1000, 0x1001, 0x1018)
MANUFACTURER: Final = range(0x2000, 0x6000)
RATES_OF_THE_FORMAT: Final = (10, 20, 50, 125, 250, 500, 800, 1000)
DATE: Final = ("12:00AM", "01-01-2026")
"""The same in every file: a data sheet is made of the table, not at a time."""
_INDIVIDUAL: Final = frozenset({od.SERIAL_NUMBER, SERIAL_NUMBER_64, Address(0x2FFF, 5), Address(0x2FFF, 6)})
_PARENTS: Final = {0x1003: "Error History"}

Values = Mapping[Address, int | bytes]


def eds(profile: DeviceProfile, file_name: str = "epos2.eds") -> str:
    """Return the data sheet of a type."""
    return "\n".join(_file(profile, file_name, None, {}))


def dcf(
    profile: DeviceProfile, node: int, bit_rate: int, values: Values, file_name: str = "epos2.dcf"
) -> str:
    """Return the configuration file of a drive: its data sheet with the values that it has now."""
    return "\n".join(_file(profile, file_name, (node, bit_rate), values))


def _file(profile: DeviceProfile, name: str, drive: tuple[int, int] | None, values: Values) -> Iterator[str]:
    yield from _section("FileInfo", _file_info(profile, name, drive is not None))
    yield from _section("DeviceInfo", _device_info(profile))
    if drive is not None:
        yield from _section("DeviceComissioning", _commissioning(profile, *drive, values))
    yield from _section("DummyUsage", {f"Dummy{number:04d}": "0" for number in range(1, 8)})
    yield from _section("Comments", _comments(profile))
    table = {index: tuple(group) for index, group in groupby(entries(profile), lambda e: e.row.address.index)}
    for title, indexes in _parts(table):
        listed = {str(place): f"{index:#06x}" for place, index in enumerate(indexes, start=1)}
        yield from _section(title, {"SupportedObjects": str(len(indexes)), **listed})
        for index in indexes:
            yield from _object(index, table[index], values)


def _parts(table: Mapping[int, object]) -> tuple[tuple[str, list[int]], ...]:
    rest = [index for index in table if index not in MANDATORY]
    return (
        ("MandatoryObjects", [index for index in table if index in MANDATORY]),
        ("OptionalObjects", [index for index in rest if index not in MANUFACTURER]),
        ("ManufacturerObjects", [index for index in rest if index in MANUFACTURER]),
    )


def _section(title: str, rows: Mapping[str, str]) -> Iterator[str]:
    yield f"[{title}]"
    yield from (f"{key}={value}" for key, value in rows.items())
    yield ""


def _file_info(profile: DeviceProfile, name: str, is_dcf: bool) -> dict[str, str]:  # noqa: FBT001 - one of two
    time, date = DATE
    return {
        "FileName": name,
        "FileVersion": "1",
        "FileRevision": "0",
        "EDSVersion": "4.0",
        "Description": f"Emulated {profile.name}",
        "CreationTime": time,
        "CreationDate": date,
        "CreatedBy": "firmware-bridge",
        "ModificationTime": time,
        "ModificationDate": date,
        "ModifiedBy": "firmware-bridge",
        **({"LastEDS": "epos2.eds"} if is_dcf else {}),
    }


def _device_info(profile: DeviceProfile) -> dict[str, str]:
    # CiA 306 lists the rates of the format in kbit/s, 1 for those that the device has.
    known = {rate // 1000 for rate in BIT_RATES.values()}
    return {
        "VendorName": "maxon motor ag",
        "VendorNumber": "0x000000FB",
        "ProductName": profile.name,
        "ProductNumber": f"{(profile.hardware_version or 0) << 16 | profile.application_number:#010x}",
        "RevisionNumber": f"{profile.software_version << 16 | profile.application_version:#010x}",
        "OrderCode": profile.order_numbers[0] if profile.order_numbers else "",
        **{f"BaudRate_{rate}": str(int(rate in known)) for rate in RATES_OF_THE_FORMAT},
        "SimpleBootUpMaster": "0",
        "SimpleBootUpSlave": "1",
        "Granularity": "8",
        "DynamicChannelsSupported": "0",
        "GroupMessaging": "0",
        "NrOfRXPDO": "4",
        "NrOfTXPDO": "4",
        "LSS_Supported": "1",
    }


def _commissioning(profile: DeviceProfile, node: int, bit_rate: int, values: Values) -> dict[str, str]:
    serial = values.get(od.SERIAL_NUMBER, 0)
    return {
        "NodeID": str(node),
        "NodeName": f"{profile.name} node {node}",
        "Baudrate": str(bit_rate // 1000),
        "NetNumber": "0",
        "NetworkName": "",
        "CANopenManager": "0",
        "LSS_SerialNumber": f"{serial:#010x}" if isinstance(serial, int) else "0",
    }


def _comments(profile: DeviceProfile) -> dict[str, str]:
    lines = (
        f"{profile.name} as firmware-bridge emulates it; this file is not the maker's.",
        "Type, access, range and default of an object are those of a 70/10 with software 2126h.",
    )
    return {"Lines": str(len(lines)), **{f"Line{place}": line for place, line in enumerate(lines, start=1)}}


def _object(index: int, rows: tuple[ObjectEntry, ...], values: Values) -> Iterator[str]:
    first = rows[0].row
    if len(rows) == 1 and first.address.subindex == 0:
        yield from _section(f"{index:04X}", {"ParameterName": first.name, **_variable(rows[0], values)})
        return
    yield from _section(
        f"{index:04X}",
        {
            "ParameterName": _parent(index, first.name),
            "ObjectType": f"{_kind(rows):#x}",
            "SubNumber": str(len(rows)),
        },
    )
    for entry in rows:
        title = f"{index:04X}sub{entry.row.address.subindex:X}"
        yield from _section(title, {"ParameterName": entry.row.name, **_variable(entry, values)})


def _parent(index: int, name: str) -> str:
    known = _PARENTS.get(index)
    if known is not None:
        return known
    return name.split(": ", maxsplit=1)[0].replace("Number of Objects Mapped in", "Mapping of")


def _kind(rows: tuple[ObjectEntry, ...]) -> int:
    """Distinguish an array, whose entries are alike and without gaps, from a record."""
    members = rows[1:]
    alike = len({entry.row.type for entry in members}) == 1
    whole = [entry.row.address.subindex for entry in members] == list(range(1, len(members) + 1))
    return ARRAY if alike and whole and rows[0].row.address.index in _ARRAYS else RECORD


_ARRAYS: Final = frozenset({0x1003, 0x1010, 0x1016, 0x2015, 0x2016, 0x200C})


def _variable(entry: ObjectEntry, values: Values) -> dict[str, str]:
    row = entry.row
    made = {
        "ObjectType": f"{VAR:#x}",
        "DataType": f"{row.type.code:#06x}",
        "AccessType": row.access.value,
    }
    if entry.low is not None:
        made["LowLimit"] = str(entry.low)
    if entry.high is not None:
        made["HighLimit"] = str(entry.high)
    if row.default_provenance is not Provenance.ASSUMED and row.address not in _INDIVIDUAL:
        made["DefaultValue"] = _default(entry)
    value = values.get(row.address)
    if (
        value is not None
        and row.type is not DataType.DOMAIN
        and (is_parameter(row) or not row.access.writable)
    ):
        made["ParameterValue"] = value.decode("ascii", "replace") if isinstance(value, bytes) else str(value)
    made["PDOMapping"] = str(int(row.mappable))
    return made


def _default(entry: ObjectEntry) -> str:
    if isinstance(entry.default, bytes):
        return entry.default.decode("ascii")
    row = entry.row
    if row.node_added and isinstance(row.default, int):
        return f"$NODEID+{row.default:#x}"
    # COB-IDs and identities are read as hexadecimal numbers, small values as decimal ones.
    wide = row.type is DataType.UNSIGNED32 and entry.default > COB_ID_MASK
    return f"{entry.default:#010x}" if wide else str(entry.default)
