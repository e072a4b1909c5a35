"""EDS and DCF: other people's readers accept them and find in them the drive's own values."""

import json
import shutil
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import canopen
import pytest
from canopen.objectdictionary import ODVariable
from typer.testing import CliRunner

from emulators.epos2.documents.eds import dcf, eds
from emulators.epos2.documents.object_reader import SilentNodeError, read_all
from emulators.epos2.documents.object_table import as_json, entries
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.cli import program
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds
from hil_tests.unit.epos2.quiet_motion import Desk, powered


@pytest.fixture(scope="module", params=PROFILES)
def profile(request: pytest.FixtureRequest) -> DeviceProfile:
    return PROFILES[request.param]


@pytest.fixture(scope="module")
def sheet(profile: DeviceProfile, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("eds") / "epos2.eds"
    path.write_text(eds(profile), encoding="ascii")
    return path


def flat(dictionary: Any) -> dict[Address, Any]:
    found = {}
    for index, thing in dictionary.items():
        members = {0: thing} if isinstance(thing, ODVariable) else thing.subindices
        found.update({Address(index, sub): member for sub, member in members.items()})
    return found


def test_canopen_reads_the_sheet_row_by_row(sheet: Path, profile: DeviceProfile) -> None:
    dictionary = canopen.import_od(str(sheet), node_id=5)
    read = flat(dictionary)
    assert set(read) == set(profile.objects)
    for address, row in profile.objects.items():
        entry = read[address]
        assert entry.data_type == row.type.code, address
        assert entry.access_type == row.access.value, address
        assert entry.pdo_mappable is row.mappable, address
        assert entry.name == row.name, address


def test_canopen_reads_ranges_and_defaults(tmp_path: Path) -> None:
    path = tmp_path / "epos2.eds"
    path.write_text(eds(EPOS2_70_10), encoding="ascii")
    read = flat(canopen.import_od(str(path), node_id=5))
    for entry in entries(EPOS2_70_10, node=5):
        row = entry.row
        assert (read[row.address].min, read[row.address].max) == (entry.low, entry.high), row.address
        individual = row.address in {
            od.SERIAL_NUMBER,
            Address(0x2004),
            Address(0x2FFF, 5),
            Address(0x2FFF, 6),
        }
        if row.default_provenance is Provenance.ASSUMED or individual:
            assert read[row.address].default is None, row.address
        elif isinstance(entry.default, int):
            assert read[row.address].default == entry.default, row.address


def test_canopen_knows_the_device(sheet: Path) -> None:
    device = canopen.import_od(str(sheet)).device_information
    assert device.vendor_number == 0xFB
    assert device.nr_of_RXPDO == device.nr_of_TXPDO == 4
    assert device.LSS_supported
    assert device.allowed_baudrates == {20_000, 50_000, 125_000, 250_000, 500_000, 800_000, 1_000_000}


def lely() -> str | None:
    beside = Path(sys.executable).with_name("dcfchk")
    return str(beside) if beside.exists() else shutil.which("dcfchk")


@pytest.mark.long(keeps=["70/10"])
@pytest.mark.interpreted  # what is installed beside the compiled core has no such tools
@pytest.mark.skipif(lely() is None, reason="Lely's dcf-tools are not installed")
def test_lelys_tools_find_nothing_to_say_about_sheet_and_configuration(sheet: Path, tmp_path: Path) -> None:
    tool = lely()
    assert tool is not None
    configuration = tmp_path / "node.dcf"
    configuration.write_text(dcf(EPOS2_70_10, 3, 1_000_000, {od.DEVICE_TYPE: 0x0002_0192}), encoding="ascii")
    for path in (sheet, configuration):
        done = subprocess.run([tool, "-n", "3", str(path)], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_one_table_one_sheet() -> None:
    assert eds(EPOS2_70_10) == eds(EPOS2_70_10)
    assert eds(EPOS2_70_10).isascii()
    assert "80015954" not in eds(EPOS2_70_10), "a serial number is one drive's, not a type's"


class Wire:
    """A port whose far end is a drive on the desk."""

    name = "desk"
    retry_at: Nanoseconds = NEVER

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._waiting: list[tuple[int, bytes]] = []
        self._bell, self._rope = socket.socketpair()

    def fileno(self) -> int:
        return self._bell.fileno()

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        if self._waiting:
            self._bell.recv(len(self._waiting))
        found, self._waiting = self._waiting, []
        return found

    def write(self, address: int, payload: bytes, _now: Nanoseconds) -> None:
        reaction = self._desk.drive.receive(Packet(CAN, address, payload), 0)
        self._waiting += [(packet.address, packet.payload) for packet in reaction.sent]
        self._rope.send(bytes(len(reaction.sent)))

    def flush(self, now: Nanoseconds) -> None:
        """Nothing waits to be sent."""

    def close(self) -> None:
        self._bell.close()
        self._rope.close()


def test_a_running_drive_is_read_whole_and_its_file_carries_the_values(tmp_path: Path) -> None:
    desk = powered()
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    wire = Wire(desk)
    values = read_all(wire, 1)
    wire.close()
    readable = {
        a for a, row in EPOS2_70_10.objects.items() if row.access.readable and row.type is not DataType.DOMAIN
    }
    assert set(values) == readable
    path = tmp_path / "node1.dcf"
    path.write_text(dcf(EPOS2_70_10, 1, 500_000, values), encoding="ascii")
    read = canopen.import_od(str(path), node_id=1)
    assert (read.node_id, read.bitrate) == (1, 500_000)
    assert read[0x6083].value == 777
    assert read[0x1018][4].value == 0x8001_5954
    assert read[0x607D][1].value == -(1 << 31)


def test_a_silent_node_is_named() -> None:
    wire = Wire(powered())
    with pytest.raises(SilentNodeError, match="node 9 on desk"):
        read_all(wire, 9)
    wire.close()


def test_the_table_as_json_has_every_object_and_every_key() -> None:
    rows = json.loads(as_json(PROFILES["24/5"]))
    assert len(rows) == len(EPOS2_70_10.objects)
    keys = {
        "index",
        "subindex",
        "name",
        "type",
        "access",
        "pdo",
        "default",
        "min",
        "max",
        "unit",
        "provenance",
    }
    assert all(keys <= row.keys() for row in rows)
    (limit,) = [row for row in rows if (row["index"], row["subindex"]) == (0x6410, 2)]
    assert (limit["default"], limit["max"], limit["provenance"]) == (10_000, 10_000, "assumed")
    (word,) = [row for row in rows if row["index"] == 0x6040]
    assert (word["access"], word["pdo"], word["type"]) == ("rww", "receive", "UNSIGNED16")


def stated(*words: str, columns: int = 200) -> str:
    result = CliRunner().invoke(program, ["epos2", *words], env={"COLUMNS": str(columns)})
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize("columns", [80, 120, 200])
def test_each_object_is_a_line_of_any_terminal(columns: int) -> None:
    _, heads, *lines = stated("objects", columns=columns).splitlines()
    assert heads.split() == ["object", "type", "access", "PDO", "name", "default"]
    assert len(lines) == 430
    assert max(map(len, lines)) <= columns
    (target,) = [line.split() for line in lines if line.startswith("0x607A")]
    assert target == ["0x607A", "I32", "rww", "rx", "Target", "Position", "0", "qc"]


def test_objects_are_looked_for_and_one_is_shown_in_full() -> None:
    found = stated("objects", "TARGET", "vel").split()
    assert "0x60FF" in found
    assert "0x607A" not in found
    one = [line.split() for line in stated("objects", "607A").splitlines()]
    assert ["name", "Target", "Position"] in one
    assert ["type", "INTEGER32"] in one
    none = CliRunner().invoke(program, ["epos2", "objects", "no such"])
    assert (none.exit_code, "has no object with no such in address or name" in none.stderr) == (2, True)


@pytest.mark.parametrize("columns", [80, 120, 200])
def test_what_is_known_of_the_emulation_is_looked_for(columns: int) -> None:
    text = stated("fidelity", "holding", "brake", columns=columns)
    assert max(map(len, text.splitlines())) <= columns
    assert "holding_brake.py" in "".join(text.split())
    assert "electronic_gear.py" not in "".join(text.split())


def test_the_commands_say_it(tmp_path: Path) -> None:
    assert "0x60FF" in stated("objects", "--profile", "50/5")
    assert len(json.loads(stated("objects", "--json", "--node", "7"))) == 430
    assert stated("eds").startswith("[FileInfo]")
    stated("eds", "--out", str(tmp_path / "drive.eds"))
    assert "FileName=drive.eds" in (tmp_path / "drive.eds").read_text()
    assert "by analogy" in stated("fidelity")


def test_mistakes_at_the_command_are_answered(tmp_path: Path) -> None:
    for words, wanted in (
        (("eds", "--profile", "1/1"), "70/10"),
        (("eds", "--out", str(tmp_path)), str(tmp_path)),
        (("dcf", "-i", "nope"), "nope"),
    ):
        result = CliRunner().invoke(program, ["epos2", *words])
        assert result.exit_code == 2, result.output
        assert wanted in result.stderr
    silent = CliRunner().invoke(program, ["epos2", "dcf", "-i", "virtual", "-c", "no one"])
    assert silent.exit_code == 1
    assert "node 1" in silent.stderr
