"""A device from its EDS: its dictionary and CiA 301's services, and a drive where it has a Controlword."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from emulators.cia402.eds_device import DeviceOfEds, is_drive
from emulators.epos2.documents.eds import eds
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.cli import program
from firmware_bridge.runtime.data_sheets import SheetError, objects
from hil_tests.unit.cia402.test_conformance import ENABLED, Bus

IO = """
[1000]
ParameterName=Device type
ObjectType=0x7
DataType=0x0007
AccessType=ro
DefaultValue=0x00030191

[1001]
ParameterName=Error register
DataType=0x0005
AccessType=ro

[1017]
ParameterName=Producer heartbeat time
DataType=0x0006
AccessType=rw
DefaultValue=0

[1018]
ParameterName=Identity
ObjectType=0x9
SubNumber=2

[1018sub0]
ParameterName=Entries
DataType=0x0005
AccessType=const
DefaultValue=1

[1018sub1]
ParameterName=Vendor
DataType=0x0007
AccessType=ro
DefaultValue=0x2C

[2000]
ParameterName=A maker's own
DataType=0x0003
AccessType=rw
DefaultValue=0xFFFE
LowLimit=-5
HighLimit=5

[1400sub1]
ParameterName=COB-ID
DataType=0x0007
AccessType=rw
DefaultValue=$NODEID+0x200
"""
DRIVE = """
[6040]
ParameterName=Controlword
DataType=0x0006
AccessType=rww
PDOMapping=1

[6041]
ParameterName=Statusword
DataType=0x0006
AccessType=ro
PDOMapping=1

[6060]
ParameterName=Modes of operation
DataType=0x0002
AccessType=rww
PDOMapping=1

[60FF]
ParameterName=Target velocity
DataType=0x0004
AccessType=rww
PDOMapping=1

[606C]
ParameterName=Velocity actual value
DataType=0x0004
AccessType=ro
PDOMapping=1
"""


def bus(tmp_path: Path, text: str) -> Bus:
    file = tmp_path / "device.eds"
    file.write_text(text, encoding="latin-1")
    rows = objects(file)
    return Bus(lambda axis: DeviceOfEds(1, rows, axis))


def test_its_objects_are_those_of_the_file_with_types_bounds_and_the_node(tmp_path: Path) -> None:
    one = bus(tmp_path, IO)
    assert one.sent == ["701#00"]
    assert one.read("001000") == 0x0003_0191
    assert one.read("181001") == 0x2C
    assert one.read("001401") == 0x201
    assert one.read("002000") == 0xFFFE
    assert one.write("2B002000", "0500") == "ok"
    assert one.write("2B002000", "0600") == "06090031"
    assert one.write("23001000", "00000000") == "06010002"
    assert one.write("2B406000", "0600") == "06020000"


def test_what_the_servo_works_with_is_not_the_clients(tmp_path: Path) -> None:
    """The drive has no 0x6065: its motion has the servo's, and no client reads it."""
    one = bus(tmp_path, IO + DRIVE)
    assert one.write("40656000") == "06020000"
    assert one.drive.store.get(Address(0x6065)) == 2000
    with pytest.raises(SdoAbort) as caught:
        one.drive.store.row(Address(0x6065))
    assert caught.value.code is AbortCode.NO_OBJECT


def test_a_drive_turns_and_stops(tmp_path: Path) -> None:
    one = bus(tmp_path, IO + DRIVE)
    assert one.write("2F606000", "03") == "ok"
    assert one.command(0x06, 0x07, 0x0F) is ENABLED
    assert one.write("23FF6000", (300).to_bytes(4, "little").hex()) == "ok"
    one.run(500)
    assert abs(one.read("6C6000") - 300) <= 60
    one.command(0x02)
    one.run(1000)
    assert one.axis.step == 0
    assert one.command(0x00) is PowerState.SWITCH_ON_DISABLED


def test_the_eds_that_this_project_writes_makes_a_drive(tmp_path: Path) -> None:
    file = tmp_path / "epos2.eds"
    file.write_text(eds(EPOS2_70_10), encoding="latin-1")
    rows = objects(file)
    assert is_drive(rows)
    one = Bus(lambda axis: DeviceOfEds(1, rows, axis))
    one.write("2F606000", "03")
    assert one.command(0x06, 0x07, 0x0F) is ENABLED


@pytest.mark.parametrize(
    ("text", "stated"),
    [
        ("", "it describes no object; is it an EDS?"),
        ("[1000]\nDataType=7\nAccessType=rx\n", "[1000] AccessType 'rx' is none"),
        ("[1000]\nDataType=7\nAccessType=ro\nDefaultValue=ten\n", "[1000] a number cannot be read"),
        ("no section\n", "cannot be read as a data sheet"),
    ],
)
def test_what_is_no_eds_is_refused_with_its_sections(tmp_path: Path, text: str, stated: str) -> None:
    file = tmp_path / "wrong.eds"
    file.write_text(text, encoding="latin-1")
    with pytest.raises(SheetError, match=r"wrong\.eds") as caught:
        objects(file)
    assert stated in str(caught.value)


def test_the_command_refuses_a_file_that_is_not_there() -> None:
    done = CliRunner().invoke(program, ["emulate", "canopen", "--eds", "none.eds", "-i", "virtual"])
    assert done.exit_code
    assert "none.eds" in done.output


def test_an_axis_of_no_drive_stays_where_it_is(tmp_path: Path) -> None:
    file = tmp_path / "io.eds"
    file.write_text(IO, encoding="latin-1")
    assert not is_drive(objects(file))
    axis = ServoAxis("a", 2000)
    DeviceOfEds(1, objects(file), axis).wake(0)
    assert not axis.powered
