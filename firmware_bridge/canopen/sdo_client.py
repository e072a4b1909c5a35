"""SDO client of one node: one transfer in flight, a timeout, a bounded number of attempts.

The meaning of an object and the carrier of its frames are not known here: bytes in, bytes out, time as an
argument.

Source: CiA 301 v4.02, service data object. Uploads of any length; downloads of up to four bytes, more than
any object that the bridge writes.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.abort import AbortCode, meaning_of
from firmware_bridge.canopen.address import Address
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

TIMEOUT: Final[Nanoseconds] = 200 * MILLISECOND
"""For one answer; the drive itself needs less than a millisecond (EPOS2 Application Notes, p. 168)."""
ATTEMPTS: Final = 2
LARGEST_UPLOAD: Final = 1024
"""Most bytes of an upload; more than any object that an EPOS2 has, the data recorder aside."""


@dataclass(frozen=True, slots=True)
class Transfer:
    """One object to read, or to write when `raw` (1 to 4 bytes) is given."""

    address: Address
    raw: bytes | None = None
    attempts: int = ATTEMPTS

    def __str__(self) -> str:
        """Say it for people."""
        return f"SDO {'upload' if self.raw is None else 'download'} {self.address}"


class SdoError(Exception):
    """A transfer that did not succeed; `transfer` is the one."""

    def __init__(self, transfer: Transfer, problem: str) -> None:
        super().__init__(transfer, problem)
        self.transfer = transfer
        self.problem = problem

    def __str__(self) -> str:
        """Say it in one line, without the node's number: its owner knows the name."""
        return self.problem


class SdoTimeoutError(SdoError):
    """The node did not answer."""

    def __init__(self, transfer: Transfer, waited: Nanoseconds) -> None:
        super().__init__(transfer, f"no answer to {transfer} within {waited // MILLISECOND} ms")


class SdoRefusedError(SdoError):
    """The node answered with an abort."""

    def __init__(self, transfer: Transfer, code: int) -> None:
        super().__init__(transfer, f"{transfer} was refused with {meaning_of(code)}")
        self.code = code


class SdoProtocolError(SdoError):
    """The node's answer breaks the protocol."""

    def __init__(self, transfer: Transfer, what: str) -> None:
        super().__init__(transfer, f"the answer to {transfer} breaks the protocol: {what}")


Outcome: TypeAlias = bytes | SdoError
"""The bytes read (empty after a download), or the failure."""


