"""The guard on a serial line: RARS's rules, its commands in short, and a node with a test's commands."""

from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.guard.serial import Epos2SerialRules
from firmware_bridge.families.epos2.maxon.frame import MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import Done, ObjectRead, ReadObject, Request, WriteObject
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer
from firmware_bridge.families.epos2.maxon.packets import command, outcome_packet, request_of
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard import Refusal, guarded
from firmware_bridge.units import Nanoseconds
from hil_tests.safety.guard_bench import LINK, ScriptedNode


def _over_serial(robot: AnyRobot) -> AnyRobot:
    """Return the same robot, driven over the serial port of its first drive."""
    return robot.with_links({LINK: Epos2Link.of_link(robot, LINK).over_serial(1, None, None)})


ROBOT: Final = _over_serial(find("rars"))
RULES: Final = Epos2SerialRules(ROBOT, LINK)
LEFT, STEER, LIFT = 1, 3, 4
TOP: Final = 3_972
ENDS: Final = {STEER: (-134_953, 134_953), LIFT: (0, 2_890_879)}
ENABLE, HALT, NEW_POSITION, QUICK_STOP = 0x000F, 0x010F, 0x003F, 0x000B


def states(request: Request) -> Packet:
    """A command on RARS's link."""
    return command(request, LINK)


def reading(node: int, address: Address) -> Packet:
    return states(ReadObject(address.index, address.subindex, node))


def writing(node: int, address: Address, raw: bytes) -> Packet:
    return states(WriteObject(address.index, address.subindex, node, raw.ljust(4, b"\0")))


def word(node: int, controlword: int) -> Packet:
    return writing(node, od.CONTROLWORD, controlword.to_bytes(2, "little"))


def number(node: int, address: Address, value: int) -> Packet:
    return writing(node, address, value.to_bytes(4, "little", signed=value < 0))


def speed(rpm: int, node: int = LEFT) -> Packet:
    return number(node, od.TARGET_VELOCITY, rpm)


def target(node: int, quadcounts: int) -> Packet:
    return number(node, od.TARGET_POSITION, quadcounts)


def done(packet: Packet) -> Packet:
    request = request_of(packet)
    assert request is not None
    return outcome_packet(packet.address, MaxonAnswer(encode_answer(request, Done(0))), LINK)


def value(packet: Packet, raw: bytes, error: int = 0) -> Packet:
    """Return the result of a read."""
    request = request_of(packet)
    assert request is not None
    answer = encode_answer(request, ObjectRead(error, raw.ljust(4, b"\0")))
    return outcome_packet(packet.address, MaxonAnswer(answer), LINK)


class SerialBench:
    def __init__(self, robot: AnyRobot = ROBOT) -> None:
        self.node = ScriptedNode()
        self.refusals: list[Refusal] = []
        self.guard = guarded(self.node, robot, self.refusals.append)

    def states(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.node.states = packets
        return self.guard.wake(now).sent

    def receives(self, packet: Packet, now: Nanoseconds = 0) -> bool:
        """Return True if the guard shows the node a packet."""
        before = len([received for received, _ in self.node.received if received is not None])
        self.guard.receive(packet, now)
        return len([received for received, _ in self.node.received if received is not None]) > before
