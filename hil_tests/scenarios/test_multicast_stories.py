"""A bus of datagrams, for machines without SocketCAN: `emulate` and `drive` in two processes, in real time.

`tools/with-loopback` brings the network in which these tests run.
"""

import socket
import struct
from collections.abc import Iterator
from typing import Final

import pytest

from firmware_bridge.recording import MAVLINK_2, parse_tlog
from hil_tests.scenarios.real_bus import DISABLED, MULTICAST, PLAIN, Bench, until

PORT: Final = 43113
"""python-can's own for this interface."""
IP_RECVTTL: Final = 12
"""Option of Linux, ip(7); Python has no name for it."""
NODES: Final = (1, 2, 3, 4)

pytestmark = [pytest.mark.alone, pytest.mark.timeout(120)]


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    """Yield a socket that has joined the group, with the hop limit of received datagrams."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        made.setsockopt(socket.IPPROTO_IP, IP_RECVTTL, 1)
        made.bind(("", PORT))
        group = socket.inet_aton(MULTICAST[1])
        made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + struct.pack("@I", 0))
        made.settimeout(20)
        yield made


def hops(listener: socket.socket) -> int:
    """Return the hop limit of the next datagram."""
    _, ancillary, _, _ = listener.recvmsg(4096, socket.CMSG_SPACE(4))
    return int(struct.unpack("@i", ancillary[0][2])[0])


def test_the_robot_is_armed_driven_left_without_power_and_all_of_it_recorded(datagrams: Bench) -> None:
    datagrams.emulates("--record", str(datagrams.folder / "drives"))
    bridge = datagrams.drives(more=("--record", str(datagrams.folder / "bridge")))
    client = datagrams.joins()
    client.arms()
    datagrams.gets_under_way(client, 0.3)
    client.states_until(0.0, lambda: abs(datagrams.eye.speed()) < 0.005, 5.0, "at rest")
    assert bridge.ends() == 0, bridge.printed
    assert "0x8150" not in bridge.printed
    for node in NODES:
        assert datagrams.eye.state(node) in DISABLED, (node, bridge.printed)
    assert datagrams.programs["emulate"].ends() == 0
    (own,), (theirs,) = (list((datagrams.folder / name).iterdir()) for name in ("bridge", "drives"))
    events = (own / "events.log").read_text(encoding="utf-8")
    for text in ("drives", "armed", "disarmed", "finished"):
        assert text in events
    for folder in (own, theirs):
        frames = (folder / "can.log").read_text(encoding="ascii")
        assert " can 000#0101\n" in frames or " drives 000#0101\n" in frames
        assert " 501#0F00" in frames
    assert any(True for _ in parse_tlog((own / "operator.tlog").read_bytes()))


def test_a_ground_station_that_listens_on_this_machine_is_joined(datagrams: Bench) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", 14550))
        station.settimeout(20)
        datagrams.emulates()
        datagrams.starts("drive", "drive", "rars", *datagrams.where)
        assert station.recv(2048)[0] == MAVLINK_2


def test_what_is_sent_does_not_leave_this_machine(datagrams: Bench, listener: socket.socket) -> None:
    emulate = datagrams.starts("emulate", "emulate", "rars", "-i", PLAIN)
    assert [hops(listener) for _ in NODES] == [0] * len(NODES)  # the boot-ups
    assert "udp_multicast is no true bus" in emulate.printed
    assert "take -i loopback_multicast" in emulate.printed


def test_a_user_may_let_it_out(
    datagrams: Bench, listener: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CAN_CONFIG", '{"hop_limit": 1}')
    datagrams.starts("emulate", "emulate", "rars", "-i", PLAIN)
    assert [hops(listener) for _ in NODES] == [1] * len(NODES)


def test_without_a_channel_all_meet_in_one_group(datagrams: Bench) -> None:
    datagrams.starts("emulate", "emulate", "rars", "-i", MULTICAST[0])
    until(lambda: datagrams.eye.ask(4, 0x1000) == 0x20192, 30.0, "an answer")
