"""The bridge's commands over a serial line, against exchanges that others have recorded.

A1 and B1: EPOS2 Application Notes Collection, April 2013, p. 11-164 and 166; B2 to B6 from the source of an
EPOS2 driver on USB, the others computed with a CRC of our own.
"""

from typing import Final

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.driver.serial.client import reading, writing
from firmware_bridge.families.epos2.driver.serial.line import MaxonLine
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.messages import Request, SendNmtService
from firmware_bridge.families.epos2.maxon.packets import command
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from hil_tests.scenarios.ride import ARMED, ride

LINE: Final = "line"
V1, V2 = Generation.V1, Generation.V2

COMMANDS: Final = (
    (V1, reading(2, od.DEVICE_TYPE), "10 01 00 10 00 02 10 CD"),
    (V2, reading(2, od.DEVICE_TYPE), "90 02 10 02 00 10 00 02 DF F2"),
    (V2, writing(0, od.CONTROLWORD, b"\x06\x00"), "90 02 11 04 40 60 00 00 06 00 00 00 1C F7"),
    (V2, writing(0, od.CONTROLWORD, b"\x0f\x00"), "90 02 11 04 40 60 00 00 0F 00 00 00 8D 69"),
    (V2, writing(0, od.CONTROLWORD, b"\x0f\x01"), "90 02 11 04 40 60 00 00 0F 01 00 00 39 1F"),
    (V2, writing(0, od.CONTROLWORD, b"\x00\x00"), "90 02 11 04 40 60 00 00 00 00 00 00 BC 45"),
    (V2, writing(0, od.CONTROLWORD, b"\x3f\x00"), "90 02 11 04 40 60 00 00 3F 00 00 00 28 AC"),
    (
        V2,
        writing(0, od.PROFILE_VELOCITY, (2500).to_bytes(4, "little")),
        "90 02 11 04 81 60 00 00 C4 09 00 00 88 82",
    ),
    (V1, reading(1, od.STATUSWORD), "10 01 41 60 00 01 AB F0"),
    (V2, reading(1, od.STATUSWORD), "90 02 10 02 41 60 00 01 64 CF"),
    (V1, writing(1, od.CONTROLWORD, b"\x06\x00"), "11 03 40 60 00 01 06 00 00 00 C3 71"),
    (V2, writing(1, od.CONTROLWORD, b"\x06\x00"), "90 02 11 04 40 60 00 01 06 00 00 00 BC B2"),
    (V1, SendNmtService(0, 1), "0E 01 00 00 01 00 D3 3A"),
    (V2, SendNmtService(0, 1), "90 02 0E 02 00 00 01 00 C9 54"),
)


class Asking:
    """A node that sends one request, and notes its result."""

    def __init__(self, request: Request) -> None:
        self.left: tuple[Packet, ...] = (command(request, LINE),)
        self.received: list[Packet] = []

    def receive(self, packet: Packet, _now: int) -> Reaction:
        self.received.append(packet)
        return Reaction()

    def wake(self, _now: int) -> Reaction:
        left, self.left = self.left, ()
        return Reaction(left)


def stated(reaction: Reaction) -> bytes:
    return b"".join(packet.payload for packet in reaction.sent)


@pytest.mark.parametrize(("generation", "request_", "wire"), COMMANDS)
def test_a_command_is_the_recorded_bytes(generation: Generation, request_: Request, wire: str) -> None:
    line = MaxonLine(Asking(request_), generation, LINE)
    raw = stated(line.wake(0))
    if generation is V1:
        raw += stated(line.receive(Packet(LINE, 0, b"O"), 1))
    assert raw == bytes.fromhex(wire)


def test_the_recorded_dialogue_on_rs232() -> None:
    """Application Notes p. 11-166, with the handshake of the guide."""
    node = Asking(reading(2, od.DEVICE_TYPE))
    line = MaxonLine(node, V1, LINE)
    assert stated(line.wake(0)) == b"\x10"
    assert stated(line.receive(Packet(LINE, 0, b"\x4f"), 1)) == bytes.fromhex("01 00 10 00 02 10 CD")
    assert stated(line.receive(Packet(LINE, 0, b"\x4f"), 2)) == b""
    assert stated(line.receive(Packet(LINE, 0, b"\x00"), 3)) == b"\x4f"
    answer = bytes.fromhex("03 00 00 00 00 92 01 02 00 EB 6D")
    assert stated(line.receive(Packet(LINE, 0, answer), 4)) == b"\x4f"
    assert node.received == [Packet(LINE, 0x10, bytes.fromhex("00000000 92010200"))]


def test_the_recorded_exchange_on_usb() -> None:
    """Application Notes p. 11-164."""
    node = Asking(reading(2, od.DEVICE_TYPE))
    line = MaxonLine(node, V2, LINE)
    line.wake(0)
    line.receive(Packet(LINE, 0, bytes.fromhex("90 02 00 04 00 00 00 00 92 01 02 00 9A ED")), 1)
    assert node.received == [Packet(LINE, 0x10, bytes.fromhex("00000000 92010200"))]


@pytest.mark.long(keeps=["v2"])
@pytest.mark.parametrize("generation", Generation)
def test_a_whole_start_up_states_them(generation: Generation) -> None:
    """The reads of drive 2's device type and of the first drive's statusword, in the bridge's stream."""
    robot = over_serial(find("rars"), generation)
    if generation is V1:
        robot = robot.model_copy(update={"cycle_ms": 140})
    one = ride(ARMED, seconds=5, robot=robot)
    stream = bytearray()
    assert one.rig.line is not None
    one.rig.line.wire.observe(
        lambda _now, sender, packet: stream.extend(packet.payload) if sender == "bridge" else None
    )
    one.runs(2.5)
    one.rig.finish()
    for spoken, request, wire in COMMANDS:
        if spoken is generation and request in (reading(2, od.DEVICE_TYPE), reading(1, od.STATUSWORD)):
            opcode = 1 if generation is V1 else 0  # on RS232 its handshake stands in between
            assert bytes.fromhex(wire)[opcode:] in stream
