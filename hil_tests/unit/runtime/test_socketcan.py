"""A real SocketCAN interface: frames, and an interface that is down, missing, or taken away under way."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort, PortError, open_can
from firmware_bridge.units import SECOND
from firmware_bridge.wire.can import EXTENDED, REMOTE

pytestmark = pytest.mark.vcan


def ip_link(*arguments: str) -> None:
    subprocess.run(["ip", "link", *arguments], check=True)  # noqa: S607 - a fixed command


@pytest.fixture
def spare() -> Iterator[str]:
    """A second bus, which a test may take down and away."""
    if os.geteuid() != 0:
        pytest.skip("only root may make and remove interfaces")
    ip_link("add", "dev", "vcan9", "type", "vcan")
    ip_link("set", "vcan9", "up")
    yield "vcan9"
    if Path("/sys/class/net/vcan9").exists():
        ip_link("del", "vcan9")


def test_frames_of_every_kind_pass_between_us_and_python_can() -> None:
    port = open_can("socketcan", "vcan0")
    frames = [
        (0x123, b"\1\2\3"),
        (0x080, b""),
        (0x181 | REMOTE, bytes(6)),
        (0x1234567 | EXTENDED, bytes(range(8))),
    ]
    with can.Bus(interface="socketcan", channel="vcan0") as foreign_node:
        for address, content in frames:
            port.write(address, content, 0)
            message = foreign_node.recv(1)
            assert message is not None
            received = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
            assert received | (REMOTE if message.is_remote_frame else 0) == address
            assert (message.dlc, bytes(message.data)) == (len(content), b"" if address & REMOTE else content)
            foreign_node.send(message)
        came: list[tuple[int, bytes]] = []
        while len(came) < len(frames):  # the kernel brings the last one when it comes to it
            assert Clock().wait([port.fileno()], SECOND)
            came += port.read(0)
        assert came == frames
        assert port.read(0) == []
    port.close()


def test_an_interface_that_is_not_there_can_be_made() -> None:
    with pytest.raises(
        PortError, match="no such device; create it with `sudo ip link add dev vcan77 type vcan"
    ):
        open_can("socketcan", "vcan77")
    with pytest.raises(PortError, match=r"no such device; is the adapter plugged in\?"):
        open_can("socketcan", "can77")


def test_an_interface_that_is_down_can_be_brought_up(spare: str) -> None:
    ip_link("set", spare, "down")
    with pytest.raises(PortError, match="is down; bring it up with `sudo ip link set vcan9 up`"):
        open_can("socketcan", spare)


@pytest.mark.parametrize("way", ["reading", "sending"])
@pytest.mark.parametrize(("change", "message"), [("down", "taken down"), ("gone", "unplugged")])
def test_an_interface_that_goes_away_is_lost_at_once(spare: str, way: str, change: str, message: str) -> None:
    port = open_can("socketcan", spare)
    port.write(0x80, b"", 0)
    if change == "down":
        ip_link("set", spare, "down")
    else:
        ip_link("del", spare)
    if way == "reading":
        assert Clock().wait([port.fileno()], SECOND)
    with pytest.raises(LostPort, match=message):
        port.read(0) if way == "reading" else port.write(0x80, b"", 0)
    port.close()
