"""The gateway: what a serial host wants from the CAN bus, one request at a time, each with its time-out.

Sources: EPOS2 Application Notes Collection, April 2013, p. 11-162 to 168, which gives what it costs; EPOS
Communication Guide, October 2006 (EPOS1), for CAN frames and layer setting services. Assumed: the cost falls
on SDO only, and no abort goes to a node that has not answered in time.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.serial.remote import Remote
from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.messages import Answer, FrameRead, Request
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire.can import MAX_PAYLOAD, REMOTE, STANDARD_MASK


@dataclass(frozen=True, slots=True)
class DriveOnBus:
    """The drive's own side, and the CAN bus that it is on."""

    node: Callable[[], int]
    """The drive's own node number."""
    send: Callable[[int, bytes], None]
    """Put a frame on the bus."""
    receive: Callable[[int, bytes], None]
    """Deliver a frame to the drive as if it came from the bus: a command to all is one to itself, too."""
    written: Callable[[], None]
    """Inform the drive that an object has a new value."""


NO_NODE: Final = -1
Result: TypeAlias = Answer | int | None
"""An answer, an error code, or nothing yet."""


class CanGateway:
    """Gateway that executes requests on the bus."""

    def __init__(self, profile: DeviceProfile, drive: DriveOnBus) -> None:
        self.awaits = NO_NODE
        """The identifier of the frame that the request waits for."""
        self.due: Nanoseconds = NEVER
        """Next time to call `wake`."""
        self._profile = profile
        self._drive = drive
        self._remote = Remote(profile)
        self._request: Request | None = None
        self._leaving: tuple[int, bytes] | None = None
        self._lss: bytes | None = None
        self._receives_lss = False

    def listens(self, address: int) -> bool:
        """Return whether a frame of this identifier is of interest."""
        return address == self.awaits or (address == cia301.LSS_RESPONSE and self._receives_lss)

    def ask(self, request: Request, now: Nanoseconds) -> Result:
        """Begin to ask another node; its answer where that is here already; SdoAbort."""
        kept = self._remote.kept(request)
        if kept is not None:
            return kept
        node, payload = self._remote.ask(request)
        self._begin(request, cia301.SDO_RESPONSE + node, now + self._profile.gateway_latency)
        # Not sent yet: the gateway costs 130 us, measured by maxon (Application Notes, p. 168).
        self._leaving = (cia301.SDO_REQUEST + node, payload)
        return self.wake(now)

    def request_frame(self, request: messages.RequestCanFrame, now: Nanoseconds) -> Result:
        """Send a remote frame, and wait for the answer; SdoAbort."""
        if request.identifier > STANDARD_MASK:
            raise SdoAbort(AbortCode.WRONG_NODE)
        if request.length > MAX_PAYLOAD:
            raise SdoAbort(AbortCode.LENGTH)
        self._begin(request, request.identifier, now + self._profile.gateway_timeout)
        self._drive.send(request.identifier | REMOTE, bytes(request.length))
        # This drive's own answer comes back at once, through `receive`.
        self._drive.receive(request.identifier | REMOTE, bytes(request.length))
        return None

    def send_lss(self, payload: bytes) -> None:
        """Send a request to the LSS slaves; forget their earlier answers."""
        # An answer to an earlier request must not pass for one to this.
        self._lss, self._receives_lss = None, True
        self._drive.send(cia301.LSS_REQUEST, payload)

    def read_lss(self, request: messages.ReadLssFrame, now: Nanoseconds) -> Result:
        """Return a slave's answer received since, or wait for it."""
        frame, self._lss = self._lss, None
        if frame is not None:
            return _frame(frame)
        self._begin(request, cia301.LSS_RESPONSE, now + request.timeout * MILLISECOND)
        return self.wake(now)

    def wake(self, now: Nanoseconds) -> Result:
        """Send the frame whose time has come, or give up."""
        if self.due > now:
            return None
        leaving, self._leaving = self._leaving, None
        if leaving is None:
            # The second deadline: the frame has been sent, and its answer has not come (0x05040000).
            self._end()
            return AbortCode.TIMEOUT
        self.due = now + self._profile.gateway_timeout
        self._drive.send(*leaving)
        return None

    def receive(self, address: int, payload: bytes) -> Result:
        """Take a frame of the bus that `listens` has let through."""
        request = self._request
        # Before the request is on the bus, a response with this identifier is another client's.
        if address != self.awaits or request is None or self._leaving is not None:
            if address == cia301.LSS_RESPONSE and self._lss is None:
                self._lss = payload
            return None
        if isinstance(request, messages.RequestCanFrame | messages.ReadLssFrame):
            self._end()
            return _frame(payload)
        response = sdo.decode_response(payload)
        result: Result = self._remote.read(request, response)
        if result is None:
            part = self._remote.part()
            if part is not None:
                # The host's segment of 8 bytes is 7 + 1 on the bus:
                # the second frame waits for the first response.
                self._drive.send(address - cia301.SDO_RESPONSE + cia301.SDO_REQUEST, part)
            return None
        complaint = self._remote.complaint(request, response)
        self._end()
        if complaint is not None and isinstance(response, sdo.UploadResponse):
            # The server has begun a segmented upload that ReadObject
            # cannot fetch: it must not wait for segments.
            server = address - cia301.SDO_RESPONSE + cia301.SDO_REQUEST
            self._drive.send(server, sdo.encode_abort(response.address, complaint))
            return complaint
        return result

    def end_transfer(self) -> None:
        """Forget a segmented transfer that is under way."""
        self._remote.end()

    def _begin(self, request: Request, awaits: int, due: Nanoseconds) -> None:
        self._request, self.awaits, self.due = request, awaits, due

    def _end(self) -> None:
        self._request = self._leaving = None
        self.awaits, self.due = NO_NODE, NEVER


def _frame(payload: bytes) -> FrameRead:
    return FrameRead(0, payload.ljust(MAX_PAYLOAD, b"\0"))
