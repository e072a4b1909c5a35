"""Two drives on a CAN bus, the first one with a host on its serial port, all in virtual time."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.wires import CanWire, SerialWire, usb_line
from emulators.world import World
from firmware_bridge.families.epos2.maxon.frame import Failure, Generation, MaxonAnswer, Outcome
from firmware_bridge.families.epos2.maxon.lines import host_end
from firmware_bridge.families.epos2.maxon.messages import Answer, Request
from firmware_bridge.families.epos2.maxon.opcodes import decode_answer, encode_request, row_of
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.epos2.quiet_motion import QuietMotion

NEAR = 1
FAR = 2
NO_NODE = 99
DOMAIN = 0x201B
both = pytest.mark.parametrize("generation", Generation)
nodes = pytest.mark.parametrize("node", [0, NEAR, FAR], ids=["zero", "own", "gateway"])


def u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


class Host:
    """A computer on the serial line: it sends the given requests, and notes every byte."""

    def __init__(self, generation: Generation, timeout: Nanoseconds, baud: int) -> None:
        self.baud = baud
        self.generation = generation
        self.sent = b""
        self.received = b""
        self.begun_at: Nanoseconds = 0
        self.ended_at: Nanoseconds = 0
        self.outcome: Outcome | None = None
        self.due: Request | None = None
        self.raw = b""
        self._end = host_end(generation, timeout)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received += packet.payload
        self._note(self._end.receive(packet.payload, now), now)
        return self._reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        self._note(self._end.wake(now), now)
        if self.due is not None and now >= self._end.ready_at:
            answered = self.generation in row_of(self.due).answered
            self._end.ask(encode_request(self.due), now, answered=answered)
            self.due, self.begun_at = None, now
        return self._reaction()

    def stop(self, now: Nanoseconds) -> Reaction:
        """Send all output at once: the world has no other way to call a node."""
        return self.wake(now)

    def _note(self, outcome: Outcome | None, now: Nanoseconds) -> None:
        if outcome is not None:
            self.outcome, self.ended_at = outcome, now

    def _next(self) -> Nanoseconds:
        return self._end.due if self.due is None else self._end.ready_at

    def _reaction(self) -> Reaction:
        raw, self.raw = self.raw + self._end.taken(), b""
        self.sent += raw
        return Reaction((Packet(SERIAL, 0, raw),) if raw else (), self._next())


class SerialDesk:
    def __init__(
        self,
        generation: Generation,
        profile: DeviceProfile = EPOS2_70_10,
        *,
        near: int = NEAR,
        others: Sequence[tuple[str, Node]] = (),
        timeout: Nanoseconds = 5 * SECOND,
        baud: int | None = None,
        moving: bool = False,
    ) -> None:
        """With `moving` each drive has motion control and a motor; without, it notes what is written."""
        self.generation = generation
        axes = [ServoAxis("near", 2000), ServoAxis("far", 2000)]
        motion = MotionControl if moving else QuietMotion
        self.drive = SerialEpos2(near, axes[0], profile, motion, generation=generation, bus_rate=1_000_000)
        self.far = Epos2(FAR, axes[1], profile, motion)
        self.bus = CanWire(1_000_000)
        usb = generation is Generation.V2
        self.line = usb_line("host") if usb else SerialWire(115_200)
        self.host = Host(generation, timeout, baud or (1_000_000 if usb else 115_200))
        self.frames: list[str] = []
        self.bus.observe(self._note)
        self.world = World(ServoBank(DcMotors((MOTOR, MOTOR)), axes) if moving else None)
        self.world.attach("near", self.drive, {CAN: self.bus, SERIAL: self.line})
        self.world.attach("far", self.far, {CAN: self.bus})
        for name, node in others:
            self.world.attach(name, node, {CAN: self.bus})
        self.world.attach("host", self.host, {SERIAL: self.line})
        self.waits(10 * MILLISECOND)
        self.frames.clear()

    def _note(self, _now: Nanoseconds, sender: str, packet: Packet) -> None:
        self.frames.append(f"{sender} {packet.address:03X}#{packet.payload.hex().upper()}")

    def waits(self, duration: Nanoseconds) -> None:
        self.world.run(self.world.now + duration)

    def sends(self, raw: bytes) -> bytes:
        """Put bytes on the line as they are, and return what comes back within 20 ms."""
        self.host.raw, self.host.received = raw, b""
        self.world.stop("host")
        self.waits(20 * MILLISECOND + len(raw) * 100 * MICROSECOND)
        return self.host.received

    def tries(self, request: Request) -> Outcome:
        """Ask, and wait for the outcome."""
        host = self.host
        host.due, host.outcome = request, None
        host.sent = host.received = b""
        ended = host.ended_at
        self.world.stop("host")
        for _ in range(100_000):
            self.waits(100 * MICROSECOND)
            if host.ended_at != ended:
                break
        self.waits(2 * MILLISECOND)  # the host's last byte is still on its way
        outcome: Outcome | None = host.outcome
        assert outcome is not None, "nothing came of it"
        return outcome

    def requests(self, request: Request) -> Answer | None:
        """Ask, and return the answer; None where the protocol has none."""
        outcome = self.tries(request)
        assert isinstance(outcome, MaxonAnswer), outcome
        return decode_answer(request, outcome.body) if outcome.body else None


def with_profile(**changes: object) -> DeviceProfile:
    return replace(EPOS2_70_10, **changes)  # type: ignore[arg-type] # names and types are the profile's own


__all__ = ["FAR", "NEAR", "Failure", "SerialDesk", "with_profile"]
