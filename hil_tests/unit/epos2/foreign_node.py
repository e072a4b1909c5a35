"""A third party on the bus who sends anything, fast: seeded bursts of frames at a whole drive with a motor.

After every frame it is checked that the answers are those of the standard, that the winding is driven only
where the power machine allows it, and that with the stage off it takes energy from the shaft, or none.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.servo.winding import set_winding
from firmware_bridge.canopen import sdo
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.can_error import BUS_OFF, CONTROLLER
from hil_tests.unit.epos2.watched_winding import WatchedWinding

NODE: Final = 5
SPEAKING: Final = frozenset({NmtState.PRE_OPERATIONAL, NmtState.OPERATIONAL})
DRIVEN: Final = frozenset(
    {
        PowerState.MEASURE_INIT,
        PowerState.OPERATION_ENABLED,
        PowerState.QUICK_STOP_ACTIVE,
        PowerState.FAULT_REACTION_ENABLED,
    }
)
KNOWN_ABORTS: Final = frozenset(map(int, AbortCode))
ROWS: Final = tuple(EPOS2_70_10.objects.values())
WORDS: Final = (0x0006, 0x0007, 0x000F, 0x001F, 0x003F, 0x007F, 0x010F, 0x000B, 0x0002, 0x0000, 0x0080)
COMMANDS: Final = (0x01, 0x01, 0x01, 0x01, 0x80, 0x02, 0x81, 0x82, 0x03)
MODES: Final = (1, 3, 1, 3, -1, -2, -3, 6, 7, 0)
FRAME_TIME: Final[Nanoseconds] = 120 * MICROSECOND

Draw = Callable[[int], int]


class ForeignNode:
    """One drive, one motor, and the number of frames sent so far."""

    def __init__(self) -> None:
        self.axis = ServoAxis("foreign", 2000)
        set_winding(self.axis, MOTOR.torque_constant, MOTOR.resistance, MOTOR.inductance)
        plant = DcMotors((MOTOR,))
        self.bank = ServoBank(plant, [self.axis])
        self.winding = WatchedWinding(plant, MOTOR, self.axis)
        self.drive = Epos2(NODE, self.axis)
        self.now: Nanoseconds = 0
        self.frames = 0
        self.powered_frames = 0
        self.aborts: set[int] = set()
        self._due = self._checked(self.drive.wake(0)).wake_at

    def waits(self, duration: Nanoseconds) -> None:
        """Let time pass, with everything that the drive wants to do in it."""
        until = self.now + duration
        while True:
            at = min(self._due, until)
            self.winding.begins()
            reached, woken = self.bank.advance(at)
            self.winding.ends()
            if not woken and self._due > until:
                break
            self.now = max(self.now, reached if woken else at)
            self._due = self._checked(self.drive.wake(self.now)).wake_at
        self.now = until

    def bursts(self, seed: int, frames: int) -> None:
        """Send so many frames, drawn by the seed."""
        words: list[int] = np.random.default_rng(seed).integers(0, 1 << 31, size=frames * 8).tolist()
        place = 0

        def draw(below: int) -> int:
            nonlocal place
            place = (place + 1) % len(words)
            return words[place] % below

        for _ in range(frames):
            address, payload = KINDS[draw(len(KINDS))](draw)
            self.sends(address, payload)
            if draw(4) == 0:
                self.waits(FRAME_TIME * (1 + draw(4)))

    def sends(self, address: int, payload: bytes) -> None:
        """Send a frame and check what comes back."""
        state, silent = self.drive.nmt_state, not self.drive.on_bus
        reaction = self._checked(self.drive.receive(Packet(CAN, address, payload), self.now))
        self._due = reaction.wake_at
        self.frames += 1
        if address != 0x600 + NODE:
            return
        answers = [packet.payload for packet in reaction.sent if packet.address == 0x580 + NODE]
        request = sdo.decode_request(payload)
        wanted = state in SPEAKING and not silent and not isinstance(request, sdo.Abort)
        assert len(answers) == wanted, f"{payload.hex()} in {state.name}: {answers}"
        if answers:
            self._judge(request, answers[0])

    def _judge(self, request: sdo.Request, answer: bytes) -> None:
        assert len(answer) == 8
        response = sdo.decode_response(answer)
        if isinstance(response, sdo.Abort):
            assert response.code in KNOWN_ABORTS
            self.aborts.add(response.code)
        if isinstance(request, sdo.UploadRequest | sdo.DownloadRequest):
            row = EPOS2_70_10.objects.get(request.address)
            assert not isinstance(response, sdo.Unknown | sdo.SdoSegment | sdo.SegmentAccepted)
            assert response.address == request.address
            reading = isinstance(request, sdo.UploadRequest)
            if row is None or not (row.access.readable if reading else row.access.writable):
                assert isinstance(response, sdo.Abort)
            elif reading:
                assert isinstance(response, sdo.UploadResponse)

    def _checked(self, reaction: Reaction) -> Reaction:
        for packet in reaction.sent:
            assert packet.link == CAN
            assert 0 < packet.address <= 0x7FF
            assert len(packet.payload) <= 8
        motion = self.drive.motion
        assert isinstance(motion, MotionControl)
        axis = self.axis
        if axis.powered:
            self.powered_frames += 1
            assert motion.state in DRIVEN, f"the winding is driven in {motion.state.name}"
            assert motion.state is not PowerState.MEASURE_INIT or axis.current_demand_ma == 0
        else:
            assert axis.current_demand_ma == 0
            assert motion.state not in (PowerState.OPERATION_ENABLED, PowerState.QUICK_STOP_ACTIVE)
        return reaction


def _payload(draw: Draw, size: int) -> bytes:
    return draw(1 << 31).to_bytes(4, "little")[: min(size, 4)] + bytes(draw(256) for _ in range(size - 4))


def _anything(draw: Draw) -> tuple[int, bytes]:
    flags = (0, 0, 0, REMOTE, EXTENDED)[draw(5)]
    return draw(0x800) | flags, _payload(draw, draw(9))


def _own(draw: Draw) -> tuple[int, bytes]:
    bases = (0x80, 0x180, 0x200, 0x280, 0x300, 0x380, 0x400, 0x480, 0x500, 0x580, 0x700)
    return bases[draw(len(bases))] + NODE | (REMOTE if draw(5) == 0 else 0), _payload(draw, draw(9))


def _requested(draw: Draw) -> tuple[int, bytes]:
    return 0x600 + NODE, _payload(draw, draw(9))


def _read(draw: Draw) -> tuple[int, bytes]:
    return 0x600 + NODE, sdo.encode_upload(ROWS[draw(len(ROWS))].address)


def _written(draw: Draw) -> tuple[int, bytes]:
    row = ROWS[draw(len(ROWS))]
    low, high = row.bounds if row.type.size else (0, 0)
    span = high - low + 1
    value = (low, high, low + draw(span), draw(1 << 31), draw(16))[draw(5)]
    size = row.type.size if draw(8) else draw(9)
    raw = (value & (1 << 8 * max(size, 1)) - 1).to_bytes(max(size, 1), "little")
    return 0x600 + NODE, sdo.encode_download(row.address, raw)


def _segment(draw: Draw) -> tuple[int, bytes]:
    toggle = draw(2) == 1
    if draw(2):
        return 0x600 + NODE, sdo.encode_upload_segment(toggle=toggle)
    return 0x600 + NODE, sdo.encode_download_segment(
        _payload(draw, draw(8)), toggle=toggle, last=draw(3) == 0
    )


def _controlword(draw: Draw) -> tuple[int, bytes]:
    word = WORDS[draw(len(WORDS))]
    if draw(2):
        return 0x200 + NODE, word.to_bytes(2, "little")
    return 0x600 + NODE, bytes((0x2B, 0x40, 0x60, 0)) + word.to_bytes(4, "little")


def _set_point(draw: Draw) -> tuple[int, bytes]:
    target = draw(20_000) - 10_000
    base = (0x400, 0x500)[draw(2)]
    return base + NODE, b"\x1f\0" + target.to_bytes(4, "little", signed=True)


def _mode(draw: Draw) -> tuple[int, bytes]:
    return 0x600 + NODE, bytes((0x2F, 0x60, 0x60, 0, MODES[draw(len(MODES))] & 0xFF, 0, 0, 0))


def _network(draw: Draw) -> tuple[int, bytes]:
    return 0x000, bytes((COMMANDS[draw(len(COMMANDS))], (0, NODE, 6)[draw(3)]))


def _beat(draw: Draw) -> tuple[int, bytes]:
    return ((0x080, b""), (0x700 + NODE | REMOTE, b"\0"), (0x705, b"\5"), (0x764, b"\5"))[draw(4)]


def _layer(draw: Draw) -> tuple[int, bytes]:
    commands = (0x04, 0x11, 0x13, 0x17, 0x40, 0x46, 0x5A, 0x5E)
    return 0x7E5, bytes((commands[draw(len(commands))], draw(2), draw(9), 0, 0, 0, 0, 0))


def _controller(draw: Draw) -> tuple[int, bytes]:
    address = (CONTROLLER, BUS_OFF, ERROR | draw(1 << 11))[draw(3)]
    return address, _payload(draw, 8)


KINDS: Final = (
    *(_anything, _own, _requested, _read, _read, _written, _written, _segment, _set_point, _set_point, _mode),
    *(_controlword,) * 10,
    *(_network, _beat, _layer),
)
RARE: Final = (_controller,)
PAUSE: Final[Nanoseconds] = 20 * MILLISECOND
