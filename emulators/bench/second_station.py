"""A second ground station on the operator's link: it holds a stick, and gives one order again and again."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.bench.foreign_datagrams import command
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of

COMPONENT: Final = 190
"""Mission planner's, as the first station's."""
SPEAKS_EVERY: Final[Nanoseconds] = SECOND // 20
ORDERS_EVERY: Final[Nanoseconds] = SECOND // 2
FULL: Final = 1000
"""Full scale of MANUAL_CONTROL's axes."""
GARBAGE: Final = "garbage"
ORDERS: Final[Mapping[str, tuple[int, tuple[float, ...]]]] = MappingProxyType(
    {
        "take": (32100, (1.0, 1.0)),
        "give up": (32100, (0.0,)),
        "arm": (400, (1.0,)),
        "disarm": (400, (0.0,)),
        "emergency stop": (5300, (0.0,)),
        "clear": (5300, (1.0,)),
        "hold": (193, (0.0,)),
    }
)
"""MAV_CMD and first parameters of each order."""


class SecondStation:
    """A station that the operator has not requested; `accepted` lists its accepted orders and when."""

    def __init__(self, robot: tuple[int, int], system: int, stick: float, order: str, place: int) -> None:
        """Take the robot's system and component, its own system, and a number for where it speaks from."""
        self._codec = Codec(system, COMPONENT)
        self._robot = robot
        self._order = order
        self._x = round(FULL * stick)
        # 192.0.2.0/24 is reserved for documentation (RFC 5737): no station of a real run is there.
        self._place = number_of("192.0.2.9", 14_550 + place)
        self._due: Nanoseconds = 0
        self._order_due: Nanoseconds = 0
        self._silent = False
        self.accepted: list[tuple[Nanoseconds, str]] = []

    def leaves(self) -> None:
        """Send nothing any more."""
        self._silent = True

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Read the answer to the order."""
        number = ORDERS[self._order][0] if self._order in ORDERS else None
        for message in self._codec.decode(packet.payload):
            answers = message.get_type() == "COMMAND_ACK" and message.target_system == self._codec.system
            if answers and (message.command, message.result) == (number, dialect.MAV_RESULT_ACCEPTED):
                self.accepted.append((now, self._order))
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send the stick, and the order where it is due."""
        if self._silent:
            self._due = NEVER
        # Woken by a packet or another's event: the stick keeps its own rhythm.
        if now < self._due:
            return Reaction((), self._due)
        self._due = now + SPEAKS_EVERY
        sent = [
            self._codec.encode(dialect.MAVLink_manual_control_message(self._robot[0], self._x, 0, 0, 0, 0))
        ]
        if now >= self._order_due and self._order:
            self._order_due = now + ORDERS_EVERY
            sent.append(self._ordered())
        return Reaction(tuple(Packet(OPERATOR, self._place, each) for each in sent), self._due)

    def _ordered(self) -> bytes:
        if self._order == GARBAGE:
            return b"\xfd\xff\x00\x00\xfe\x08 this is no MAVLink \x00\xfd\xfd\xfe"
        number, params = ORDERS[self._order]
        return self._codec.encode(command(*self._robot, number, *params))
