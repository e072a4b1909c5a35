"""SDO transfers watched: what they write, refusals, answers that do not come, answers that come twice."""

from typing import Final

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.pdo import RECEIVE_PARAMETER, TRANSMIT_MAPPING
from firmware_bridge.explain import kinds
from firmware_bridge.explain.bus_state import BusState
from firmware_bridge.explain.drives import Drives
from firmware_bridge.explain.incident import Report
from firmware_bridge.explain.node_state import NodeState, Request
from firmware_bridge.explain.remedies import ABORT_CHECKS
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds

ANSWERED_WITHIN: Final[Nanoseconds] = SECOND
"""Time for the answer to an SDO request; clients wait 0.2 to 1 s."""
SAVED_WITHIN: Final[Nanoseconds] = 8 * SECOND
"""Time for storing parameters."""
TWICE_WITHIN: Final[Nanoseconds] = 50 * MILLISECOND
"""A second answer so shortly after the first is of another node."""
_PARAMETERS: Final = range(RECEIVE_PARAMETER, TRANSMIT_MAPPING + 0x200)
_FOLLOWED: Final = frozenset({0x1010, 0x1016, 0x1017, 0x1018, od.MODE.index})
_STORING: Final = frozenset({0x1010, 0x1011})
_DOWNLOAD, _UPLOAD, _ABORT = 1, 2, 4
"""Command specifiers, the first three bits of a request or an answer."""
_WRITTEN, _READ = 3, 2


