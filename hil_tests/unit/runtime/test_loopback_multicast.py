"""CAN between processes over the loopback interface, as python-can and the bridge open it.

In a network namespace with nothing but lo: `tools/with-loopback`.
"""

import socket
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import can
import pytest
from can.interfaces.udp_multicast.utils import pack_message

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import PortError, open_can
from firmware_bridge.units import SECOND

pytestmark = pytest.mark.alone
ROBOT_TYPE = "loopback_multicast"
ONE, OTHER = "239.74.163.40", "239.74.163.41"
SAME_PORT = "239.74.164.40"
RECEIVED_S = 2.0
QUIET_S = 0.05


@pytest.fixture
def joined() -> Iterator[Callable[[str], can.BusABC]]:
    with ExitStack() as stack:
        yield lambda group: stack.enter_context(can.Bus(interface=ROBOT_TYPE, channel=group))


def frame(number: int, data: bytes = b"\x0f\0") -> can.Message:
    return can.Message(arbitration_id=number, data=data, is_extended_id=number > 0x7FF)


def test_all_others_receive_a_frame_and_its_sender_does_not(joined: Callable[[str], can.BusABC]) -> None:
    sender, first, second = joined(ONE), joined(ONE), joined(ONE)
    sender.send(frame(0x201))
    sender.send(frame(0x18DA0001, b"12345678"))
    sender.send(can.Message(arbitration_id=0x701, is_remote_frame=True, is_extended_id=False))
    for listener in (first, second):
        received = [listener.recv(RECEIVED_S) for _ in range(3)]
        assert [
            (it.arbitration_id, bytes(it.data), it.is_remote_frame, it.is_rx) for it in received if it
        ] == [
            (0x201, b"\x0f\0", False, True),
            (0x18DA0001, b"12345678", False, True),
            (0x701, b"", True, True),
        ]
    assert sender.recv(QUIET_S) is None


@pytest.mark.parametrize("other", [OTHER, SAME_PORT])
def test_one_bus_does_not_receive_another(joined: Callable[[str], can.BusABC], other: str) -> None:
    sender, listener, elsewhere = joined(ONE), joined(ONE), joined(other)
    sender.send(frame(0x601))
    assert listener.recv(RECEIVED_S) is not None
    assert elsewhere.recv(QUIET_S) is None


def test_what_is_no_frame_is_passed_over(joined: Callable[[str], can.BusABC]) -> None:
    sender, listener = joined(ONE), joined(ONE)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        other.sendto(b"someone else's words", (ONE, 43_240))
    sender.send(frame(0x181))
    received = listener.recv(RECEIVED_S)
    assert received is not None
    assert received.arbitration_id == 0x181


def test_a_frame_from_another_address_is_not_taken(joined: Callable[[str], can.BusABC]) -> None:
    listener = joined(ONE)
    for address, number in (("127.0.0.2", 0x201), ("127.0.0.1", 0x202)):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
            sender.bind((address, 0))
            sender.sendto(pack_message(frame(number)), (ONE, 43_240))
    received = listener.recv(RECEIVED_S)
    assert received is not None
    assert received.arbitration_id == 0x202
    assert listener.recv(QUIET_S) is None


def test_the_bridge_opens_it_by_its_name_and_a_foreign_node_talks_to_it(
    joined: Callable[[str], can.BusABC],
) -> None:
    foreign_node, port, clock = joined(ONE), open_can(ROBOT_TYPE, ONE), Clock()
    foreign_node.send(frame(0x601, b"\x40\0\x10\0\0\0\0\0"))
    assert clock.wait([port.fileno()], SECOND)
    assert port.read(0) == [(0x601, b"\x40\0\x10\0\0\0\0\0")]
    port.write(0x581, b"\x43\0\x10\0\x92\1\2\0", 0)
    received = foreign_node.recv(RECEIVED_S)
    assert received is not None
    assert bytes(received.data) == b"\x43\0\x10\0\x92\1\2\0"
    assert port.read(0) == []
    port.close()


def test_plain_datagrams_that_cannot_be_opened_are_reported_with_the_systems_reason_and_what_helps() -> None:
    with pytest.raises(PortError) as raised:
        open_can("udp_multicast", "127.0.0.1")
    message = str(raised.value)
    assert "could not create or configure socket: Invalid argument." in message
    assert "a multicast group, as 239.74.163.2, to which this machine needs a route" in message


@pytest.mark.parametrize("channel", ["127.0.0.1", "vcan0", "ff15::1"])
def test_what_is_no_group_is_refused_with_one_that_is(channel: str) -> None:
    with pytest.raises(PortError, match=f"channel {channel} is no multicast group of IPv4; one is 239"):
        open_can(ROBOT_TYPE, channel)