class SdoClient:
    """The transfers of one node, one after the other."""

    def __init__(self, timeout: Nanoseconds = TIMEOUT) -> None:
        self._timeout = timeout
        self._transfer: Transfer | None = None
        self._outcome: Outcome | None = None
        self._attempts_left = 0
        self._gathered: bytearray | None = None
        self._toggle = False
        self.wake_at: Nanoseconds = NEVER
        """Time when the answer is late; `NEVER` while nothing is in flight."""

    @property
    def busy(self) -> bool:
        """True while a transfer is in flight."""
        return self._transfer is not None

    def start(self, transfer: Transfer, now: Nanoseconds) -> tuple[bytes, ...]:
        """Begin a transfer and return what to send; ValueError while another is in flight."""
        if self._transfer is not None:
            raise ValueError(f"{transfer} while {self._transfer} is in flight")
        if transfer.raw is not None and not 0 < len(transfer.raw) <= sdo.EXPEDITED:
            raise ValueError(f"{transfer} with {len(transfer.raw)} bytes; 1 to {sdo.EXPEDITED} are possible")
        self._transfer = transfer
        self._outcome = None
        self._attempts_left = transfer.attempts
        return self._ask(transfer, now)

    def take(self) -> Outcome | None:
        """Return the outcome of the transfer that just ended, once; None while there is none."""
        outcome, self._outcome = self._outcome, None
        return outcome

    def receive(self, payload: bytes, now: Nanoseconds) -> tuple[bytes, ...]:
        """Take one frame of the node's server and return what to send.

        Answers to other objects are late ones of a transfer that was given up; they are ignored.
        """
        transfer = self._transfer
        if transfer is None:
            return ()
        match sdo.decode_response(payload):
            # An abort without an address is a server's that did not understand the frame.
            case sdo.Abort(address, code) if address in (transfer.address, sdo.NOWHERE):
                return self._end(SdoRefusedError(transfer, code))
            case sdo.DownloadResponse(address) if transfer.raw is not None and address == transfer.address:
                return self._end(b"")
            case sdo.UploadResponse(address, raw, size) if (
                transfer.raw is None and address == transfer.address
            ):
                return self._begun(transfer, raw, size, now)
            case sdo.SdoSegment() as segment if self._gathered is not None:
                return self._gather(transfer, self._gathered, segment, now)
        return ()

    def wake(self, now: Nanoseconds) -> tuple[bytes, ...]:
        """Give up a late answer: try again, or end with `SdoTimeoutError`."""
        transfer = self._transfer
        if transfer is None or now < self.wake_at:
            return ()
        # The server gets the abort, too: else its transfer would stay open and refuse the next one.
        abort = sdo.encode_abort(transfer.address, AbortCode.TIMEOUT)
        if self._attempts_left:
            return (abort, *self._ask(transfer, now))
        self._end(SdoTimeoutError(transfer, transfer.attempts * self._timeout))
        return (abort,)

    def cancel(self) -> None:
        """Forget the transfer in flight; a late answer will be ignored."""
        self._end(b"")
        self._outcome = None

    def _ask(self, transfer: Transfer, now: Nanoseconds) -> tuple[bytes, ...]:
        self._attempts_left -= 1
        self._gathered = None
        self.wake_at = now + self._timeout
        if transfer.raw is None:
            return (sdo.encode_upload(transfer.address),)
        return (sdo.encode_download(transfer.address, transfer.raw),)

    def _begun(
        self, transfer: Transfer, raw: bytes | None, size: int | None, now: Nanoseconds
    ) -> tuple[bytes, ...]:
        if raw is not None:
            return self._end(raw)
        if size is not None and size > LARGEST_UPLOAD:
            return self._break(transfer, AbortCode.OUT_OF_MEMORY, f"{size} bytes are announced")
        self._gathered = bytearray()
        self._toggle = False
        self.wake_at = now + self._timeout
        return (sdo.encode_upload_segment(toggle=False),)

    def _gather(
        self, transfer: Transfer, gathered: bytearray, segment: sdo.SdoSegment, now: Nanoseconds
    ) -> tuple[bytes, ...]:
        # CiA 301: the toggle bit alternates; a repeated segment would be counted twice otherwise.
        if segment.toggle is not self._toggle:
            return self._break(transfer, AbortCode.TOGGLE, "the toggle bit did not alternate")
        # A server that sends empty segments for ever would keep the client busy for ever.
        if not segment.raw and not segment.last:
            what = "a segment has no data, and is not the last"
            return self._break(transfer, AbortCode.UNKNOWN_COMMAND, what)
        gathered += segment.raw
        # The announced size may be missing or wrong, so what came is counted.
        if len(gathered) > LARGEST_UPLOAD:
            return self._break(
                transfer, AbortCode.OUT_OF_MEMORY, f"it does not end after {len(gathered)} bytes"
            )
        if segment.last:
            return self._end(bytes(gathered))
        self._toggle = not self._toggle
        self.wake_at = now + self._timeout
        return (sdo.encode_upload_segment(toggle=self._toggle),)

    def _break(self, transfer: Transfer, code: AbortCode, what: str) -> tuple[bytes, ...]:
        self._end(SdoProtocolError(transfer, what))
        return (sdo.encode_abort(transfer.address, code),)

    def _end(self, outcome: Outcome) -> tuple[bytes, ...]:
        self._transfer = None
        self._outcome = outcome
        self._gathered = None
        self.wake_at = NEVER
        return ()


class NodeClient:
    """An SDO client whose requests are CAN frames; a `firmware_bridge.drivers.script_runner.ObjectClient`."""

    def __init__(self, link: str, node: int) -> None:
        """Take the name of the bus, and the node on it."""
        self._link = link
        self._node = node
        self._client = SdoClient()
        self.wake_at: Nanoseconds = NEVER
        """Time when the answer is late; an attribute, for it is read after every packet."""

    @property
    def busy(self) -> bool:
        """True while a transfer is in flight."""
        return self._client.busy

    def start(self, transfer: Transfer, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a transfer."""
        return self._requests(self._client.start(transfer, now))

    def receive(self, payload: bytes, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a frame of the node's SDO server."""
        return self._requests(self._client.receive(payload, now))

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Give up a late answer."""
        return self._requests(self._client.wake(now))

    def take(self) -> Outcome | None:
        """Return the outcome of the transfer that just ended, once."""
        return self._client.take()

    def cancel(self) -> None:
        """Forget the transfer in flight."""
        self._client.cancel()
        self.wake_at = self._client.wake_at

    def _requests(self, payloads: tuple[bytes, ...]) -> tuple[Packet, ...]:
        self.wake_at = self._client.wake_at
        return tuple(Packet(self._link, cia301.SDO_REQUEST + self._node, payload) for payload in payloads)
