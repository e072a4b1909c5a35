"""Objects over a serial line: four bytes both ways, one retry where no one answered, or an error."""

from typing import Final

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.sdo_client import SdoError, SdoRefusedError, SdoTimeoutError, Transfer
from firmware_bridge.families.epos2.driver.serial.client import TRY_WITHIN, SerialClient, reading, writing
from firmware_bridge.families.epos2.driver.serial.exchange import LineExchange, Result
from firmware_bridge.families.epos2.maxon.frame import Failure, MaxonAnswer, Outcome
from firmware_bridge.families.epos2.maxon.messages import Done, ObjectRead, Request
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer
from firmware_bridge.families.epos2.maxon.packets import command, outcome_packet
from firmware_bridge.node import LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

READ: Final = Transfer(od.STATUSWORD)
WRITE: Final = Transfer(od.CONTROLWORD, b"\x06\x00")


class Desk:
    def __init__(self) -> None:
        self.noted: list[Result] = []
        self.exchange = LineExchange("line")
        self.client = SerialClient(3, self.exchange, self.noted.append)

    def starts(self, transfer: Transfer) -> tuple[Packet, ...]:
        return self.client.start(transfer, 0) + self.exchange.go_on()

    def ends(self, request: Request, outcome: Outcome, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        return self.exchange.receive(outcome_packet(command(request).address, outcome), now)


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_value_is_as_long_as_its_object(desk: Desk) -> None:
    """The two bytes behind a statusword mean nothing (EPOS Communication Guide, October 2006)."""
    request = reading(3, od.STATUSWORD)
    assert desk.starts(READ) == (command(request, "line"),)
    desk.ends(request, MaxonAnswer(encode_answer(request, ObjectRead(0, b"\x37\x03\x10\x62"))))
    assert desk.client.take() == b"\x37\x03"
    assert desk.client.take() is None
    assert not desk.client.busy


def test_a_write_carries_four_bytes(desk: Desk) -> None:
    request = writing(3, od.CONTROLWORD, b"\x06\x00\x00\x00")
    assert desk.starts(WRITE) == (command(request, "line"),)
    desk.ends(request, MaxonAnswer(encode_answer(request, Done(0))))
    assert desk.client.take() == b""


@pytest.mark.parametrize(
    "outcome",
    [
        Failure.SILENCE,
        Failure.DAMAGED,
        Failure.GARBLED,
        MaxonAnswer(encode_answer(reading(3, od.STATUSWORD), ObjectRead(AbortCode.TIMEOUT, bytes(4)))),
    ],
)
def test_where_no_one_answered_it_is_tried_once_more(desk: Desk, outcome: Outcome) -> None:
    request = reading(3, od.STATUSWORD)
    desk.starts(READ)
    assert desk.ends(request, outcome, SECOND) == (command(request, "line"),)
    assert desk.ends(request, outcome, 2 * SECOND) == ()
    error = desk.client.take()
    assert isinstance(error, SdoTimeoutError)
    assert "0x6041 within 2000 ms" in str(error)
    assert len(desk.noted) == 2


def test_a_refusal_is_not_tried_again(desk: Desk) -> None:
    request = reading(3, od.STATUSWORD)
    desk.starts(READ)
    refusal = MaxonAnswer(encode_answer(request, ObjectRead(AbortCode.NO_OBJECT, bytes(4))))
    assert desk.ends(request, refusal) == ()
    error = desk.client.take()
    assert isinstance(error, SdoRefusedError)
    assert error.code == AbortCode.NO_OBJECT


def test_an_answer_too_short_to_be_one_is_no_answer(desk: Desk) -> None:
    request = reading(3, od.STATUSWORD)
    desk.starts(Transfer(od.STATUSWORD, attempts=1))
    desk.ends(request, MaxonAnswer(b"\0\0"))
    assert isinstance(desk.client.take(), SdoTimeoutError)


def test_many_attempts_end_with_the_time_for_them(desk: Desk) -> None:
    """Each one that goes through the gateway holds up the whole line for half a second."""
    request = reading(3, od.STATUSWORD)
    desk.starts(Transfer(od.STATUSWORD, attempts=10))
    requested, now = 1, 0
    while desk.client.busy:
        now += 500 * MILLISECOND
        requested += len(desk.ends(request, Failure.SILENCE, now))
    assert now == TRY_WITHIN
    assert requested == 4


def test_a_lost_line_is_not_waited_for(desk: Desk) -> None:
    desk.starts(READ)
    desk.exchange.receive(Packet("line", LINE_LOST, b""), 0)
    assert isinstance(desk.client.take(), SdoError)


def test_a_canceled_transfer_has_no_outcome_and_the_next_may_begin(desk: Desk) -> None:
    desk.starts(WRITE)
    desk.client.cancel()
    assert desk.starts(READ) == ()
    request = writing(3, od.CONTROLWORD, b"\x06\x00\x00\x00")
    assert desk.ends(request, MaxonAnswer(encode_answer(request, Done(0)))) == (
        command(reading(3, od.STATUSWORD), "line"),
    )
    assert desk.client.take() is None


def test_one_transfer_at_a_time(desk: Desk) -> None:
    desk.starts(WRITE)
    with pytest.raises(ValueError, match=r"SDO upload 0x6041 while SDO download 0x6040"):
        desk.starts(READ)
