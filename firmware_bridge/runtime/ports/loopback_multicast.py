"""A CAN bus of datagrams between processes of one machine, an interface of python-can for want of vcan.

Its channel is a multicast group. Frames go over the loopback interface alone, each group has a port of its
own, and a sender does not get its frames back: as on vcan, and unlike `udp_multicast`, whose packing it has.
"""

import ipaddress
import os
import select
import socket
import time
from typing import Any, Final

import can
from can.interfaces.udp_multicast.utils import is_msgpack_installed, pack_message, unpack_message

NAME: Final = "loopback_multicast"
"""Name of the interface for python-can's users."""
GROUP: Final = "239.74.163.2"
"""Default group; administratively scoped (RFC 2365)."""
LOOPBACK: Final = "127.0.0.1"
FIRST_PORT: Final = 43_200
"""Of the group whose last number is 0: python-can's own, 43113, is left to its users."""
ROOM: Final = 4_096


class LoopbackMulticastBus(can.BusABC):
    """Such a bus; of the arguments, `channel` alone counts."""

    def __init__(self, channel: str = GROUP, *args: Any, **more: Any) -> None:
        """Join it; CanInitializationError with the system's error and a remedy."""
        is_msgpack_installed()
        group = _group(channel)
        self._place: Final = (group, FIRST_PORT + int(group.rpartition(".")[2]))
        self._received: Final = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._outgoing: Final = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._join(group)
        except OSError as error:
            self._received.close()
            self._outgoing.close()
            raise can.CanInitializationError(
                f"cannot join the group {group} on the loopback interface: {error.strerror}; is lo up?"
            ) from error
        self.channel_info = f"{NAME} {group}, port {self._place[1]}"
        self._own: Final = self._outgoing.getsockname()
        super().__init__(group, *args, **more)

    def fileno(self) -> int:
        """Return the socket that can be read when frames have arrived."""
        return self._received.fileno()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Give a frame to all others; CanOperationError."""
        del timeout
        try:
            self._outgoing.sendto(pack_message(msg), self._place)
        except OSError as error:
            raise can.CanOperationError(f"cannot send: {error.strerror}", error.errno) from error

    def shutdown(self) -> None:
        """Leave it; may be called again."""
        super().shutdown()
        self._received.close()
        self._outgoing.close()

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        until = None if timeout is None else time.monotonic() + timeout
        while True:
            left = None if until is None else max(0.0, until - time.monotonic())
            try:
                if not select.select([self._received], [], [], left)[0]:
                    return None, False
                data, sender = self._received.recvfrom(ROOM)
            except OSError as error:
                raise can.CanOperationError(f"cannot receive: {error.strerror}", error.errno) from error
            # Where another program has joined the group elsewhere, the system lets in what comes from there.
            here = sender[0] == LOOPBACK and sender != self._own
            frame = _frame(data) if here else None
            if frame is not None:
                return frame, False

    def _join(self, group: str) -> None:
        here = socket.inet_aton(LOOPBACK)
        self._received.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Windows binds to no group; elsewhere that keeps other groups on this port out.
        self._received.bind(("" if os.name == "nt" else group, self._place[1]))
        self._received.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + here)
        self._outgoing.bind((LOOPBACK, 0))
        self._outgoing.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, here)
        self._outgoing.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        # A hop limit of 0 keeps the frames on this machine (RFC 1112).
        self._outgoing.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)


def _group(channel: str) -> str:
    try:
        if ipaddress.IPv4Address(channel).is_multicast:
            return channel
    except ValueError:
        pass
    raise can.CanInitializationError(
        f"channel {channel} is no multicast group of IPv4; one is {GROUP}, as all of 239.0.0.0/8"
    )


def _frame(data: bytes) -> can.Message | None:
    """Return the frame in a datagram; None where it holds none."""
    try:
        return unpack_message(data, {"timestamp": time.time()}, check=True)
    except Exception:  # noqa: BLE001 - python-can names no others
        return None
