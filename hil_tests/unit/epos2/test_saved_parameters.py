"""Saved parameters on disk: they survive a restart, and a kill in the middle of writing."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from emulators.canopen.saved_parameters import StorageError
from emulators.epos2.options import PRODUCT
from emulators.parameter_files import ParameterFile
from firmware_bridge.canopen.address import Address
from hil_tests.unit.epos2.quiet_motion import Desk

ACCELERATION = Address(0x6083)


def drive(path: Path) -> Desk:
    desk = Desk(storage=ParameterFile(path, PRODUCT))
    desk.powers()
    return desk


def test_what_was_saved_is_there_after_a_restart(tmp_path: Path) -> None:
    path = tmp_path / "drives" / "node-1.json"
    first = drive(path)
    assert first.writes(0x6083, 0, (777).to_bytes(4, "little")) == "ok"
    assert first.writes(0x607D, 1, (-5).to_bytes(4, "little", signed=True)) == "ok"
    assert first.writes(0x200C, 3, b"\x0d\xf0\xad\xba") == "ok"
    assert not path.exists()
    assert first.writes(0x1010, 1, b"save") == "ok"
    second = drive(path)
    assert second.reads(0x6083) == 777
    assert second.store.get(Address(0x607D, 1)) == -5
    assert second.reads(0x200C, 3) == 0xBAADF00D


def test_what_was_not_saved_is_not_there_after_a_restart(tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    first = drive(path)
    first.writes(0x1010, 1, b"save")
    first.writes(0x6083, 0, (777).to_bytes(4, "little"))
    assert drive(path).reads(0x6083) == 10_000


def test_load_gives_the_saved_copy_up(tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    first = drive(path)
    first.writes(0x6083, 0, (777).to_bytes(4, "little"))
    first.writes(0x1010, 1, b"save")
    assert drive(path).reads(0x6083) == 777
    first.writes(0x1011, 1, b"load")
    assert first.reads(0x6083) == 777, "what is in use stays until the restart"
    assert drive(path).reads(0x6083) == 10_000


WRITER = """
import sys
from pathlib import Path
from emulators.parameter_files import ParameterFile
from emulators.epos2.objects.device_profile import EPOS2_70_10
file = ParameterFile(Path(sys.argv[1]), "EPOS2")
numbers = [address for address, row in EPOS2_70_10.objects.items() if row.type.size]
turn = int(sys.argv[2])
while True:
    turn += 1
    file.write(dict.fromkeys(numbers, turn))
    print(turn, flush=True)
"""


def test_a_kill_at_any_moment_leaves_a_whole_copy(tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    reported = 0
    for lines in (1, 2, 5, 9):
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path), str(reported)], stdout=subprocess.PIPE, text=True
        ) as writer:
            assert writer.stdout is not None
            for _ in range(lines):
                reported = int(writer.stdout.readline())
            writer.send_signal(signal.SIGKILL)
            # Lines printed between the last line read and the kill are in the pipe.
            reported = max([reported, *map(int, writer.stdout.read().split())])
        kept = set(ParameterFile(path, PRODUCT).read().values())
        assert len(kept) == 1, "one copy, not parts of two"
        assert kept <= {reported, reported + 1}
        reported = kept.pop()


def test_a_leftover_of_a_kill_is_of_no_account(tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    file = ParameterFile(path, PRODUCT)
    file.write({ACCELERATION: 1})
    (tmp_path / "node-1.json.new").write_text('{"format": "EPOS2 par')
    assert file.read() == {ACCELERATION: 1}
    file.write({ACCELERATION: 2})
    assert file.read() == {ACCELERATION: 2}


def test_a_disk_that_refuses_is_a_hardware_error_and_the_drive_lives_on(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("no folder")
    desk = Desk(storage=ParameterFile(tmp_path / "node-1.json", PRODUCT))
    desk.powers()
    (tmp_path / "node-1.json.new").mkdir()
    desk.writes(0x6083, 0, (777).to_bytes(4, "little"))
    assert desk.writes(0x1010, 1, b"save") == "06060000"
    assert desk.reads(0x6083) == 777
    assert desk.receives("000#8101") == ["701#00"]
    assert desk.reads(0x6083) == 10_000


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "cannot read"),
        ("[]", "no file of saved parameters"),
        ('{"format": "something else", "values": {}}', "no file of saved parameters"),
        ('{"format": "EPOS2 parameters 1", "values": {"speed": 1}}', "'speed'"),
        ('{"format": "EPOS2 parameters 1", "values": {"0x6083": null}}', "'0x6083'"),
        ('{"format": "EPOS2 parameters 1", "values": {"0x6041": 1}}', "0x6041 = 1"),
        ('{"format": "EPOS2 parameters 1", "values": {"0x6083": -1}}', "0x6083 = -1"),
    ],
)
def test_what_is_no_copy_is_refused_by_name(text: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    path.write_text(text)
    with pytest.raises(StorageError, match=problem):
        drive(path)


def test_the_copy_can_be_read_by_people(tmp_path: Path) -> None:
    path = tmp_path / "node-1.json"
    drive(path).writes(0x1010, 1, b"save")
    values = json.loads(path.read_text())["values"]
    assert values["0x6083"] == 10_000
    assert values["0x1016:01"] == 0
    assert "0x6040" not in values, "a command is no parameter"
    assert "0x6041" not in values
