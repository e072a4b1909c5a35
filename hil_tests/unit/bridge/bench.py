"""A bus with a bridge and its drives, and a ground station in the test's hand."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from emulators.rewind import Rewind
from emulators.wires.can import CanWire
from emulators.wires.datagram import DatagramWire
from emulators.world import World
from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.mavlink.frames import Codec, dialect, text_of
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import Guarded, guarded
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

LINK = "drives"
"""Name of the drives' bus in the robot file."""
LIFT_BUTTON = 8
ACCEPTED, TEMPORARILY_REJECTED, DENIED = 0, 1, 2
ARM = dialect.MAV_CMD_COMPONENT_ARM_DISARM
STANDS = dialect.MAV_CMD_USER_1
STEER, LIFT = 3, 4
"""Axes by their place in the robot file."""
RPM_AT_03 = 1490
"""0.3 m/s: 6 rad/s at the wheel, times 26, is 1490 rpm at the motor."""


class Station:
    """A ground station that sends the test's messages, and keeps the received ones."""

    def __init__(self) -> None:
        self.codec = Codec(255, 190)
        self.received: list[Any] = []

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        self.received += self.codec.decode(packet.payload)
        return Reaction()


class Carrier:
    """Stand-in for the runtime: an exception in the node is followed by `stop`."""

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
    """Complete chain, joined in virtual time."""

    robot: AnyRobot
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
    refused: list[str] = field(default_factory=list)
    """Expected refusals of the guard."""

    def __post_init__(self) -> None:
        bus, air = CanWire(Epos2Link.of_link(self.robot, "drives").bit_rate), DatagramWire()
        bus.observe(lambda now, sender, packet: self.frames.append((now, sender, packet)))
        self.guard = guarded(self.bridge, self.robot)
        self.carrier = Carrier(self.guard)
        self.at_bridge = self.world.attach("bridge", self.carrier, {LINK: bus, OPERATOR: air})
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
                z, buttons = (0, 0) if self.lift is None else (round(self.lift * 1000), LIFT_BUTTON)
                self.states(dialect.MAVLink_manual_control_message(1, x, 0, z, r, buttons))
            self.world.run(min(self.now + 50 * MILLISECOND, until))

    def starts(self) -> None:
        self.runs(1.5)
        assert self.bridge.phase is Life.RUNNING

    def stands(self, steer_deg: float = 0.0, lift_m: float = 0.0) -> None:
        """Confirm the positions of steering and lift, and let them be taken."""
        assert self.commands(STANDS, STEER, steer_deg) == ACCEPTED
        assert self.commands(STANDS, LIFT, lift_m) == ACCEPTED
        self.runs(0.3)

    def stops(self) -> None:
        """Request the orderly end."""
        for packet in self.guard.stop(self.now).sent:
            self.bus.carry(self.at_bridge, packet)

    def arms(self) -> int:
        return self.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)

    def commands(self, command: int, *params: float) -> int:
        """Send a command; return the MAV_RESULT."""
        before = len(self.station.received)
        padded = (*params, *(0.0,) * (7 - len(params)))
        self.states(dialect.MAVLink_command_long_message(1, 1, command, 0, *padded))
        self.world.run(self.now + MILLISECOND)
        for message in self.station.received[before:]:
            if message.get_type() == "COMMAND_ACK":
                return int(message.result)
        raise AssertionError("no COMMAND_ACK")

    def states(self, message: Any) -> None:
        self.air.carry(self.at_station, Packet(OPERATOR, 0, self.station.codec.encode(message)))

    def inject(self, name: str, packets: list[Packet]) -> None:
        """Let a drive say something by itself."""
        for packet in packets:
            self.bus.carry(self.places[name], packet)
        self.world.run(self.now + MILLISECOND)

    def reported(self) -> str:
        """Return all texts that the station has received, joined."""
        texts = [message.text for message in self.station.received if message.get_type() == "STATUSTEXT"]
        return "".join(map(text_of, texts))

    def sent(self, address: int, since: Nanoseconds = 0) -> list[tuple[Nanoseconds, str]]:
        """Return the bridge's frames with this identifier, by the end of each frame, in hexadecimal."""
        return [
            (now, packet.payload.hex(" "))
            for now, sender, packet in self.frames
            if sender == "bridge" and packet.address == address and now >= since
        ]

    def words(self, name: str, since: Nanoseconds) -> list[tuple[int, int]]:
        """Return controlword and target of each set-point that a drive has received."""
        return [(word, target) for now, word, target in self.drives[name].words if now >= since]


class Moments:
    """A bench that was started once; each test goes on from there, and finds nothing of the one before."""

    def __init__(self, make: Callable[[], Bench]) -> None:
        self._bench = make()
        self._rewind = Rewind(self._bench)
        self._bench.starts()
        self._started = self._rewind.snapshot()
        assert self._bench.arms() == ACCEPTED
        self._armed = self._rewind.snapshot()

    def started(self) -> Iterator[Bench]:
        """Yield the bench as it runs, disarmed; see `sound`."""
        self._rewind.restore(self._started)
        return sound(self._bench)

    def armed(self) -> Iterator[Bench]:
        """Yield it armed, at rest."""
        self._rewind.restore(self._armed)
        return sound(self._bench)


def sound(bench: Bench) -> Iterator[Bench]:
    """Yield a bench to a test; its guard must have refused the test's own frames, or nothing."""
    yield bench
    assert [refusal.reason for refusal in bench.guard.refusals] == bench.refused


def driving(bench: Bench, speed: float = 0.3) -> None:
    bench.speed = speed
    bench.runs(1)
