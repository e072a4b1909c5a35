"""One emulated servo and a master's requests to it, in virtual time."""

from collections.abc import Callable, Iterable
from typing import Final

from emulators.cia402.servo import Servo
from emulators.cia402.variations import traits_of
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import STATES, PowerState
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

NODE: Final = 5
COUNTS: Final = 2000
ABORT: Final = 0x80
"""Abort transfer (CiA 301)."""


class StartError(Exception):
    """The master gives up: what it reports."""


class Bus:
    """The servo, its motor, and the master's side of the bus."""

    def __init__(self, variations: Iterable[str] = ()) -> None:
        self._axis: Final = ServoAxis("a", COUNTS)
        set_winding(self._axis, MOTOR.torque_constant, MOTOR.resistance, MOTOR.inductance)
        self._bank: Final = ServoBank(DcMotors((MOTOR,)), [self._axis])
        self._servo: Final = Servo(NODE, self._axis, traits_of(variations))
        self.now: Nanoseconds = 0
        self.received: dict[int, bytes] = {}
        """The newest frame of each identifier."""
        self._wake_at: Nanoseconds = 0
        self._take(self._servo.wake(0))

    def waits(self, milliseconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Let time pass, or until this is true; return whether it was."""
        end = self.now + round(milliseconds * MILLISECOND)
        while not until():
            if self.now >= end:
                return False
            step = min(end, self.now + MILLISECOND, max(self.now + 1, self._wake_at))
            self.now, woken = self._bank.advance(step)
            if woken or self.now >= self._wake_at:
                self._take(self._servo.wake(self.now))
        return True

    def send(self, identifier: int, payload: bytes) -> None:
        """Put a frame on the bus."""
        self._take(self._servo.receive(Packet(CAN, identifier, payload), self.now))

    def command(self, nmt: cia301.NmtCommand) -> None:
        """Send a network command to the node."""
        self.received.pop(cia301.ERROR_CONTROL + NODE, None)
        self.send(cia301.NMT, cia301.encode_nmt(nmt, NODE))

    def read(self, address: Address) -> int:
        """Read an object; StartError for an abort."""
        head = address.index.to_bytes(2, "little") + bytes((address.subindex,))
        answer = self._answered(b"\x40" + head + bytes(4))
        size = 4 - (answer[0] >> 2 & 0b11) if answer[0] & 0b10 else 4
        return int.from_bytes(answer[4 : 4 + size], "little", signed=True)

    def write(self, address: Address, value: int, size: int) -> None:
        """Write an object; StartError for an abort."""
        specifier = 0x23 | (4 - size) << 2
        head = bytes((specifier, *address.index.to_bytes(2, "little"), address.subindex))
        raw = (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")
        self._answered(head + raw)

    def _answered(self, request: bytes) -> bytes:
        answers = cia301.SDO_RESPONSE + NODE
        self.received.pop(answers, None)
        self.send(cia301.SDO_REQUEST + NODE, request)
        if not self.waits(100, lambda: answers in self.received):
            raise StartError("no answer to SDO")
        answer = self.received[answers]
        if answer[0] == ABORT:
            address = Address(int.from_bytes(answer[1:3], "little"), answer[3])
            raise StartError(f"{address} refused with 0x{int.from_bytes(answer[4:], 'little'):08X}")
        return answer

    @property
    def booted(self) -> bool:
        """True where its boot-up message has come since the last network command."""
        return cia301.ERROR_CONTROL + NODE in self.received

    @property
    def state(self) -> PowerState | None:
        """Its power state, read by SDO."""
        return STATES.state_of(self.read(od.STATUSWORD) & 0xFFFF)

    def _take(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        for packet in reaction.sent:
            self.received[packet.address] = packet.payload
