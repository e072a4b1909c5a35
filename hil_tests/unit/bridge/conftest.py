"""The bridge on a bus with four paper drives, and a ground station in the test's hand."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest

from emulators.rig import Devices, devices
from emulators.wires.can import CanWire
from emulators.wires.datagram import DatagramWire
from emulators.world import World
from firmware_bridge import robot as robots
from firmware_bridge.bridge import Bridge, Phase
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Axis, Mode, Robot
from firmware_bridge.safety.guard import Guarded
from firmware_bridge.safety.guard_rules import rules_for
from firmware_bridge.teleop.mavlink import Codec, dialect, text_of
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire import sdo
from firmware_bridge.wire.abort import AbortCode
from firmware_bridge.wire.canopen import NmtCommand, NmtState
from firmware_bridge.wire.cia402 import Command, Control, State, command_of
from firmware_bridge.wire.epos2 import address as at

REMOTE = 1 << 9
LIFT_BUTTON = 8
STEPS = {
    (State.SWITCH_ON_DISABLED, Command.SHUTDOWN): State.READY_TO_SWITCH_ON,
    (State.READY_TO_SWITCH_ON, Command.DISABLE_OPERATION): State.SWITCHED_ON,
    (State.READY_TO_SWITCH_ON, Command.ENABLE_OPERATION): State.OPERATION_ENABLED,
    (State.SWITCHED_ON, Command.ENABLE_OPERATION): State.OPERATION_ENABLED,
    (State.OPERATION_ENABLED, Command.SHUTDOWN): State.READY_TO_SWITCH_ON,
    (State.OPERATION_ENABLED, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.OPERATION_ENABLED, Command.QUICK_STOP): State.QUICK_STOP_ACTIVE,
    (State.QUICK_STOP_ACTIVE, Command.ENABLE_OPERATION): State.OPERATION_ENABLED,
    (State.QUICK_STOP_ACTIVE, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.READY_TO_SWITCH_ON, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.READY_TO_SWITCH_ON, Command.QUICK_STOP): State.SWITCH_ON_DISABLED,
}


class PaperDrive:
    """What the EPOS2's documents say of SDO, NMT, states and PDOs, in few lines; it obeys at once.

    Written apart from the emulator: the bridge must agree with the documents, not with our other half.
    """

    def __init__(self, axis: Axis) -> None:
        self.axis = axis
        self.memory: dict[at.Address, bytes] = {
            at.DEVICE_TYPE: bytes.fromhex("92010200"),
            at.VENDOR_ID: bytes.fromhex("FB000000"),
            at.PRODUCT_CODE: bytes.fromhex("00002064"),
            at.VELOCITY_AVERAGED: bytes(4),
            at.ANALOGUE_INPUT_1: (4100).to_bytes(2, "little"),
        }
        self.written: list[tuple[at.Address, bytes]] = []
        self.refuses: dict[at.Address, AbortCode] = {}
        self.forgets: set[at.Address] = set()
        self.state = State.SWITCH_ON_DISABLED
        self.nmt = NmtState.PRE_OPERATIONAL
        self.silent = False
        self.stuck_in: set[State] = set()
        self.jammed = False
        self.words: list[tuple[Nanoseconds, int, int]] = []
        """Each set-point: when, controlword, target."""
        self.rpm = 0
        self.position = 0.0
        self._word = 0
        self._moved_at: Nanoseconds = 0

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        sent = [] if self.silent else self._heard(packet, now)
        return Reaction(tuple(Packet(CAN, address, payload) for address, payload in sent))

    def fails(self, code: int) -> list[Packet]:
        """Go to fault; return what the drive then sends."""
        self.state = State.FAULT
        self.rpm = 0
        node = self.axis.node
        emergency = code.to_bytes(2, "little") + bytes(6)
        return [Packet(CAN, 0x080 + node, emergency), Packet(CAN, 0x180 + node, self._status())]

    def boots(self) -> list[Packet]:
        """Lose everything; return what the drive then sends."""
        fresh = PaperDrive(self.axis)
        self.memory, self.state, self.nmt = fresh.memory, fresh.state, fresh.nmt
        self.rpm, self.position, self._word = 0, 0.0, 0
        return [Packet(CAN, 0x700 + self.axis.node, b"\0")]

    def _heard(self, packet: Packet, now: Nanoseconds) -> list[tuple[int, bytes]]:
        node = self.axis.node
        if packet.address == 0x000 and packet.payload[1] in (0, node):
            self.nmt = {
                NmtCommand.START: NmtState.OPERATIONAL,
                NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
            }[NmtCommand(packet.payload[0])]
            return [(0x180 + node, self._status())] if self.nmt is NmtState.OPERATIONAL else []
        if packet.address == 0x600 + node:
            return self._served(packet.payload)
        if self.nmt is not NmtState.OPERATIONAL:
            return []
        if packet.address == 0x080:
            self._move(now)
            position = round(self.position) & 0xFFFF_FFFF
            return [(0x280 + node, self._status() + position.to_bytes(4, "little") + bytes((7, 0)))]
        if packet.address == (0x500 if self.axis.mode is Mode.VELOCITY else 0x400) + node:
            return self._commanded(packet.payload, now)
        return []

    def _served(self, payload: bytes) -> list[tuple[int, bytes]]:
        answer = None
        match sdo.decode_request(payload):
            case sdo.UploadRequest(address) if address in self.refuses:
                answer = sdo.encode_abort(address, self.refuses[address])
            case sdo.UploadRequest(address):
                raw = self._status() if address == at.STATUSWORD else self.memory.get(address)
                if raw is None:
                    answer = sdo.encode_abort(address, AbortCode.NO_OBJECT)
                else:
                    answer = sdo.encode_upload_response(address, raw)
            case sdo.DownloadRequest(address, raw, _) if raw is not None:
                if address in self.refuses:
                    answer = sdo.encode_abort(address, self.refuses[address])
                else:
                    self.written.append((address, raw))
                    self.memory[address] = bytes(len(raw)) if address in self.forgets else raw
                    if address == at.CONTROLWORD:
                        self._obey(int.from_bytes(raw, "little"))
                    answer = sdo.encode_download_response(address)
        return [] if answer is None else [(0x580 + self.axis.node, answer)]

    def _commanded(self, payload: bytes, now: Nanoseconds) -> list[tuple[int, bytes]]:
        word = int.from_bytes(payload[:2], "little")
        target = int.from_bytes(payload[2:6], "little", signed=True)
        self.words.append((now, word, target))
        before, edge = self.state, word & ~self._word & Control.NEW_SETPOINT
        self._move(now)
        self._obey(word)
        moves = self.state is State.OPERATION_ENABLED
        if self.axis.mode is Mode.VELOCITY:
            self.rpm = target if moves else 0
        elif moves and edge and not self.jammed:
            self.position = float(target)
        return [(0x180 + self.axis.node, self._status())] if self.state is not before else []

    def _obey(self, word: int) -> None:
        reset = word & ~self._word & Control.FAULT_RESET
        self._word = word
        if self.state in self.stuck_in:
            return
        if self.state is State.FAULT and reset:
            self.state = State.SWITCH_ON_DISABLED
        self.state = STEPS.get((self.state, command_of(word)), self.state)

    def _move(self, now: Nanoseconds) -> None:
        turns = self.rpm / 60.0 * (now - self._moved_at) / SECOND
        self.position += turns * self.axis.quadcounts_per_turn
        self._moved_at = now

    def _status(self) -> bytes:
        remote = REMOTE if self.nmt is NmtState.OPERATIONAL else 0
        return (self.state.value | remote).to_bytes(2, "little")


class Station:
    """A ground station that says what the test tells it to, and keeps what it hears."""

    def __init__(self) -> None:
        self.codec = Codec(255, 190)
        self.heard: list[Any] = []

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        self.heard += self.codec.decode(packet.payload)
        return Reaction()


class Carrier:
    """Does what the shell does: an exception in the node is followed by `stop`."""

    def __init__(self, node: Guarded) -> None:
        self.node = node
        self.failed: Exception | None = None

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return self._carried(lambda: self.node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        return self._carried(lambda: self.node.wake(now), now)

    def _carried(self, act: Callable[[], Reaction], now: Nanoseconds) -> Reaction:
        try:
            return act()
        except ZeroDivisionError as failed:
            self.failed = failed
            return self.node.stop(now)


@dataclass
class Bench:
    """Everything joined in virtual time."""

    robot: Robot
    bridge: Bridge
    drives: Mapping[str, Any]
    """Paper drives, or emulated ones."""
    station: Station = field(default_factory=Station)
    world: World = field(default_factory=World)
    frames: list[tuple[Nanoseconds, str, Packet]] = field(default_factory=list)
    speed: float = 0.0
    steer: float = 0.0
    lift: float | None = None
    """The lift's stick, -1 to 1, with its button held; None lets both go."""
    talks: bool = True

    def __post_init__(self) -> None:
        bus, air = CanWire(self.robot.bus.bit_rate), DatagramWire()
        bus.observe(lambda now, sender, packet: self.frames.append((now, sender, packet)))
        self.guard = Guarded(self.bridge, rules_for(self.robot))
        self.carrier = Carrier(self.guard)
        self.at_bridge = self.world.attach("bridge", self.carrier, {CAN: bus, OPERATOR: air})
        self.places = {
            name: self.world.attach(name, drive, {CAN: bus}) for name, drive in self.drives.items()
        }
        self.at_station = self.world.attach("station", self.station, {OPERATOR: air})
        self.bus, self.air = bus, air

    @property
    def now(self) -> Nanoseconds:
        return self.world.now

    def runs(self, seconds: float) -> None:
        """Let time pass; the station sends its stick every 50 ms while it talks."""
        until = self.now + round(seconds * SECOND)
        while self.now < until:
            if self.talks:
                x, r = round(self.speed / 0.5 * 1000), round(-self.steer / 60.0 * 1000)
                z, buttons = (500, 0) if self.lift is None else (round(self.lift * 1000), LIFT_BUTTON)
                self.says(dialect.MAVLink_manual_control_message(1, x, 0, z, r, buttons))
            self.world.run(min(self.now + 50 * MILLISECOND, until))

    def starts(self) -> None:
        self.runs(1.5)
        assert self.bridge.phase is Phase.RUNNING

    def stops(self) -> None:
        """Ask for the orderly end."""
        for packet in self.guard.stop(self.now).sent:
            self.bus.carry(self.at_bridge, packet)

    def arms(self) -> int:
        return self.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)

    def commands(self, command: int, *params: float) -> int:
        """Send a command; return the MAV_RESULT."""
        before = len(self.station.heard)
        padded = (*params, *(0.0,) * (7 - len(params)))
        self.says(dialect.MAVLink_command_long_message(1, 1, command, 0, *padded))
        self.world.run(self.now + MILLISECOND)
        for message in self.station.heard[before:]:
            if message.get_type() == "COMMAND_ACK":
                return int(message.result)
        raise AssertionError("no COMMAND_ACK")

    def says(self, message: Any) -> None:
        self.air.carry(self.at_station, Packet(OPERATOR, 0, self.station.codec.encode(message)))

    def inject(self, name: str, packets: list[Packet]) -> None:
        """Let a drive say something by itself."""
        for packet in packets:
            self.bus.carry(self.places[name], packet)
        self.world.run(self.now + MILLISECOND)

    def told(self) -> str:
        """All texts that the station has heard, joined."""
        texts = [message.text for message in self.station.heard if message.get_type() == "STATUSTEXT"]
        return "".join(map(text_of, texts))

    def sent(self, address: int, since: Nanoseconds = 0) -> list[tuple[Nanoseconds, str]]:
        """What the bridge sent with this identifier, by the end of each frame, in hexadecimal."""
        return [
            (now, packet.payload.hex(" "))
            for now, sender, packet in self.frames
            if sender == "bridge" and packet.address == address and now >= since
        ]

    def words(self, name: str, since: Nanoseconds) -> list[tuple[int, int]]:
        """Controlword and target of each set-point that a drive has heard."""
        return [(word, target) for now, word, target in self.drives[name].words if now >= since]


