"""Objects of CANopen nodes that are read and written over a serial line, explained as on a bus.

A command that reads or writes an object, sends a network command or a frame, is put as the frames that it
stands for; what watches a bus watches them.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.explain import kinds
from firmware_bridge.explain.drive_state import FAULTS
from firmware_bridge.explain.explainer import BusExplainer, Setup
from firmware_bridge.explain.incident import Incident
from firmware_bridge.explain.line_texts import OBJECT_ANSWER
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import REMOTE

_OBJECT: Final = re.compile(
    r"(?P<what>ReadObject|WriteObject): 0x(?P<index>[0-9A-F]{4})(?::(?P<sub>[0-9A-F]{2}))?"
    r".*?, node (?P<node>\d+)(?:, raw (?P<raw>[0-9A-F ]+))?$"
)
_NETWORK: Final = re.compile(r"SendNMTService: node (?P<node>\d+), command (?P<command>\d+)$")
_FRAME: Final = re.compile(
    r"(?P<what>Send|Request)CANFrame: identifier (?P<id>\d+), length (?P<length>\d)"
    r"(?:, raw (?P<raw>[0-9A-F ]+))?$"
)
_UPLOAD, _DOWNLOAD, _ABORT = 0x40, 0x23, 0x80
_READ, _WRITTEN = 0x43, 0x60
_TIMEOUT: Final = 0x0504_0000
"""Abort code of a gateway whose node has not answered."""
_ERRORS: Final = (bytes((0x03, 0x10, 0x01)), bytes((0x3F, 0x60, 0x00)))
"""Error history (1) and error code, as a request has them."""
_BITS: Final = 100_000_000
"""No bus has these frames: its load is not judged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Waiting:
    """A command whose answer has not come."""

    read: bool = True
    node: int = 0
    multiplexer: bytes = b""
    identifier: int = 0
    length: int = 0


class Objects:
    """The nodes behind one line."""

    def __init__(self, setup: Setup, link: str) -> None:
        self._bus = BusExplainer(
            Setup(bit_rate=_BITS, device=setup.device, sheet=setup.sheet, expected=setup.expected), link
        )
        self._waiting: _Waiting | None = None
        self._used = False
        self._codes: dict[int, tuple[int, Nanoseconds]] = {}
        """The last error of each node, and since when it is in fault."""

    @property
    def found(self) -> Sequence[Incident]:
        """The incidents of the nodes."""
        return self._bus.state.incidents.found if self._used else ()

    @property
    def nodes(self) -> Sequence[int]:
        """Nodes that have answered."""
        return [node.node for node in self._bus.state.nodes.values() if node.seen] if self._used else []

    @property
    def remarks(self) -> Sequence[str]:
        """What looked like an incident at a node, and is none."""
        return self._bus.state.remarks

    def requested(self, at: Nanoseconds, text: str) -> None:
        """Take a request."""
        self._waiting = None
        found = _OBJECT.match(text)
        if found is not None:
            self._object(at, found)
            return
        found = _NETWORK.match(text)
        if found is not None:
            self._put(at, cia301.NMT, bytes((int(found["command"]) & 0xFF, int(found["node"]) & 0x7F)))
            return
        found = _FRAME.match(text)
        if found is None:
            return
        identifier, length = int(found["id"]) & 0x7FF, min(int(found["length"]), 8)
        if found["what"] == "Send":
            self._put(at, identifier, bytes.fromhex(found["raw"] or "")[:length])
        else:
            self._put(at, identifier | REMOTE, bytes(length))
            self._waiting = _Waiting(identifier=identifier, length=length)

    def _object(self, at: Nanoseconds, found: re.Match[str]) -> None:
        node = int(found["node"]) & 0x7F or 1
        multiplexer = int(found["index"], 16).to_bytes(2, "little") + bytes((int(found["sub"] or "0", 16),))
        read = found["what"] == "ReadObject"
        raw = b"" if read else bytes.fromhex(found["raw"] or "")
        command = _UPLOAD if read else _DOWNLOAD
        self._waiting = _Waiting(read=read, node=node, multiplexer=multiplexer)
        self._put(at, cia301.SDO_REQUEST + node, bytes((command,)) + multiplexer + raw.ljust(4, b"\0")[:4])

    def answered(self, at: Nanoseconds, value: str) -> None:
        """Take the answer to the last request."""
        waiting, self._waiting = self._waiting, None
        found = OBJECT_ANSWER.match(value)
        if waiting is None or found is None:
            return
        error, raw = int(found["error"]), bytes.fromhex(found["raw"] or "")
        if waiting.identifier:
            if not error:
                self._put(at, waiting.identifier, raw[: waiting.length])
            return
        answer = cia301.SDO_RESPONSE + waiting.node
        if error:
            # The gateway has answered, not the node.
            by_gateway = error == _TIMEOUT
            address = cia301.SDO_REQUEST + waiting.node if by_gateway else answer
            self._put(at, address, bytes((_ABORT,)) + waiting.multiplexer + error.to_bytes(4, "little"))
            return
        command = _READ if waiting.read else _WRITTEN
        payload = bytes((command,)) + waiting.multiplexer + raw.ljust(4, b"\0")[:4]
        self._put(at, answer, payload)
        if waiting.read and waiting.multiplexer in _ERRORS:
            self._error(at, waiting.node, answer, payload)

    def _error(self, at: Nanoseconds, node: int, address: int, payload: bytes) -> None:
        """Take an error code that was read: no emergency comes over such a line."""
        code = int.from_bytes(payload[4:6], "little")
        state = self._bus.state.node(node)
        if not code or state.drive.state not in FAULTS or self._codes.get(node) == (code, state.left_at):
            return
        self._codes[node] = (code, state.left_at)
        self._put(at, cia301.EMERGENCY + node, payload[4:6].ljust(8, b"\0"))
        emergency = self._bus.state.incidents.recent(kinds.EMERGENCY, at, node)
        if emergency is not None and emergency.at == at:
            emergency.what = (
                f"error history: {emergency.what.removeprefix('EMCY ').partition('; error register')[0]}"
            )
            emergency.evidence = self._bus.state.evidence(at, address, payload)

    def _put(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        self._used = True
        self._bus.take(at, address, payload)

    def end(self, now: Nanoseconds) -> None:
        """Judge what the recording ends with."""
        if self._used:
            self._bus.state.now = max(self._bus.state.now, now)
            self._bus.end()
