"""Answers serial commands: on the drive's own objects at once, for anything on the bus by way of the gateway.

Sources: EPOS Communication Guide, October 2006 (EPOS1), and maxon's command library. Where they are silent:
the port works in every NMT state; a command to all nodes is one to the drive on the line, too; a
frame that the host puts on the bus by SendCANFrame is not received by that drive itself.
"""

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.serial.can_gateway import CanGateway, DriveOnBus, Result
from emulators.epos2.serial.segmented_transfer import SegmentedTransfer
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.cia301 import ALL_NODES, LAST_NODE, NmtCommand
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import Frame
from firmware_bridge.families.epos2.maxon.messages import Done, Request, address_of
from firmware_bridge.families.epos2.maxon.opcodes import (
    decode_request,
    encode_answer,
    encode_refusal,
    row_of,
)
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import MAX_PAYLOAD, STANDARD_MASK

_Carried: TypeAlias = Mapping[type[Request], Callable[[Any, Nanoseconds], Result]]


class SerialServer:
    """Server of one command at a time; its answers come from `begin`, `receive` or `wake`."""

    def __init__(self, store: ObjectStore, profile: DeviceProfile, drive: DriveOnBus) -> None:
        self.gateway = CanGateway(profile, drive)
        self._store = store
        self._profile = profile
        self._drive = drive
        self._transfer = SegmentedTransfer(store)
        self._segments_go_out = False
        self._request: Request | None = None
        self._carried: _Carried = {
            messages.ReadObject: self._read,
            messages.WriteObject: self._write,
            messages.InitiateSegmentedRead: self._begin_read,
            messages.InitiateSegmentedWrite: self._begin_write,
            messages.SegmentRead: self._read_segment,
            messages.SegmentWrite: self._write_segment,
            messages.SendNmtService: self._command,
            messages.SendCanFrame: self._send_frame,
            messages.RequestCanFrame: self._request_frame,
            messages.SendLssFrame: self._send_lss,
            messages.ReadLssFrame: self.gateway.read_lss,
        }

    def begin(self, frame: Frame, now: Nanoseconds) -> bytes | None:
        """Carry out a command; return the answer's data, or None while the gateway waits for its own."""
        self._request = request = decode_request(frame)
        if request is None:
            return encode_refusal(frame.opcode, AbortCode.ILLEGAL_COMMAND)
        try:
            result = self._carried[type(request)](request, now)
        except SdoAbort as abort:
            result = abort.code
        return self._body(result)

    def receive(self, address: int, payload: bytes) -> bytes | None:
        """Take a frame of the bus; return the answer that it completes."""
        return self._body(self.gateway.receive(address, payload))

    def wake(self, now: Nanoseconds) -> bytes | None:
        """Do what is due; return the answer where waiting has ended."""
        return self._body(self.gateway.wake(now))

    def _body(self, result: Result) -> bytes | None:
        request = self._request
        if result is None or request is None:
            return None
        self._request = None
        if isinstance(result, int):
            return encode_refusal(row_of(request).opcode, result)
        return encode_answer(request, result)

    # Objects

    def _is_own(self, node: int) -> bool:
        return node in {0, self._drive.node()}

    def _read(self, request: messages.ReadObject, now: Nanoseconds) -> Result:
        if not self._is_own(request.node):
            return self.gateway.ask(request, now)
        raw = self._store.read(address_of(request))
        if len(raw) > len(self._profile.beyond_size):
            raise SdoAbort(self._profile.too_long_to_read, address_of(request))
        # Always four bytes of data: with fewer, maxon's library reports a framing error.
        return messages.ObjectRead(0, raw + self._profile.beyond_size[len(raw) :])

    def _write(self, request: messages.WriteObject, now: Nanoseconds) -> Result:
        if not self._is_own(request.node):
            return self.gateway.ask(request, now)
        address = address_of(request)
        size = self._store.row(address).type.size
        # WriteObject carries four bytes, low byte first, whatever the object's size.
        self._store.write(address, request.raw[:size] if size else request.raw)
        self._drive.written()
        return Done(0)

    def _begin_read(self, request: messages.InitiateSegmentedRead, now: Nanoseconds) -> Result:
        self._end_transfers(goes_out=not self._is_own(request.node))
        if self._segments_go_out:
            return self.gateway.ask(request, now)
        self._transfer.begin_read(address_of(request))
        return Done(0)

    def _begin_write(self, request: messages.InitiateSegmentedWrite, now: Nanoseconds) -> Result:
        self._end_transfers(goes_out=not self._is_own(request.node))
        if self._segments_go_out:
            return self.gateway.ask(request, now)
        self._transfer.begin_write(address_of(request), request.length)
        return Done(0)

    def _read_segment(self, request: messages.SegmentRead, now: Nanoseconds) -> Result:
        if self._segments_go_out:
            return self.gateway.ask(request, now)
        return self._transfer.read(request)

    def _write_segment(self, request: messages.SegmentWrite, now: Nanoseconds) -> Result:
        if self._segments_go_out:
            return self.gateway.ask(request, now)
        taken = self._transfer.write(request)
        self._drive.written()
        return taken

    def _end_transfers(self, *, goes_out: bool) -> None:
        self._transfer.end()
        self.gateway.end_transfer()
        self._segments_go_out = goes_out

    # The bus

    def _command(self, request: messages.SendNmtService, _now: Nanoseconds) -> Result:
        if request.node > LAST_NODE:
            raise SdoAbort(AbortCode.WRONG_NODE)
        if request.command not in set(NmtCommand):
            raise SdoAbort(AbortCode.RANGE)
        payload = cia301.encode_nmt(NmtCommand(request.command), request.node)
        own = self._drive.node()
        if request.node != own:
            self._drive.send(cia301.NMT, payload)
        # A CAN node does not receive its own frames: a command to all is delivered to this drive here.
        if request.node in {ALL_NODES, own}:
            self._drive.receive(cia301.NMT, payload)
        return Done(0)

    def _send_frame(self, request: messages.SendCanFrame, _now: Nanoseconds) -> Result:
        if request.identifier > STANDARD_MASK:
            raise SdoAbort(AbortCode.WRONG_NODE)
        if request.length > MAX_PAYLOAD:
            raise SdoAbort(AbortCode.LENGTH)
        self._drive.send(request.identifier, request.raw[: request.length])
        return Done(0)

    def _request_frame(self, request: messages.RequestCanFrame, now: Nanoseconds) -> Result:
        return self.gateway.request_frame(request, now)

    def _send_lss(self, request: messages.SendLssFrame, _now: Nanoseconds) -> Result:
        self.gateway.send_lss(request.raw)
        # As with NMT: this drive is an LSS slave, too, and does not receive its own frame.
        self._drive.receive(cia301.LSS_REQUEST, request.raw)
        return Done(0)
