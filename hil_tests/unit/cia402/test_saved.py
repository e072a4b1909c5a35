"""Saved parameters of the servo and of a device by its EDS: they come again, each from a file of its own."""

from functools import partial
from pathlib import Path

import pytest
import typer

from emulators.cia402.commands import canopen, emulate
from emulators.cia402.commands.canopen import EdsOptions
from emulators.cia402.commands.emulate import ServoOptions
from emulators.cli.emulate_robot import RobotOptions, start
from emulators.cli.emulation import Emulation
from emulators.parameter_files import ParameterFile
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet

FOLLOWING, STATIC = 777, 0x2000
SAVE = bytes.fromhex("2310100173617665")
EDS = """
[1000]
DataType=0x0007
AccessType=ro
DefaultValue=0x00030191

[1001]
DataType=0x0005
AccessType=ro

[1010]
ObjectType=0x9
SubNumber=2

[1010sub0]
DataType=0x0005
AccessType=const
DefaultValue=1

[1010sub1]
DataType=0x0007
AccessType=rw

[2000]
DataType=0x0003
AccessType=rw
"""


def sent(emulation: Emulation, node: int, *requests: bytes) -> list[bytes]:
    """Return the answers of a node to SDO requests, right after its start."""
    device, answers, now = emulation.node, list[bytes](), 50_000_000
    device.wake(now)
    for request in requests:
        reaction = device.receive(Packet(CAN, 0x600 + node, request), now)
        answers += [it.payload for it in reaction.sent if it.address == 0x580 + node]
    return answers


def read_of(address: Address) -> bytes:
    return bytes((0x40, *address.index.to_bytes(2, "little"), address.subindex, 0, 0, 0, 0))


def test_what_the_servo_saves_comes_again_on_its_node_alone(tmp_path: Path) -> None:
    options = ServoOptions(node="3,4", parameters=tmp_path)
    written = bytes.fromhex(f"23656000{FOLLOWING.to_bytes(4, 'little').hex()}")
    assert sent(emulate.start(options), 3, written, SAVE)[1][0] == 0x60
    assert (tmp_path / "node-3.json").is_file()
    again = emulate.start(options)
    (answer,) = sent(again, 3, read_of(od.MAX_FOLLOWING_ERROR))
    assert int.from_bytes(answer[4:], "little") == FOLLOWING
    (other,) = sent(again, 4, read_of(od.MAX_FOLLOWING_ERROR))
    assert int.from_bytes(other[4:], "little") != FOLLOWING


def test_what_a_device_by_its_eds_saves_comes_again(tmp_path: Path) -> None:
    sheet = tmp_path / "io.eds"
    sheet.write_text(EDS)
    options = EdsOptions(eds=sheet, node="9", parameters=tmp_path)
    written = bytes.fromhex("2B002000FEFF0000")
    assert sent(canopen.start(options), 9, written, SAVE)[1][0] == 0x60
    (answer,) = sent(canopen.start(options), 9, read_of(Address(STATIC)))
    assert answer[4:6] == b"\xfe\xff"


def test_a_robot_s_drives_take_what_was_saved(tmp_path: Path) -> None:
    ParameterFile(tmp_path / "node-1.json", "CiA 402 servo").write({od.MAX_FOLLOWING_ERROR: FOLLOWING})
    made = start(RobotOptions(robot="servo_axis", parameters=tmp_path))
    (answer,) = sent(made, 1, read_of(od.MAX_FOLLOWING_ERROR))
    assert int.from_bytes(answer[4:], "little") == FOLLOWING


@pytest.mark.parametrize("text", ["{", '{"format": "EPOS2 parameters 1", "values": {}}'])
def test_a_file_of_another_product_is_refused_and_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    (tmp_path / "node-1.json").write_text(text)
    begins = (
        partial(emulate.start, ServoOptions(parameters=tmp_path)),
        partial(start, RobotOptions(robot="servo_axis", parameters=tmp_path)),
    )
    for begin in begins:
        with pytest.raises(typer.Exit) as ended:
            begin()
        assert ended.value.exit_code == 2
        assert "node-1.json" in capsys.readouterr().err
