"""The drive's serial port as its node sees it: bytes and bus frames in, bytes out, and when to come back.

Sources: EPOS Firmware Specification for 0x2002 and 0x2005 (by analogy);
maxon's command library for the USB side, a converter at 1 MBd. Assumed: a time-out of 0 means its default.
"""

from collections.abc import Mapping
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.device_profile import BAUDS, RS232_RATE, DeviceProfile
from emulators.epos2.serial.can_gateway import DriveOnBus
from emulators.epos2.serial.server import SerialServer
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.maxon.frame import DLE, Frame, Generation
from firmware_bridge.families.epos2.maxon.lines import device_end
from firmware_bridge.families.epos2.maxon.opcodes import COMMANDS, acknowledged
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

USB_BAUD: Final = 1_000_000
BITS_PER_BYTE: Final = 10
FRAME_TIMEOUTS: Final[Mapping[Generation, Address]] = {
    Generation.V1: Address(0x2005),
    Generation.V2: Address(0x2006),
}
"""Objects with each protocol's timeout, in ms."""
DEFAULT_TIMEOUT_MS: Final = 500


class SerialPort:
    """One port with one protocol, or with the one that its host begins with.

    A drive has two ports, RS232 for V1 and USB for V2; a line that may be either distinguishes them by the
    first byte: no opcode is DLE. From V2 back to V1 it wants silence before: between frames there is noise.
    """

    def __init__(
        self, store: ObjectStore, profile: DeviceProfile, generation: Generation | None, drive: DriveOnBus
    ) -> None:
        self.generation = generation or Generation.V1
        """Protocol in use; where that was left open, the one received from the host."""
        self._open: Final = generation is None
        self._received_at: Nanoseconds = 0
        self.baud = USB_BAUD
        """Bit rate on the line; on RS232 as 0x2002 was at the last start."""
        self._store = store
        self._latency = profile.serial_latency
        self._server = SerialServer(store, profile, drive)
        self._bad_checksum = profile.bad_checksum
        self._line = device_end(self.generation, self._timeout, self._bad_checksum)
        self._silent = False
        self._serving = False
        self._early: bytes | None = None
        self._held: bytes | None = None
        self._held_until: Nanoseconds = NEVER
        self._next_baud = self.baud
        self._baud_due: Nanoseconds = NEVER
        self.restart(0)
        # At power-on no byte is on the line: the rate counts at once.
        self.baud = self._next_baud

    def restart(self, now: Nanoseconds) -> None:
        """Take what counts from the drive's start on; the byte that is on the line leaves at the old rate."""
        if self.generation is Generation.V1:
            self._next_baud = BAUDS[self._store.get(RS232_RATE)]
            self._baud_due = now + 2 * BITS_PER_BYTE * SECOND // self.baud

    @property
    def due(self) -> Nanoseconds:
        """Next time to call `wake`."""
        return min(self._line.due, self._server.gateway.due, self._held_until, self._baud_due)

    def listens(self, address: int) -> bool:
        """Return whether a frame of the bus is of interest."""
        return self._server.gateway.listens(address)

    def taken(self) -> bytes:
        """Return what is to be sent to the host, once."""
        return self._line.taken()

    def receive(self, chunk: bytes, now: Nanoseconds) -> None:
        """Take bytes from the host; what is due is not late while they are still being fetched."""
        self._change_rate(now)
        if self._open and chunk:
            self._choose(Generation.V2 if chunk[0] == DLE else Generation.V1, now)
        self._serve(self._line.receive(chunk, now), now)

    def receive_frame(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Take a frame of the bus that `listens` has let through."""
        body = self._server.receive(address, payload)
        if self._serving:  # the drive itself has answered, before the command was done
            self._early = body
        else:
            self._answer(body, now)

    def wake(self, now: Nanoseconds) -> None:
        """Do what is due."""
        self._change_rate(now)
        self._line.wake(now)
        self._answer(self._server.wake(now), now)
        if self._held_until <= now:
            self._release(now)

    def _choose(self, spoken: Generation, now: Nanoseconds) -> None:
        """Take up another protocol where the host begins a command in it."""
        quiet = now - self._received_at >= self._timeout()
        self._received_at = now
        if spoken is not self.generation and self._line.idle and (quiet or spoken is Generation.V2):
            self.generation = spoken
            self._line = device_end(spoken, self._timeout, self._bad_checksum)

    def _change_rate(self, now: Nanoseconds) -> None:
        if self._baud_due <= now:
            self.baud, self._baud_due = self._next_baud, NEVER

    def _timeout(self) -> Nanoseconds:
        return (self._store.get(FRAME_TIMEOUTS[self.generation]) or DEFAULT_TIMEOUT_MS) * MILLISECOND

    def _serve(self, frame: Frame | None, now: Nanoseconds) -> None:
        """Carry out a command, and those that have waited behind it."""
        self._serving = True
        while frame is not None:
            row = COMMANDS.get(frame.opcode)
            # On V1 the library reads no response to 0x0E and 0x20: one would put it out of step.
            answered = row is None or self.generation in row.answered
            self._silent = not (answered and acknowledged(frame))
            body = self._server.begin(frame, now)
            early = self._early_answer()
            frame = self._say(early if body is None else body, now)
        self._serving = False

    def _early_answer(self) -> bytes | None:
        """Return the answer that came while its command was still being begun, once."""
        body, self._early = self._early, None
        return body

    def _answer(self, body: bytes | None, now: Nanoseconds) -> None:
        if body is not None:
            self._serve(self._say(body, now), now)

    def _say(self, body: bytes | None, now: Nanoseconds) -> Frame | None:
        """Give the line an answer that is there, now or when its time has come; return the next command."""
        if body is None:
            return None
        # Held back with the answer, not before the command: its effect is at once.
        if self._latency:
            self._held, self._held_until = body, now + self._latency
            return None
        return self._line.answer(None if self._silent else body, now)

    def _release(self, now: Nanoseconds) -> None:
        body, self._held = self._held, None
        self._held_until = NEVER
        self._serve(self._line.answer(None if self._silent else body, now), now)
