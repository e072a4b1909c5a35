"""Any CAN bus of python-can, and the configuration that python-can finds for it."""

import configparser
import contextlib
import logging
import socket
import threading
from collections import deque
from collections.abc import Mapping
from typing import Any, Final

import can

from firmware_bridge.runtime.ports import loopback_multicast
from firmware_bridge.runtime.ports.outbox import Outbox
from firmware_bridge.runtime.ports.port import BURST, LostPort, PortError
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import EXTENDED, REMOTE, identifier

# Without a handler its loggers would say on stderr what its exceptions say again.
can.log.addHandler(logging.NullHandler())

_SEND_S: Final = 0.02
_LISTEN_S: Final = 0.02
"""Period of a reader thread's look whether it shall end, in seconds."""
MULTICAST: Final = "udp_multicast"
"""A bus of datagrams: every process of one machine, or of one network, that has joined a group."""
DEFAULTS: Final[dict[str, dict[str, Any]]] = {
    loopback_multicast.NAME: {"channel": loopback_multicast.GROUP},
    # A hop limit of 0 never leaves the machine (RFC 1112, 6.1); python-can's own 1 reaches the local network.
    MULTICAST: {"channel": "239.74.163.2", "hop_limit": 0},
}
"""Default settings of an interface, where neither arguments nor configuration give them."""
CAUTIONS: Final = {
    MULTICAST: f"{MULTICAST} is no true bus: groups receive each other's frames, and a sender its own, so "
    f"that python-canopen stops its RPDOs; take -i {loopback_multicast.NAME}, with the master too",
}
"""Hints printed when an interface is opened."""
REMEDIES: Final = {
    MULTICAST: ". Its channel is a multicast group, as 239.74.163.2, to which this machine needs a route (`"
    f"ip route get 239.74.163.2` shows it); -i {loopback_multicast.NAME} needs none",
}
"""Remedies where an interface cannot be opened."""
UNMARKED_ECHO: Final = frozenset({MULTICAST})
"""Interfaces that bring a sender its own frames without saying that they are."""


