"""A CAN interface of the Linux kernel, by its raw socket: one system call for a frame, and exact errors.

python-can's own bus for it takes three system calls to send and two to receive, which a slow machine cannot
afford, and reports less when it fails.
"""

import contextlib
import errno
import socket
import struct
from typing import Final

from firmware_bridge.runtime.ports.outbox import Outbox
from firmware_bridge.runtime.ports.port import BURST, LostPort, PortError
from firmware_bridge.wire.can import ERROR, MAX_PAYLOAD, REMOTE

_FRAME: Final = struct.Struct("=IB3x8s")
"""struct can_frame of <linux/can.h>; its address word is that of `wire.can`."""
_LARGEST: Final = 72
"""A CAN FD frame, which is not for us."""
_BUS_OFF: Final = 0x40
"""CAN_ERR_BUSOFF of <linux/can/error.h>."""
_ERROR_FILTER: Final = 2
"""CAN_RAW_ERR_FILTER of <linux/can/raw.h>."""
_BUSY: Final = frozenset({errno.ENOBUFS, errno.EAGAIN})

_PROBLEMS: Final = {
    errno.ENETDOWN: "the interface was taken down; `sudo ip link set {channel} up`",
    errno.ENODEV: "the interface is gone; was the adapter unplugged?",
    errno.ENXIO: "the interface is gone; was the adapter unplugged?",
}


class SocketCanPort(Outbox):
    """One SocketCAN interface. Opening it raises PortError with what to do."""

    def __init__(self, channel: str, bit_rate: int) -> None:
        super().__init__()
        self.name = f"CAN interface socketcan channel {channel}"
        self.ignored = 0
        """Error reports of the controller and CAN FD frames."""
        self._channel = channel
        self._socket = _opened(channel, bit_rate, self.name)
        self._fileno = self._socket.fileno()

    def fileno(self) -> int:
        """Return the socket's file."""
        return self._fileno

    def read(self, _now: int) -> list[tuple[int, bytes]]:
        """Return the frames that have arrived; LostPort where the interface or the bus is gone."""
        frames: list[tuple[int, bytes]] = []
        receive = self._socket.recv
        with contextlib.suppress(BlockingIOError):
            for _ in range(BURST):
                try:
                    raw = receive(_LARGEST)
                except BlockingIOError:
                    raise
                except OSError as error:
                    raise self._gone(error) from error
                # A CAN FD frame is longer; the rest of the program knows eight bytes.
                if len(raw) != _FRAME.size:
                    self.ignored += 1
                    continue
                address, length, content = _FRAME.unpack(raw)
                if address & ERROR:
                    self._note(address)
                else:
                    frames.append((address, bytes(length) if address & REMOTE else content[:length]))
        return frames

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _send(self, address: int, payload: bytes) -> bool:
        if len(payload) > MAX_PAYLOAD:
            raise ValueError(f"a CAN frame carries at most {MAX_PAYLOAD} bytes, not {len(payload)}")
        try:
            self._socket.send(_FRAME.pack(address, len(payload), payload))
        except OSError as error:
            # ENOBUFS is a full send queue, as on a bus on which no one acknowledges; it may become free
            # again.
            if error.errno in _BUSY:
                return False
            raise self._gone(error) from error
        return True

    def _note(self, report: int) -> None:
        if report & _BUS_OFF:
            raise self._lost(
                "the controller went bus-off after too many errors; check bit rate, wiring and termination, "
                f"then `sudo ip link set {self._channel} down && sudo ip link set {self._channel} up`"
            )
        self.ignored += 1

    def _lost(self, problem: str) -> LostPort:
        return LostPort(self, problem)

    def _gone(self, error: OSError) -> LostPort:
        problem = _PROBLEMS.get(error.errno or 0, str(error.strerror))
        return self._lost(problem.format(channel=self._channel))


def _opened(channel: str, bit_rate: int, name: str) -> socket.socket:
    try:
        opened = socket.socket(socket.AF_CAN, socket.SOCK_RAW | socket.SOCK_NONBLOCK, socket.CAN_RAW)
    except (OSError, AttributeError) as error:
        raise PortError(
            f"cannot open {name}: this kernel has no SocketCAN ({error}); load it with "
            "`sudo modprobe can-raw`, or run the command in tools/with-vcan"
        ) from error
    try:
        # Of the controller's reports only bus-off: the others would wake the program without a use.
        opened.setsockopt(socket.SOL_CAN_RAW, _ERROR_FILTER, _BUS_OFF)
        opened.bind((channel,))
        # An interface that is down can be bound; its error waits at the socket.
        down = opened.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
    except OSError as error:
        opened.close()
        raise PortError(f"cannot open {name}: {_refusal(channel, error)}") from error
    if down:
        opened.close()
        kind = "" if channel.startswith("vcan") else f" type can bitrate {bit_rate}"
        remedy = f"bring it up with `sudo ip link set {channel} up{kind}`"
        raise PortError(f"cannot open {name}: the interface is down; {remedy}")
    return opened


def _refusal(channel: str, error: OSError) -> str:
    if error.errno != errno.ENODEV:
        return str(error.strerror or error)
    if channel.startswith("vcan"):
        return (
            f"no such device; create it with `sudo ip link add dev {channel} type vcan && "
            f"sudo ip link set {channel} up`"
        )
    return "no such device; is the adapter plugged in? `ip link` lists the interfaces"