def joined() -> Bench:
    return joined_with(Bridge(robots.find("rars")))


def joined_with(bridge: Bridge) -> Bench:
    """Join a bridge of the test's own to four drives and a station."""
    robot = robots.find("rars")
    return Bench(robot, bridge, {axis.name: PaperDrive(axis) for axis in robot.axes})


@pytest.fixture
def robot() -> Robot:
    return robots.find("rars")


@pytest.fixture
def bench() -> Iterator[Bench]:
    """Four drives, a bridge behind its guard, a station; the guard must have had nothing to refuse."""
    bench = joined()
    yield bench
    assert [refusal.reason for refusal in bench.guard.refusals] == []


@pytest.fixture
def emulated() -> Iterator[tuple[Bench, Devices]]:
    """The same with four emulated drives above the plant."""
    robot = robots.find("rars")
    below = devices(robot)
    bench = Bench(robot, Bridge(robot), below.drives, world=World(below.bank))
    yield bench, below
    assert [refusal.reason for refusal in bench.guard.refusals] == []
    below.plant.close()


@pytest.fixture(scope="session")
def bench_with() -> Callable[[Bridge], Bench]:
    """For tests that bring their own bridge."""
    return joined_with


@pytest.fixture(scope="session")
def new_bench() -> Callable[[], Bench]:
    """For tests that need one for each example."""
    return joined