class Transfers:
    """The SDO transfers of one bus."""

    def __init__(self, bus: BusState, drives: Drives) -> None:
        self._bus = bus
        self._drives = drives

    def requested(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take an SDO request."""
        node = self._bus.node(address & cia301.NODE_MASK)
        node.address(at, address, payload)
        if len(payload) < sdo.HEAD:
            return
        specifier = payload[0] >> 5
        target = Address(payload[1] | payload[2] << 8, payload[3])
        if specifier == _ABORT:
            self._aborted(at, address, payload, "the client gave up")
            node.request = None
        elif specifier in {_DOWNLOAD, _UPLOAD}:
            if node.request is not None:
                self._unanswered(node, at)
            if target.index in _PARAMETERS or target.index in _FOLLOWED:
                self._set_up(node, at, address, payload, target)
            write, stopped = specifier == _DOWNLOAD, node.network is NmtState.STOPPED
            node.request = Request(at, address, payload, target, write, stopped)

    def _set_up(
        self, node: NodeState, at: Nanoseconds, address: int, payload: bytes, target: Address
    ) -> None:
        """Follow a transfer that changes the reading of other frames."""
        self._bus.evidence(at, address, payload)
        if target.index in _PARAMETERS:
            self._bus.reader.changed()
        value = int.from_bytes(payload[sdo.HEAD : sdo.FRAME], "little")
        if payload[0] >> 5 != _DOWNLOAD:
            return
        if target == od.PRODUCER_HEARTBEAT:
            node.beats.set((value & 0xFFFF) * MILLISECOND)
        elif target.index == od.CONSUMER_HEARTBEAT_1.index and target.subindex:
            watched = value >> 16 & cia301.NODE_MASK
            waits = (value & 0xFFFF) * MILLISECOND
            self._bus.consumers[node.node, target.subindex] = (watched if waits else 0, waits)
            self._bus.controllers |= {watched} - {0}

    def answered(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a node's SDO answer."""
        node = self._bus.node(address & cia301.NODE_MASK)
        node.sent += 1
        node.sent_at = at
        if len(payload) < sdo.FRAME:
            return
        specifier, request = payload[0] >> 5, node.request
        target = Address(payload[1] | payload[2] << 8, payload[3])
        if specifier == _ABORT:
            self._aborted(at, address, payload, "")
            node.request = None
            return
        if specifier not in {_WRITTEN, _READ}:
            return
        if request is None:
            self._second_answer(node, at, address, payload, target)
            return
        if request.target != target:
            return
        node.request, node.answered = None, request
        if specifier == _WRITTEN and request.write:
            self._write(node, at, request)
        elif specifier == _READ:
            self._upload(node, at, address, payload, target)

    def _write(self, node: NodeState, at: Nanoseconds, request: Request) -> None:
        decoded = sdo.decode_request(request.payload)
        if not isinstance(decoded, sdo.DownloadRequest) or decoded.raw is None:
            return
        size, signed = self._bus.reader.type_of(node.node, decoded.address)
        raw = decoded.raw[:size] if size else decoded.raw
        value = int.from_bytes(raw, "little", signed=signed)
        self._drives.written(at, request.address, request.payload, node, ((decoded.address, value),))

    def _upload(
        self, node: NodeState, at: Nanoseconds, address: int, payload: bytes, target: Address
    ) -> None:
        if target == od.VENDOR_ID:
            self._bus.evidence(at, address, payload)
            self._bus.reader.changed()
        decoded = sdo.decode_response(payload)
        if isinstance(decoded, sdo.UploadResponse) and decoded.raw:
            size, signed = self._bus.reader.type_of(node.node, target)
            raw = decoded.raw[:size] if size else decoded.raw
            value = int.from_bytes(raw, "little", signed=signed)
            self._drives.reported(at, node, target, value, (address, payload))

    def _second_answer(
        self, node: NodeState, at: Nanoseconds, address: int, payload: bytes, target: Address
    ) -> None:
        last = node.answered
        if last is None or last.target != target or at - last.at > TWICE_WITHIN:
            return
        report = Report(
            what=f"two answers to one SDO request ({self._bus.reader.called(node.node, target)})",
            evidence=self._bus.evidence(at, address, payload),
            node=node.node,
            detail=address,
            causes=("two nodes have this node number",),
            check="the node numbers: DIP switches and 0x2000; unplug one node after the other",
        )
        self._bus.open(kinds.SECOND_PRODUCER, at, report)

    def _aborted(self, at: Nanoseconds, address: int, payload: bytes, by: str) -> None:
        number = address & cia301.NODE_MASK
        code = int.from_bytes(payload[sdo.HEAD : sdo.FRAME], "little")
        target = Address(payload[1] | payload[2] << 8, payload[3])
        if by and code == sdo.AbortCode.TIMEOUT:
            self._unanswered(self._bus.node(number), at)
            return
        prefix = f"{by}: " if by else ""
        report = Report(
            what=f"{prefix}{self._bus.reader.called(number, target)}: {sdo.meaning_of(code)}",
            evidence=self._bus.evidence(at, address, payload),
            node=number,
            detail=(target, code),
            causes=(sdo.meaning_of(code),),
            check=ABORT_CHECKS.get(code, ""),
        )
        self._bus.open(kinds.SDO_ABORT, at, report)

    def _unanswered(self, node: NodeState, at: Nanoseconds) -> None:
        request, node.request = node.request, None
        # Nodes that were never seen are reported together, at the end.
        if request is None or not node.seen:
            return
        causes: tuple[str, ...] = ()
        if request.stopped:
            causes = ("its NMT state is stopped: there it has no SDO",)
        elif node.silent or node.sent_at < request.at - 10 * SECOND:
            causes = (f"it was silent: its last frame came {to_seconds(at - node.sent_at):.1f} s before",)
        report = Report(
            what=f"no answer to a request for {self._bus.reader.called(node.node, request.target)} within "
            f"{(at - request.at) // MILLISECOND} ms",
            evidence=self._bus.evidence(request.at, request.address, request.payload),
            node=node.node,
            causes=(*causes, *kinds.SDO_TIMEOUT.causes) if causes else (),
        )
        self._bus.open(kinds.SDO_TIMEOUT, request.at, report)

    def tick(self, now: Nanoseconds) -> None:
        """Report answers that are overdue."""
        for node in self._bus.nodes.values():
            request = node.request
            if request is not None:
                wait = SAVED_WITHIN if request.target.index in _STORING else ANSWERED_WITHIN
                if now - request.at > wait:
                    self._unanswered(node, now)
