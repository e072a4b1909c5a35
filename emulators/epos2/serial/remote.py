"""Serial commands as SDO frames of another node, and its answers as answers to the host.

Source: EPOS2 Application Notes Collection, April 2013, p. 11-162 to 168. Nothing is buffered, so a segment
carries seven bytes on the bus. Where they are silent:

* WriteObject, which always has four bytes, goes out as 0x22, expedited without a size; the server takes what
  the object has.
* A segment of eight bytes is divided, seven and one, and answered as eight: maxon's library sends each
record of
  an interpolated path so, and could not otherwise reach a drive behind the gateway. A longer one is refused:
  nothing is buffered.
* An object of up to four bytes that is read by segments waits here for the first of them.
* Answers to other clients of the same server are distinguished by the object's address.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.serial.segmented_transfer import payload_of
from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.messages import (
    Answer,
    Done,
    Request,
    address_of,
    control,
    toggle_of,
)

NodeFrame: TypeAlias = tuple[int, bytes]
"""A node's number, and what its SDO server is sent."""
_Asking: TypeAlias = Mapping[type[Request], Callable[[Any], NodeFrame]]
_Reading: TypeAlias = Mapping[type[Request], Callable[[Any, Any], Answer | None]]


@dataclass(slots=True)
class _RemoteTransfer:
    """A segmented transfer with another node."""

    node: int
    address: Address
    length: int = 0
    """Number of bytes that are still to be written."""
    kept: bytes | None = None
    """The whole object, where it was so short that it came at once."""
    toggle: bool = False
    """The next segment's toggle bit on the bus ..."""
    host_toggle: bool = False
    """... and from the host."""
    rest: bytes = b""
    """Remaining bytes that had no room in a frame."""
    leaves: bool = False
    """True if those bytes are to leave now."""


