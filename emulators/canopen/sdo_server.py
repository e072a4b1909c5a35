"""SDO server of a device: expedited and segmented transfers onto the object store; each request is answered.

Source: CiA 301 v4.02, service data object. Block transfer is optional and does not exist here; it gets
0x05040001, as each unknown command does. Where it is silent:

* Short frames are read as far as they go. One that ends before its sub-index is an unknown command (missing
  address bytes count as 0); missing data bytes are 0x06070013. Public scripts send downloads with 6 bytes.
* Without a size in the frame (0x22) the object takes its bytes from the front; the others do not count.
* A new request while a transfer runs replaces it. The server has no time-out of its own.
* An abort from the client is not answered.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from emulators.canopen.object_store import LARGEST_DOMAIN, ObjectStore
from firmware_bridge.canopen import sdo
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address

_Answers: TypeAlias = Mapping[type[sdo.Request], Callable[..., bytes | None]]
_WITHOUT_ADDRESS: Final = (sdo.UploadSegmentRequest, sdo.SdoSegment)


@dataclass(slots=True)
class _Upload:
    address: Address
    rest: bytes
    toggle: bool = False


@dataclass(slots=True)
class _Download:
    address: Address
    size: int | None
    taken: bytearray = field(default_factory=bytearray)
    toggle: bool = False


class SdoServer:
    """One channel, one transfer at a time."""

    def __init__(self, store: ObjectStore) -> None:
        self._store = store
        self._transfer: _Upload | _Download | None = None
        self._answers: _Answers = {
            sdo.UploadRequest: self._start_upload,
            sdo.DownloadRequest: self._start_download,
            sdo.UploadSegmentRequest: self._next_segment,
            sdo.SdoSegment: self._take_segment,
            sdo.Abort: self._give_up,
            sdo.Unknown: self._refuse,
        }

    def reset(self) -> None:
        """Forget a transfer that is under way."""
        self._transfer = None

    def answer(self, payload: bytes) -> bytes | None:
        """Return the answer to a client's frame; None to an abort, which wants none."""
        request = sdo.decode_request(payload)
        running = self._transfer
        try:
            return self._answers[type(request)](request)
        except SdoAbort as abort:
            self._transfer = None
            if isinstance(request, _WITHOUT_ADDRESS):
                # A segment carries no address: the abort names the object of the transfer.
                return sdo.encode_abort(sdo.NOWHERE if running is None else running.address, abort.code)
            return sdo.encode_abort(request.address, abort.code)

    def _give_up(self, _request: sdo.Abort) -> None:
        self._transfer = None

    def _refuse(self, request: sdo.Unknown) -> bytes:
        raise SdoAbort(AbortCode.UNKNOWN_COMMAND, request.address)

    def _start_upload(self, request: sdo.UploadRequest) -> bytes:
        self._transfer = None
        raw = self._store.read(request.address)
        # An expedited response can code 1 to 4 bytes, so that an empty domain goes by segments.
        if not 0 < len(raw) <= sdo.EXPEDITED:
            self._transfer = _Upload(request.address, raw)
        return sdo.encode_upload_response(request.address, raw)

    def _next_segment(self, request: sdo.UploadSegmentRequest) -> bytes:
        transfer = self._transfer
        if not isinstance(transfer, _Upload):
            raise SdoAbort(AbortCode.UNKNOWN_COMMAND)
        if request.toggle is not transfer.toggle:
            raise SdoAbort(AbortCode.TOGGLE, transfer.address)
        chunk, transfer.rest = transfer.rest[: sdo.SEGMENT], transfer.rest[sdo.SEGMENT :]
        transfer.toggle = not transfer.toggle
        last = not transfer.rest
        if last:
            self._transfer = None
        return sdo.encode_upload_segment_response(chunk, toggle=request.toggle, last=last)

    def _start_download(self, request: sdo.DownloadRequest) -> bytes:
        self._transfer = None
        address, raw, size = request.address, request.raw, request.size
        # The usual case, expedited with its size: the store checks everything.
        if raw is not None and len(raw) == size:
            self._store.write(address, raw)
            return sdo.encode_download_response(address)
        # Refused at the announcement, not after the last segment.
        self._store.check_writable(address, size)
        if raw is None:
            self._transfer = _Download(address, size)
        else:
            self._store.write(address, self._expedited(address, raw, size))
        return sdo.encode_download_response(address)

    def _expedited(self, address: Address, raw: bytes, size: int | None) -> bytes:
        if size is not None:
            if len(raw) < size:
                raise SdoAbort(AbortCode.TOO_SHORT, address)
            return raw
        wanted = self._store.row(address).type.size
        return raw[:wanted] if wanted else raw

    def _take_segment(self, segment: sdo.SdoSegment) -> bytes:
        transfer = self._transfer
        if not isinstance(transfer, _Download):
            raise SdoAbort(AbortCode.UNKNOWN_COMMAND)
        if segment.toggle is not transfer.toggle:
            raise SdoAbort(AbortCode.TOGGLE, transfer.address)
        transfer.toggle = not transfer.toggle
        transfer.taken += segment.raw
        # CiA 301 permits a download without an announced size: only the domain's capacity bounds it.
        most = LARGEST_DOMAIN if transfer.size is None else transfer.size
        if len(transfer.taken) > most:
            code = AbortCode.OUT_OF_MEMORY if transfer.size is None else AbortCode.TOO_LONG
            raise SdoAbort(code, transfer.address)
        if segment.last:
            self._finish(transfer)
        return sdo.encode_download_segment_response(toggle=segment.toggle)

    def _finish(self, transfer: _Download) -> None:
        if transfer.size is not None and len(transfer.taken) < transfer.size:
            raise SdoAbort(AbortCode.TOO_SHORT, transfer.address)
        self._store.write(transfer.address, bytes(transfer.taken))
        self._transfer = None