def configuration(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return these settings with what python-can's configuration file and environment add; PortError."""
    try:
        found = can.util.load_config(config=dict(given))
    except (can.CanError, ValueError, TypeError, configparser.Error) as error:
        known = ", ".join(sorted(can.VALID_INTERFACES))
        what = f"cannot open CAN interface {given.get('interface')}"
        if "interface" not in given:
            what = "cannot open a CAN interface: none is given, nor one of use in python-can's configuration"
        raise PortError(f"{what}: {error}. The interfaces are: {known}") from error
    return dict(found)


class PythonCanPort(Outbox):
    """Any bus of python-can. A thread reads it only where its bus has no file to wait for."""

    def __init__(self, name: str, config: Mapping[str, Any]) -> None:
        super().__init__()
        self.name = name
        self._echoes = Echoes() if config.get("interface") in UNMARKED_ECHO else None
        self.ignored = 0
        """Error reports of the controller, CAN FD frames, and our own frames coming back."""
        try:
            self._bus = can.Bus(ignore_config=True, **config)
        except Exception as error:
            remedy = REMEDIES.get(config.get("interface", ""), "")
            raise PortError(f"cannot open {name}: {_why(error)}{remedy}") from error
        self._reader: _Reader | None = None
        fileno = -1
        with contextlib.suppress(NotImplementedError, can.CanError, OSError):
            # Some interfaces have no file, and each of them raises another exception.
            fileno = self._bus.fileno()
        if fileno < 0:
            self._reader = _Reader(self._bus, name)
            fileno = self._reader.fileno()
        self._fileno = fileno

    def fileno(self) -> int:
        """Return the bus's file, or the one on which the reader thread rings."""
        return self._fileno

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the frames that have arrived; LostPort where the bus is gone."""
        frames: list[tuple[int, bytes]] = []
        try:
            messages = self._reader.taken() if self._reader is not None else self._drained()
        except (can.CanError, OSError) as error:
            raise self._lost(_why(error)) from error
        for message in messages:
            if message.is_error_frame or message.is_fd or not message.is_rx:
                self.ignored += 1
                continue
            frame = _frame(message)
            if self._echoes is not None and self._echoes.takes(frame):
                self.ignored += 1
            else:
                frames.append(frame)
        if self._echoes is not None and len(messages) < BURST:
            self._echoes.drained()
        return frames

    def close(self) -> None:
        """End the reader and shut the bus down."""
        if self._reader is not None:
            self._reader.end()
        with contextlib.suppress(can.CanError, OSError):
            self._bus.shutdown()

    def _drained(self) -> list[can.Message]:
        messages = []
        for _ in range(BURST):
            message = self._bus.recv(timeout=0)
            if message is None:
                break
            messages.append(message)
        return messages

    def _send(self, address: int, payload: bytes) -> bool:
        message = can.Message(
            arbitration_id=identifier(address),
            is_extended_id=bool(address & EXTENDED),
            is_remote_frame=bool(address & REMOTE),
            dlc=len(payload),
            data=None if address & REMOTE else payload,
            is_rx=False,
            check=True,
        )
        try:
            self._bus.send(message, timeout=_SEND_S)
        except can.CanError:
            # A full queue and a dead adapter look alike here; time will show.
            return False
        except OSError as error:
            raise self._lost(_why(error)) from error
        if self._echoes is not None:
            self._echoes.expects((address, bytes(message.dlc) if address & REMOTE else bytes(payload)))
        return True

    def _lost(self, problem: str) -> LostPort:
        return LostPort(self, problem)


class Echoes:
    """Frames of one's own that a bus will bring back, in the order in which they went out.

    A foreign frame with the same content may be taken for one's own; then one's own is received in its place,
    so that as many are received as others have sent.
    """

    def __init__(self) -> None:
        self._sent: deque[tuple[int, bytes]] = deque()
        self._overdue = 0
        """So many of them were awaited when the bus was last read to its end."""

    def expects(self, frame: tuple[int, bytes]) -> None:
        """Take down a frame that was sent."""
        self._sent.append(frame)

    def takes(self, frame: tuple[int, bytes]) -> bool:
        """Return whether this is one's own; those that went out before it are lost then."""
        if frame not in self._sent:
            return False
        # Frames of one sender stay in order on a bus, so what went out before this one is lost.
        own = self._sent.index(frame) + 1
        for _ in range(own):
            self._sent.popleft()
        self._overdue = max(0, self._overdue - own)
        return True

    def drained(self) -> None:
        """Give up what has not come though the bus was read to its end twice: the kernel dropped it."""
        for _ in range(self._overdue):
            self._sent.popleft()
        self._overdue = len(self._sent)


class _Reader:
    """A thread that reads a bus, and rings a file for the thread that waits for frames."""

    def __init__(self, bus: can.BusABC, name: str) -> None:
        self._bus = bus
        self._received: deque[can.Message] = deque()
        self._failure: can.CanError | OSError | None = None
        self._ending = threading.Event()
        self._bell, self._rope = socket.socketpair()
        self._bell.settimeout(0)
        self._rope.settimeout(0)
        self._thread = threading.Thread(target=self._listen, name=name, daemon=True)
        self._thread.start()

    def fileno(self) -> int:
        """Return the file that can be read when frames have arrived."""
        return self._bell.fileno()

    def taken(self) -> list[can.Message]:
        """Return what has arrived; raise what ended the reading."""
        with contextlib.suppress(BlockingIOError):
            # All rings are taken, or the file would stay readable and the loop would never sleep.
            while len(self._bell.recv(4096)) == 4096:  # noqa: PLR2004 - more rings than one read takes
                pass
        messages = []
        while self._received:
            messages.append(self._received.popleft())
        if not messages and self._failure is not None:
            raise self._failure
        return messages

    def end(self) -> None:
        """End the thread and give the files back."""
        self._ending.set()
        self._thread.join()
        self._bell.close()
        self._rope.close()

    def _listen(self) -> None:
        while not self._ending.is_set() and self._failure is None:
            try:
                message = self._bus.recv(timeout=_LISTEN_S)
            except (can.CanError, OSError) as error:
                self._failure = error
            else:
                if message is None:
                    continue
                self._received.append(message)
            with contextlib.suppress(BlockingIOError):
                self._rope.send(b"\0")


def _frame(message: can.Message) -> tuple[int, bytes]:
    address = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
    if message.is_remote_frame:
        return address | REMOTE, bytes(message.dlc)
    return address, bytes(message.data)


def _why(error: BaseException) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    cause = error.__cause__ or error.__context__
    if isinstance(cause, OSError) and cause.strerror and cause.strerror not in text:
        text = f"{text}: {cause.strerror}"
    if isinstance(error, can.CanInterfaceNotImplementedError | ImportError | NameError):
        return f"{text}. Install the driver, or the library, that python-can needs for this interface"
    return text