class Remote:
    """SDO client that remembers the segmented transfer under way."""

    def __init__(self, profile: DeviceProfile) -> None:
        self._profile = profile
        self._transfer: _RemoteTransfer | None = None
        self._requested: _Asking = {
            messages.ReadObject: self._upload,
            messages.WriteObject: self._download,
            messages.InitiateSegmentedRead: self._upload,
            messages.InitiateSegmentedWrite: self._announce,
            messages.SegmentRead: self._ask_segment,
            messages.SegmentWrite: self._send_segment,
        }
        self._read: _Reading = {
            messages.ReadObject: self._uploaded,
            messages.WriteObject: self._downloaded,
            messages.InitiateSegmentedRead: self._upload_begun,
            messages.InitiateSegmentedWrite: self._download_begun,
            messages.SegmentRead: self._segment_read,
            messages.SegmentWrite: self._segment_written,
        }

    def end(self) -> None:
        """Forget a transfer that is under way."""
        self._transfer = None

    def kept(self, request: Request) -> Answer | None:
        """Return the answer to a request that needs no frame; SdoAbort."""
        if not isinstance(request, messages.SegmentRead):
            return None
        transfer = self._under_way(toggle=toggle_of(request))
        if transfer.kept is None:
            return None
        self._transfer = None
        return messages.SegmentOut(0, control(len(transfer.kept), toggle=False), transfer.kept)

    def ask(self, request: Request) -> NodeFrame:
        """Return the frame for a request; SdoAbort where there can be none."""
        node, payload = self._requested[type(request)](request)
        if not cia301.FIRST_NODE <= node <= cia301.LAST_NODE:
            raise SdoAbort(AbortCode.WRONG_NODE)
        return node, payload

    def read(self, request: Request, response: sdo.Response) -> Answer | int | None:
        """Return the answer in a server's frame, or its abort code; None where it answers someone else."""
        if isinstance(response, sdo.Abort):
            if response.address not in self._addresses(request):
                return None
            self._transfer = None
            return response.code
        return self._read[type(request)](request, response)

    def part(self) -> bytes | None:
        """Return the frame with the rest of a divided segment, once the first part has been taken."""
        transfer = self._transfer
        if transfer is None or not transfer.leaves:
            return None
        transfer.leaves = False
        return self._next_part(transfer)

    def complaint(self, request: Request, response: sdo.Response) -> AbortCode | None:
        """Return the abort code for an answer that is of no use here; the server receives it."""
        too_long = isinstance(response, sdo.UploadResponse) and response.raw is None
        if isinstance(request, messages.ReadObject) and too_long:
            return self._profile.too_long_to_read
        return None

    def _addresses(self, request: Request) -> tuple[Address, ...]:
        if isinstance(request, messages.SegmentRead | messages.SegmentWrite):
            return (sdo.NOWHERE,) if self._transfer is None else (self._transfer.address, sdo.NOWHERE)
        return (address_of(request),) if isinstance(request, messages.ObjectRequest) else ()

    # Requests

    def _upload(self, request: messages.ReadObject | messages.InitiateSegmentedRead) -> NodeFrame:
        self._transfer = None
        return request.node, sdo.encode_upload(address_of(request))

    def _download(self, request: messages.WriteObject) -> NodeFrame:
        self._transfer = None
        return request.node, sdo.encode_download_unsized(address_of(request), request.raw)

    def _announce(self, request: messages.InitiateSegmentedWrite) -> NodeFrame:
        self._transfer = None
        return request.node, sdo.encode_download_announcement(address_of(request), request.length)

    def _ask_segment(self, request: messages.SegmentRead) -> NodeFrame:
        transfer = self._under_way(toggle=toggle_of(request))
        return transfer.node, sdo.encode_upload_segment(toggle=transfer.toggle)

    def _send_segment(self, request: messages.SegmentWrite) -> NodeFrame:
        transfer = self._under_way(toggle=toggle_of(request))
        chunk = payload_of(request)
        # 7 bytes fit in a CAN segment; 8, a PVT record, are divided for maxon's library.
        if len(chunk) > min(self._profile.gateway_segment, transfer.length):
            raise SdoAbort(AbortCode.TOO_LONG, transfer.address)
        transfer.rest = chunk
        return transfer.node, self._next_part(transfer)

    def _next_part(self, transfer: _RemoteTransfer) -> bytes:
        chunk, transfer.rest = transfer.rest[: sdo.SEGMENT], transfer.rest[sdo.SEGMENT :]
        transfer.length -= len(chunk)
        last = transfer.length == 0
        return sdo.encode_download_segment(chunk, toggle=transfer.toggle, last=last)

    def _under_way(self, *, toggle: bool) -> _RemoteTransfer:
        transfer = self._transfer
        if transfer is None:
            raise SdoAbort(AbortCode.UNKNOWN_COMMAND)
        if toggle is not transfer.host_toggle:
            self._transfer = None
            raise SdoAbort(AbortCode.TOGGLE, transfer.address)
        return transfer

    # What comes back

    def _uploaded(self, request: messages.ReadObject, response: sdo.Response) -> Answer | None:
        if not isinstance(response, sdo.UploadResponse) or response.address != address_of(request):
            return None
        raw = response.raw or b""
        return messages.ObjectRead(0, raw + self._profile.beyond_size[len(raw) :])

    def _downloaded(self, request: messages.WriteObject, response: sdo.Response) -> Answer | None:
        ours = isinstance(response, sdo.DownloadResponse) and response.address == address_of(request)
        return Done(0) if ours else None

    def _upload_begun(self, request: messages.InitiateSegmentedRead, response: sdo.Response) -> Answer | None:
        if not isinstance(response, sdo.UploadResponse) or response.address != address_of(request):
            return None
        self._transfer = _RemoteTransfer(request.node, response.address, kept=response.raw)
        return Done(0)

    def _download_begun(
        self, request: messages.InitiateSegmentedWrite, response: sdo.Response
    ) -> Answer | None:
        if not isinstance(response, sdo.DownloadResponse) or response.address != address_of(request):
            return None
        self._transfer = _RemoteTransfer(request.node, response.address, request.length)
        return Done(0)

    def _segment_read(self, _request: messages.SegmentRead, response: sdo.Response) -> Answer | None:
        transfer = self._transfer
        if transfer is None or not isinstance(response, sdo.SdoSegment):
            return None
        if response.toggle is not transfer.toggle:
            return None
        self._transfer = None if response.last else transfer
        transfer.toggle = transfer.host_toggle = not transfer.toggle
        head = control(len(response.raw), toggle=response.toggle, more=not response.last)
        return messages.SegmentOut(0, head, response.raw)

    def _segment_written(self, request: messages.SegmentWrite, response: sdo.Response) -> Answer | None:
        transfer = self._transfer
        if transfer is None or not isinstance(response, sdo.SegmentAccepted):
            return None
        if response.toggle is not transfer.toggle:
            return None
        transfer.toggle = not transfer.toggle
        if transfer.rest:
            transfer.leaves = True
            return None
        self._transfer = None if transfer.length == 0 else transfer
        taken = messages.SegmentTaken(0, control(len(payload_of(request)), toggle=transfer.host_toggle))
        # Once for each command; on the bus once for each frame, which may be two.
        transfer.host_toggle = not transfer.host_toggle
        return taken
