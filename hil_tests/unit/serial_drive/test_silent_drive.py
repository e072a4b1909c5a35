"""A drive behind the gateway that does not answer holds up the line once, not for each read that waits."""

from typing import Final

import pytest

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.drivers.driver import Stop
from firmware_bridge.families.epos2.driver.serial.drive import Epos2OnSerial
from firmware_bridge.families.epos2.driver.serial.exchange import LineExchange, Rank
from firmware_bridge.families.epos2.driver.serial.feedback import (
    ERROR_REGISTER,
    POSITION,
    STATUSWORD,
    ReadRow,
)
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import ObjectRead, ReadObject, WriteObject
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer
from firmware_bridge.families.epos2.maxon.packets import command, outcome_packet
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find

ROBOT: Final = over_serial(find("rars"))
STEER, LIFT = 3, 4


class Line:
    """Steering and lift behind the gateway, and a cycle's reads of both."""

    def __init__(self) -> None:
        self.exchange = LineExchange("drives")
        self.steer, self.lift = (self.drive(node) for node in (STEER, LIFT))
        for row in (POSITION, STATUSWORD):
            for drive in (self.steer, self.lift):
                drive.read(row, Rank.SAMPLE)
        self.steer.read(ERROR_REGISTER, Rank.ROTATING)

    def drive(self, node: int) -> Epos2OnSerial:
        axis = next(axis for axis in ROBOT.axes if Epos2Axis.of(axis).node == node)
        return Epos2OnSerial(axis, ROBOT, self.exchange)

    def answered(self, node: int, row: ReadRow, error: int = 0) -> tuple[Packet, ...]:
        """Answer a read; return what is sent then."""
        request = reads(node, row)
        answer = encode_answer(request, ObjectRead(error, bytes(4)))
        return self.exchange.receive(outcome_packet(command(request).address, MaxonAnswer(answer)), 0)


def reads(node: int, row: ReadRow) -> ReadObject:
    return ReadObject(row.address.index, row.address.subindex, node)


def sent(node: int, row: ReadRow) -> tuple[Packet, ...]:
    return (command(reads(node, row), "drives"),)


def test_what_else_was_to_be_read_of_it_is_not_requested() -> None:
    line = Line()
    assert line.exchange.go_on() == sent(STEER, POSITION)
    assert line.answered(STEER, POSITION, AbortCode.TIMEOUT) == sent(LIFT, POSITION)
    assert line.answered(LIFT, POSITION) == sent(LIFT, STATUSWORD)
    assert line.answered(LIFT, STATUSWORD) == ()
    assert (line.steer.present, line.lift.present) == (False, True)


def test_its_set_point_still_leaves() -> None:
    line = Line()
    line.exchange.go_on()
    line.steer.command(Stop.POWER_OFF)
    (packet,) = line.answered(STEER, POSITION, AbortCode.TIMEOUT)
    assert packet.address == command(WriteObject(0x6040, 0, STEER, bytes(4))).address
    assert packet.payload[3] == STEER


@pytest.mark.parametrize("error", [0, AbortCode.NO_OBJECT])
def test_one_that_answers_is_requested_on_whatever_it_states(error: int) -> None:
    line = Line()
    line.exchange.go_on()
    assert line.answered(STEER, POSITION, error) == sent(LIFT, POSITION)
    assert line.answered(LIFT, POSITION) == sent(STEER, STATUSWORD)
