"""A second ground station on the operator's link: it sends the given messages, and keeps the answers."""

from typing import Any

from firmware_bridge.mavlink.frames import Codec, dialect, text_of
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.internet import number_of
from hil_tests.scenarios.ride import Ride

PERIOD = SECOND // 20
ARM, CLEAR, CONTROL = 400, 5300, 32100


class ForeignNode:
    """Station that sends 20 times a second from `talks_from` on; `x` is its stick, `orders` go out once."""

    def __init__(
        self, system: int = 254, component: int = 190, source: int = number_of("192.0.2.7", 14550)
    ) -> None:
        self.codec = Codec(system, component)
        self.source = source
        self.x = 0
        self.buttons = 0
        self.talks_from: Nanoseconds = NEVER
        self.orders: list[tuple[int, tuple[float, ...]]] = []
        """Commands and their parameters, sent with every stick."""
        self.results: dict[int, int] = {}
        self.texts: list[str] = []
        self._due: Nanoseconds = 0

    def joins(self, ride: Ride) -> "ForeignNode":
        """Sit down on the operator's link."""
        ride.rig.world.attach(f"foreign node {self.source}", self, {OPERATOR: ride.rig.operator_wire})
        return self

    def talks(self, ride: Ride, at_s: float | None = None, *orders: tuple[int, tuple[float, ...]]) -> None:
        self.talks_from = ride.rig.world.now if at_s is None else from_seconds(at_s)
        self.orders = list(orders)

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        for message in self.codec.decode(packet.payload):
            if message.get_type() == "COMMAND_ACK" and message.target_system == self.codec.system:
                self.results[message.command] = message.result
            elif message.get_type() == "STATUSTEXT":
                self.texts.append(text_of(message.text))
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now < self._due:
            return Reaction((), self._due)
        self._due = now + PERIOD
        if now < self.talks_from:
            return Reaction((), self._due)
        messages: list[Any] = [dialect.MAVLink_manual_control_message(1, self.x, 0, 0, 0, self.buttons)]
        for command, params in self.orders:
            seven = (*params, *(0.0,) * (7 - len(params)))
            messages.append(dialect.MAVLink_command_long_message(1, 1, command, 0, *seven))
        sent = tuple(Packet(OPERATOR, self.source, self.codec.encode(message)) for message in messages)
        return Reaction(sent, self._due)
