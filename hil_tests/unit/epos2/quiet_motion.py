"""A drive on a desk: frames in and out by hand, with a motion control that stands still and keeps notes."""

from collections.abc import Callable
from dataclasses import dataclass, field

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.saved_parameters import Storage
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.can import REMOTE

NODE = 1
SWITCH_ON_DISABLED = 0x0540


@dataclass(eq=False)
class QuietMotion:
    """Answers as the drive's motion control does while the power stage is off."""

    store: ObjectStore
    axis: ServoAxis
    report: Callable[[int], None]
    operational: bool = False
    hung: bool = False
    resets: int = 0
    written: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.store.on_write(od.CONTROLWORD, self.written.append)
        self.store.set(od.STATUSWORD, SWITCH_ON_DISABLED)

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as in MotionControl
        self.operational = operational
        self.store.set(od.STATUSWORD, SWITCH_ON_DISABLED | 0x0200 * operational)

    def connection_lost(self) -> None:
        self.report(emergency.CONNECTION_LOST)

    def communication_fault(self, code: int) -> None:
        self.report(code)

    def communication_reset(self) -> None:
        """Nothing stands here."""

    def refresh(self, now: Nanoseconds) -> None:
        """Nothing moves."""

    def wake_at(self) -> Nanoseconds:
        return NEVER

    def reset(self) -> None:
        self.resets += 1
        self.store.set(od.STATUSWORD, SWITCH_ON_DISABLED)


class Desk:
    """One drive and the time on the clock beside it. Frames are written `"601#2B17100064000000"`."""

    def __init__(
        self,
        profile: DeviceProfile = EPOS2_70_10,
        *,
        node: int = NODE,
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        self.motions: list[QuietMotion] = []
        self.drive = Epos2(
            node, ServoAxis("desk", 2000), profile, self._motion, storage=storage, bus_rate=bus_rate
        )
        self.now: Nanoseconds = 0
        self.due: Nanoseconds = 0

    def _motion(self, store: ObjectStore, axis: ServoAxis, report: Callable[[int], None]) -> QuietMotion:
        self.motions.append(QuietMotion(store, axis, report))
        return self.motions[-1]

    @property
    def motion(self) -> QuietMotion:
        return self.motions[-1]

    @property
    def store(self) -> ObjectStore:
        return self.drive.store

    def powers(self) -> list[str]:
        """Switch on, and return the drive's frames."""
        return self.waits_until(0)

    def receives(self, frame: str) -> list[str]:
        """Give the drive a frame, and return its answers at once."""
        head, _, tail = frame.partition("#")
        if tail.startswith("R"):
            packet = Packet(CAN, int(head, 16) | REMOTE, bytes(int(tail[1:] or "0")))
        else:
            packet = Packet(CAN, int(head, 16), bytes.fromhex(tail))
        return self._received(packet)

    def _received(self, packet: Packet) -> list[str]:
        reaction = self.drive.receive(packet, self.now)
        self.due = reaction.wake_at
        return [f"{each.address:03X}#{each.payload.hex().upper()}" for each in reaction.sent]

    def waits_until(self, instant: Nanoseconds) -> list[str]:
        """Let the time pass, waking the drive whenever it wants, and return all that it sends."""
        stated: list[str] = []
        while self.due <= instant:
            self.now = max(self.now, self.due)
            reaction = self.drive.wake(self.now)
            assert reaction.wake_at > self.now
            self.due = reaction.wake_at
            stated += [f"{each.address:03X}#{each.payload.hex().upper()}" for each in reaction.sent]
        self.now = instant
        return stated

    def waits(self, duration: Nanoseconds) -> list[str]:
        """Let a duration pass."""
        return self.waits_until(self.now + duration)

    def writes(self, index: int, subindex: int, raw: bytes) -> str:
        """Download up to four bytes, and return the answer's command byte, or the abort code."""
        command = 0x23 | (4 - len(raw)) << 2
        payload = bytes((command, index & 0xFF, index >> 8, subindex)) + raw.ljust(4, b"\0")
        (answer, *_) = self.receives(f"601#{payload.hex()}")
        assert answer[4:12][2:] == payload[1:4].hex().upper()
        return "ok" if answer.startswith("581#60") else bytes.fromhex(answer[12:])[::-1].hex().upper()

    def reads(self, index: int, subindex: int = 0) -> int | str:
        """Upload a number, or return the abort code."""
        (answer, *_) = self.receives(f"601#40{index & 0xFF:02X}{index >> 8:02X}{subindex:02X}00000000")
        raw = bytes.fromhex(answer[4:])
        if raw[0] == 0x80:
            return raw[:3:-1].hex().upper()
        return int.from_bytes(raw[4 : 8 - (raw[0] >> 2 & 3)], "little")


def powered(profile: DeviceProfile = EPOS2_70_10) -> Desk:
    """Return a drive in Pre-Operational that has sent its boot-up."""
    desk = Desk(profile)
    desk.powers()
    return desk


def operational(profile: DeviceProfile = EPOS2_70_10) -> Desk:
    """Return a drive in Operational whose first messages are over."""
    desk = powered(profile)
    desk.receives("000#0101")
    desk.waits(10_000_000)
    return desk


def u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


def set_up(desk: Desk, *rows: tuple[int, int, bytes]) -> Desk:
    for index, subindex, raw in rows:
        assert desk.writes(index, subindex, raw) == "ok", f"0x{index:04X}:{subindex}"
    return desk
