"""The guard on a serial line: RARS's rules, its commands in short, and a node that says what a test wants."""

from typing import Final

from firmware_bridge.drivers.serial.client import writing
from firmware_bridge.safety.guard_serial_rules import serial_rules_for

from firmware_bridge.kinds import find
from firmware_bridge.packet import Packet
from firmware_bridge.safety.guard import Guarded, Refusal, guarded
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.maxon.frame import Answered
from firmware_bridge.wire.maxon.messages import Done
from firmware_bridge.wire.maxon.opcodes import encode_answer
from firmware_bridge.wire.maxon.packets import command, outcome_packet, request_of
from hil_tests.safety.guard_bench import Puppet

ROBOT: Final = find("rars").over_serial()
RULES: Final = serial_rules_for(ROBOT)
LEFT, STEER, LIFT = (ROBOT.axis(role) for role in ("left_wheel", "steering", "lift"))
TOP: Final = LEFT.profile.max_velocity_rpm
ENDS: Final = {rules.axis.name: (rules.low, rules.high) for rules in RULES.axes}
ENABLE, HALT, NEW_POSITION, QUICK_STOP = 0x000F, 0x010F, 0x003F, 0x000B


def word(node: int, controlword: int) -> Packet:
    return command(writing(node, at.CONTROLWORD, controlword.to_bytes(2, "little")))


def number(node: int, address: Address, value: int) -> Packet:
    return command(writing(node, address, value.to_bytes(4, "little", signed=value < 0)))


def speed(rpm: int, node: int = LEFT.node) -> Packet:
    return number(node, at.TARGET_VELOCITY, rpm)


def target(node: int, quadcounts: int) -> Packet:
    return number(node, at.TARGET_POSITION, quadcounts)


def done(packet: Packet) -> Packet:
    request = request_of(packet)
    assert request is not None
    return outcome_packet(packet.address, Answered(encode_answer(request, Done(0))))


class SerialBench:
    def __init__(self) -> None:
        self.puppet = Puppet()
        self.told: list[Refusal] = []
        self.guard: Guarded = guarded(self.puppet, ROBOT, self.told.append)

    def says(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.puppet.says = packets
        return self.guard.wake(now).sent

    def hears(self, packet: Packet, now: Nanoseconds = 0) -> bool:
        """Whether the node is shown a packet."""
        before = len([heard for heard, _ in self.puppet.heard if heard is not None])
        self.guard.receive(packet, now)
        return len([heard for heard, _ in self.puppet.heard if heard is not None]) > before
