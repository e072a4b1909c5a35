"""Drives without a robot on virtual buses; a master sets them up and then exchanges process data."""

import ctypes
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from emulators.epos2.drive import Epos2
from emulators.epos2.mounted import PULSES
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, QUADCOUNTS_PER_LINE, SECOND, Nanoseconds
from hil_tests.unit.servo.side_by_side import Motors

BIT_RATE: Final = 1_000_000
SET_UP_AT: Final[Nanoseconds] = SECOND
BEGIN_AT: Final[Nanoseconds] = 2 * SECOND
"""Time by which all drives are set up."""
SAMPLE: Final = 3
"""Number of the transmit PDO that answers SYNC: statusword and velocity."""
NO_REMOTE: Final = cia301.COB_ID_NO_REMOTE
PROFILE_VELOCITY_MODE: Final = 3
TO_OPERATION_ENABLED: Final = (0x06, 0x07, 0x0F)
"""Controlwords, one a cycle; the last one stays."""
TARGET_RPM: Final = 1000

Cycle = Callable[[int], Iterable[Packet]]
"""Packets of a cycle, by its number."""


class Master:
    """A node that sends its set-up once, then something in each cycle; it counts received packets."""

    def __init__(self, setup: Sequence[Packet], cycle: Cycle, every: Nanoseconds) -> None:
        self.received = 0
        self._setup = tuple(setup)
        self._cycle = cycle
        self._every = every
        self._done = 0
        self._due: Nanoseconds = SET_UP_AT

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Count a frame."""
        del packet, now
        self.received += 1
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send what is due."""
        if now < self._due:
            return Reaction((), self._due)
        if self._setup:
            sent, self._setup, self._due = self._setup, (), BEGIN_AT
            return Reaction(sent, self._due)
        sent = tuple(self._cycle(self._done))
        self._done += 1
        self._due += self._every
        return Reaction(sent, self._due)


@dataclass(slots=True)
class Crowd:
    """A world full of drives."""

    world: World
    wire: CanWire
    """The first of its buses."""
    axes: list[ServoAxis]

    @property
    def turning(self) -> int:
        """Number of drives that have power and see their shaft turn."""
        return sum(bool(axis.powered and axis.velocity_average) for axis in self.axes)

    def runs_a_second(self) -> None:
        """Let a second pass."""
        self.world.run(self.world.now + SECOND)


def write(node: int, address: Address, kind: DataType, value: int) -> Packet:
    """Return the request that writes a number."""
    payload = sdo.encode_download(address, kind.encode(value))
    return Packet(CAN, cia301.SDO_REQUEST + node, payload)


def set_up(count: int, heartbeat_ms: int) -> list[Packet]:
    """Return the frames after which the drives regulate their speed, answer SYNC, and say that they live."""
    frames = []
    for node in range(1, count + 1):
        cob_id = NO_REMOTE | cia301.TRANSMIT_PDO[SAMPLE] + node
        frames += [
            write(node, Address(0x1800 + SAMPLE, 2), DataType.UNSIGNED8, 1),
            write(node, Address(0x1800 + SAMPLE, 1), DataType.UNSIGNED32, cob_id),
            write(node, od.MODE, DataType.INTEGER8, PROFILE_VELOCITY_MODE),
            write(node, od.PRODUCER_HEARTBEAT, DataType.UNSIGNED16, heartbeat_ms),
        ]
    return [*frames, Packet(CAN, cia301.NMT, bytes((NmtCommand.START, cia301.ALL_NODES)))]


SYNC: Final = Packet(CAN, cia301.SYNC, b"")


def only_sync(_cycle: int) -> Iterable[Packet]:
    """Request the drives' process data."""
    return (SYNC,)


def exchange(count: int, cycle: int) -> Iterable[Packet]:
    """Ask, and give each drive its controlword and its speed."""
    word = TO_OPERATION_ENABLED[min(cycle, len(TO_OPERATION_ENABLED) - 1)]
    payload = word.to_bytes(2, "little") + TARGET_RPM.to_bytes(4, "little")
    return (SYNC, *(Packet(CAN, cia301.RECEIVE_PDO[3] + node, payload) for node in range(1, count + 1)))


def crowd(
    count: int,
    *,
    motors: ctypes.CDLL | None = None,
    every: Nanoseconds = 50 * MILLISECOND,
    heartbeat_ms: int = 0,
    cycle: Cycle | None = None,
    buses: int = 1,
) -> Crowd:
    """Put so many drives onto each bus, above motors in C where that library is given, and run them in."""
    whole = count * buses
    axes = [ServoAxis(f"motor{number}", QUADCOUNTS_PER_LINE * PULSES) for number in range(whole)]
    bank = None if motors is None else ServoBank(Motors(motors, count=whole), axes, supply=3 * whole)
    world, wires = World(bank), [CanWire(BIT_RATE, f"bus{number}") for number in range(buses)]
    for number, axis in enumerate(axes):
        world.attach(axis.name, Epos2(number % count + 1, axis), {CAN: wires[number // count]})
    for wire in wires:
        master = Master(set_up(count, heartbeat_ms), cycle or partial(exchange, count), every)
        world.attach(f"master of {wire.name}", master, {CAN: wire})
    world.run(BEGIN_AT + 10 * every)
    return Crowd(world, wires[0], axes)
