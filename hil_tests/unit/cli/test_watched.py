"""Reports of an emulated device's console on its peers."""

import pytest

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.commands.reported import keeping_reported
from emulators.arduino_omni.motors import four_motors
from emulators.cli.watched import RollCalled, duplicates_reported
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import Recorded
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import REMOTE


class Quiet:
    def __init__(self) -> None:
        self.received: list[Packet] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        self.received.append(packet)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        return Reaction((Packet("can", 0x701, b"\0"),), now + SECOND)


def test_a_board_states_once_that_bytes_keep_it_in_its_boot_loader(
    capsys: pytest.CaptureFixture[str],
) -> None:
    board = Board(FIRMWARES["ros-arduino-bridge"], four_motors())
    keeping_reported(board.mega, "base")
    board.wake(0)
    for at in (500 * MILLISECOND, SECOND, 20 * SECOND):
        now = at
        board.receive(Packet(SERIAL, 0, b"e\r"), now)
        for later in range(100):
            board.wake(now + later * MILLISECOND)
    (line,) = capsys.readouterr().out.splitlines()
    assert "base is kept in its boot loader" in line
    assert "the sketch starts 9 s after the last of them" in line


def test_who_receives_its_own_number_from_elsewhere_states_so_once_a_number(
    capsys: pytest.CaptureFixture[str],
) -> None:
    inner = Quiet()
    node = duplicates_reported(inner, [("can", 1), ("can", 2), ("arm", 3)])
    assert node.wake(0).sent == (Packet("can", 0x701, b"\0"),)
    others = [
        *(("can", 0x000), ("can", 0x080), ("can", 0x601), ("can", 0x201), ("can", 0x703), ("can", 0x583)),
        *(("can", 0x701 | REMOTE), ("arm", 0x701), ("arm", 0x582)),
    ]
    for link, address in others:
        node.receive(Packet(link, address, b""), 0)
    assert capsys.readouterr().out == ""
    duplicates = [("can", 0x701), ("can", 0x581), ("can", 0x082), ("arm", 0x583), ("arm", 0x703)]
    for link, address in duplicates:
        node.receive(Packet(link, address, b""), 0)
    stated = capsys.readouterr().out.splitlines()
    assert [line.partition(" have come")[0] for line in stated] == [
        "node 1 is on the bus twice: heartbeats with its number",
        "node 2 is on the bus twice: emergencies with its number",
        "node 3 is on the bus twice: answers with its number",
    ]
    assert len(inner.received) == len(others) + len(duplicates)


def test_a_node_that_is_there_and_sends_nothing_is_named_at_the_start(
    capsys: pytest.CaptureFixture[str],
) -> None:
    there = Epos2(2, ServoAxis("two", 2000))
    there.wake(0)
    there.wake(SECOND)
    recorded: list[Packet] = []
    inner = Recorded(Quiet(), lambda _now, _direction, packet: recorded.append(packet))
    places = [("can", 1), ("can", 2)]
    node = RollCalled(duplicates_reported(inner, places), places)
    first = node.wake(SECOND).sent
    assert [packet.address for packet in first] == [0x601, 0x602, 0x701]
    (answer,) = [answer for packet in first for answer in there.receive(packet, SECOND).sent]
    assert capsys.readouterr().out == ""
    node.receive(answer, SECOND + MILLISECOND)
    assert "node 2 is on the bus twice: answers with its number have come" in capsys.readouterr().out
    assert [packet.address for packet in recorded] == [0x701, 0x582], "the question is no drive's"
    assert node.wake(2 * SECOND).sent == (Packet("can", 0x701, b"\0"),), "it requests once"
