"""The guard's rules for a link with one axis, which is commanded by speed; a family gives its lines."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Final

from firmware_bridge.extensible import extensible
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import ROUNDING, WireRules
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.lines import LineReader


class GuardedSpeed:
    """The axis, and the set-point in force at its device: an `InForce`."""

    def __init__(self, axis: Axis, robot: AnyRobot) -> None:
        self.axis: Final = axis
        self.cycle: Final = robot.cycle * robot.links[axis.link].every
        self.all: tuple[InForce, ...] = ()
        self.commanded_at: Nanoseconds = -NEVER
        self.homes: Final = False
        self.homes_within_s: Final = 0.0
        self.speed = 0.0
        """In the axis's unit a second."""
        self.powered = False
        """True from the command for power until its device has reported that it has none."""

    @property
    def moving(self) -> bool:
        """True while a speed is in force."""
        return self.speed != 0.0


@extensible(allow_interpreted_subclasses=True)
class OneAxisRules(WireRules):
    """Lines to one device. Its axis is commanded no faster than `top_speed`, and given no power in motion."""

    LISTED: ClassVar[frozenset[bytes]]
    """Lines, with their ends, that may leave beside speeds and stops."""
    POWERS: ClassVar[bytes]
    """That of them which gives power."""
    STOPS: ClassVar[frozenset[bytes]]
    """Lines that stop the axis, and may always leave."""
    SAFE: ClassVar[bytes]
    """The line that takes the place of a refused one: it takes motion away and gives no power."""

    END: ClassVar[bytes] = b"\n"
    """The end of a received line."""

    def __init__(self, robot: AnyRobot, link: str) -> None:
        self.link = link
        (axis,) = robot.axes_on(link)
        self.axis: Final = axis
        self._guarded: Final = GuardedSpeed(axis, robot)
        self._received: Final = LineReader(self.END)
        self._most: Final = axis.top_speed * (1.0 + ROUNDING)
        self.axes: tuple[InForce, ...] = (self._guarded,)

    @abstractmethod
    def speed_of(self, line: bytes) -> float | None:
        """Return the speed that a line commands, in the axis's unit a second; None where it is no speed."""

    @abstractmethod
    def unpowered_by(self, line: bytes) -> bool:
        """Return whether a received line, without its end, reports no power; a doubt is power."""

    def axes_of(self, packet: Packet) -> tuple[InForce, ...]:
        """Return the axis for a line that sets its speed, or stops it."""
        return () if self._speed(packet.payload) is None else self.axes

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return the speed of a set-point."""
        speed = self._speed(packet.payload) or 0.0
        return {self._guarded: RequestedMotion(speed != 0.0, speed)}

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Look into the list, and at the bound."""
        del now
        line, speed = packet.payload, self._speed(packet.payload)
        if packet.address != 0 or not (speed is not None or line in self.LISTED or line == self.POWERS):
            return f"the line {line!r} is not listed"
        if line == self.POWERS and self._guarded.moving:
            return f"{self.axis.called}: power on while a speed is in force"
        # Written so that a speed that is no number is refused.
        if not abs(speed or 0.0) <= self._most:
            return f"{self.axis.called}: {speed:.6g} {self.axis.unit}/s is beyond {self.axis.top_speed:g}"
        return None

    def safe(self, axis: InForce) -> tuple[Packet, ...]:
        """Return the safe line."""
        del axis
        return (Packet(self.link, 0, self.SAFE),)

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[InForce, ...]:
        """Note the speed, and the power, in force."""
        del now, requested
        speed = self._speed(packet.payload)
        if packet.payload == self.POWERS:
            self._guarded.powered = True
        if speed is None:
            return ()
        self._guarded.speed = speed
        return self.axes

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Note that the device has no power; everything is the bridge's."""
        del now
        if packet.address == 0 and any(map(self.unpowered_by, self._received.receive(packet.payload))):
            self._guarded.powered = False
        return True

    def _speed(self, line: bytes) -> float | None:
        return 0.0 if line in self.STOPS else self.speed_of(line)
