"""Ports on this machine: python-can's virtual bus, UDP on loopback, and what they say when they cannot."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import can
import pytest

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort, Port, PortError, UdpPort, open_can
from firmware_bridge.runtime.ports.outbox import PATIENCE, RETRY, Outbox
from firmware_bridge.runtime.ports.python_can import Echoes
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from firmware_bridge.wire.can import EXTENDED, REMOTE
from firmware_bridge.wire.internet import number_of
from hil_tests.ports import free_port

FRAMES = [
    (0x123, b"\1\2\3"),
    (0x080, b""),
    (0x123 | REMOTE, bytes(4)),
    (0x1234567 | EXTENDED, bytes(8)),
    (0x1234567 | EXTENDED | REMOTE, b""),
]


@contextmanager
def opened(*ports: Port) -> Iterator[None]:
    try:
        yield
    finally:
        for port in ports:
            port.close()
            port.close()


def received(port: Port, count: int, within: Nanoseconds = SECOND) -> list[tuple[int, bytes]]:
    clock, packets = Clock(), list[tuple[int, bytes]]()
    while len(packets) < count and clock.now() < within:
        if clock.wait([port.fileno()], within):
            packets += port.read(clock.now())
    return packets


def test_frames_pass_a_virtual_bus_in_both_directions() -> None:
    one, two = open_can("virtual", "test-ports"), open_can("virtual", "test-ports")
    with opened(one, two):
        for address, content in FRAMES:
            one.write(address, content, 0)
        assert received(two, len(FRAMES)) == FRAMES
        two.write(0x581, b"\1", 0)
        assert received(one, 1) == [(0x581, b"\1")]
        assert received(two, 1, within=5 * MILLISECOND) == []


def test_frames_come_from_and_go_to_any_program_that_uses_python_can() -> None:
    port = open_can("virtual", "test-strangers")
    with opened(port), can.Bus(interface="virtual", channel="test-strangers") as foreign_node:
        foreign_node.send(can.Message(arbitration_id=0x701, data=[5], is_extended_id=False))
        foreign_node.send(can.Message(arbitration_id=0, is_error_frame=True))
        foreign_node.send(can.Message(arbitration_id=0x702, data=[5], is_extended_id=False))
        assert received(port, 2) == [(0x701, b"\5"), (0x702, b"\5")]
        port.write(0x80 | REMOTE, bytes(3), 0)
        message = foreign_node.recv(1)
        assert message is not None
        assert (message.arbitration_id, message.is_remote_frame, message.dlc) == (0x80, True, 3)


def test_the_configuration_of_python_can_states_what_arguments_leave_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = tmp_path / "can.conf"
    config.write_text("[default]\ninterface = virtual\nchannel = from-a-file\nbitrate = 250000\n")
    monkeypatch.setattr(can.util, "CONFIG_FILES", [str(config)])
    port, other = open_can(), open_can(channel="from-an-argument")
    with opened(port, other):
        assert port.name == "CAN interface virtual channel from-a-file"
        assert other.name == "CAN interface virtual channel from-an-argument"


def test_a_broken_configuration_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = tmp_path / "can.conf"
    config.write_text("interface = virtual\n")
    monkeypatch.setattr(can.util, "CONFIG_FILES", [str(config)])
    with pytest.raises(PortError, match=r"no section headers"):
        open_can()


def test_without_an_interface_the_known_ones_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(can.util, "CONFIG_FILES", [])
    monkeypatch.delenv("CAN_INTERFACE", raising=False)
    with pytest.raises(PortError, match=r"none is given.*slcan, socketcan"):
        open_can()


@pytest.mark.parametrize(
    ("interface", "channel", "message"),
    [
        ("socketkan", "can0", r"^cannot open CAN interface socketkan: Unknown interface.*slcan, socketcan"),
        ("socketcan", None, r"channel None: name the channel"),
        (
            "socketcan",
            "nosuch0",
            r"^cannot open CAN interface socketcan channel nosuch0: (this kernel|no such device)",
        ),
        ("slcan", "/dev/nosuch", r"^cannot open CAN interface slcan channel /dev/nosuch: .*No such file"),
        ("socketcand", "can0", r"missing 2 required positional arguments: 'host' and 'port'"),
    ],
)
def test_a_bus_that_is_not_there_is_one_clear_message(
    interface: str, channel: str | None, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(can.util, "CONFIG_FILES", [])
    with pytest.raises(PortError, match=message) as raised:
        open_can(interface, channel)
    assert "\n" not in str(raised.value)


SYNC = (0x080, b"")
PDO = (0x181, b"\1\2")


def test_an_echo_is_taken_for_one_s_own_once() -> None:
    echoes = Echoes()
    echoes.expects(SYNC)
    assert not echoes.takes(PDO)
    assert echoes.takes(SYNC)
    assert not echoes.takes(SYNC)  # another master's


def test_echoes_of_frames_before_it_were_lost() -> None:
    echoes = Echoes()
    for frame in (SYNC, PDO, PDO):
        echoes.expects(frame)
    assert echoes.takes(PDO)
    assert not echoes.takes(SYNC)
    assert echoes.takes(PDO)
    assert not echoes.takes(PDO)


def test_an_echo_that_two_readings_did_not_bring_is_not_awaited_any_more() -> None:
    echoes = Echoes()
    echoes.expects(SYNC)
    echoes.drained()
    echoes.expects(PDO)
    echoes.drained()
    assert not echoes.takes(SYNC)
    assert echoes.takes(PDO)


def test_one_that_came_in_between_leaves_the_others_their_two_readings() -> None:
    echoes = Echoes()
    echoes.expects(SYNC)
    echoes.drained()
    assert echoes.takes(SYNC)
    echoes.expects(PDO)
    echoes.drained()
    assert echoes.takes(PDO)


class Stuck(Outbox):
    """An interface that takes as many frames as it has room for."""

    name = "a bus where no one listens"

    def __init__(self) -> None:
        super().__init__()
        self.room = 0
        self.sent: list[int] = []

    def fileno(self) -> int:
        return -1

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        return []

    def close(self) -> None:
        self.room = 0

    def _send(self, address: int, payload: bytes) -> bool:
        del payload
        if not self.room:
            return False
        self.room -= 1
        self.sent.append(address)
        return True

    def _lost(self, problem: str) -> LostPort:
        return LostPort(self, problem)


def test_frames_wait_in_order_while_the_interface_is_full() -> None:
    port = Stuck()
    port.room = 1
    for address in (1, 2, 3, 4):
        port.write(address, b"", 100)
    assert port.sent == [1]
    assert port.retry_at == 100 + RETRY
    port.room = 2
    port.flush(port.retry_at)
    assert port.sent == [1, 2, 3]
    port.room = 9
    port.write(5, b"", 200)
    assert port.sent == [1, 2, 3]
    port.flush(100 + 2 * RETRY)
    assert port.sent == [1, 2, 3, 4, 5]
    assert port.retry_at == NEVER


def test_a_bus_that_takes_nothing_for_a_cycle_is_lost() -> None:
    port = Stuck()
    port.write(1, b"", 0)
    port.flush(PATIENCE - 1)
    with pytest.raises(
        LostPort, match="lost a bus where no one listens: no frame could be sent for 50 ms"
    ) as lost:
        port.flush(PATIENCE)
    assert lost.value.port is port


@pytest.mark.parametrize("host", ["127.0.0.1", "[::1]"])
def test_a_datagram_carries_the_place_it_came_from_and_goes_where_its_number_states(host: str) -> None:
    bridge = UdpPort(f"udpin:{host}:0")
    with opened(bridge):
        first, second = UdpPort(f"udpout:{host}:{bridge.port}"), UdpPort(f"udpout:{host}:{bridge.port}")
        with opened(first, second):
            one, two = (number_of(host.strip("[]"), caller.port) for caller in (first, second))
            first.write(0, b"one", 0)
            second.write(0, b"two", 0)
            assert sorted(received(bridge, 2)) == sorted([(one, b"one"), (two, b"two")])
            bridge.write(two, b"to the second", 0)
            assert received(second, 1) == [(0, b"to the second")]
            bridge.write(0, b"to no one", 0)
            assert received(first, 1, within=5 * MILLISECOND) == []
            assert bridge.unsent == 0


def test_a_caller_whom_no_one_answers_goes_on_calling() -> None:
    number = free_port()
    caller = UdpPort(f"udpout:127.0.0.1:{number}")
    with opened(caller):
        for _ in range(3):
            caller.write(0, b"hello", 0)
            assert received(caller, 1, within=MILLISECOND) == []
        answerer = UdpPort(f"udpin:127.0.0.1:{number}")
        with opened(answerer):
            caller.write(0, b"hello", 0)
            caller.write(0, b"hello", 0)
            assert (number_of("127.0.0.1", caller.port), b"hello") in received(answerer, 1)


def test_a_port_in_use_states_so() -> None:
    first = UdpPort("udpin:127.0.0.1:0")
    with (
        opened(first),
        pytest.raises(PortError, match=r"^cannot open udpin:127\.0\.0\.1:\d+: the port is in use"),
    ):
        UdpPort(f"udpin:127.0.0.1:{first.port}")


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ("14550", "give udpin:HOST:PORT or udpout:HOST:PORT"),
        ("udp:127.0.0.1:14550", "give udpin"),
        ("udpin:127.0.0.1", "give udpin"),
        ("udpin:127.0.0.1:70000", "give udpin"),
        ("udpin:192.0.2.1:14550", "not an address of this machine"),
        ("udpin:no such host:14550", "no such host"),
    ],
)
def test_a_link_that_cannot_be_states_why(link: str, message: str) -> None:
    with pytest.raises(PortError, match=message):
        UdpPort(link)


def test_a_number_for_a_test_is_given_once_and_by_no_system_meanwhile() -> None:
    numbers = [free_port() for _ in range(500)]
    assert len(set(numbers)) == len(numbers)
    # What a system hands out by itself begins at 32768 on Linux, and at 49152 elsewhere.
    assert max(numbers) < 32_768
