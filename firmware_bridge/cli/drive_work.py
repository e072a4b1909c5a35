"""Runs the bridge on real links, telling the user what it does."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeAlias

from firmware_bridge.bridge import Bridge, Phase
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import until
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.drivers.serial.line import MaxonLine
from firmware_bridge.drivers.serial.plan import PlanError
from firmware_bridge.node import CAN, OPERATOR, SERIAL, Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Link, Robot
from firmware_bridge.safety.guard import Guarded, guarded
from firmware_bridge.safety.snapshot import Hold
from firmware_bridge.shell.ports import Port, ReturningLine, UdpPort, open_can
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds
from firmware_bridge.wire.maxon.frame import Generation

Tell: TypeAlias = Callable[[str], None]


class StartUpFailedError(Exception):
    """The robot's drives could not be set up: which one, what was expected, what came."""


class Narrated:
    """A bridge whose steps, holds and leave to move are told as they change.

    It ends the run when the start-up has failed. `node` is what is carried: the bridge, or a node around it.
    """

    def __init__(self, bridge: Bridge, node: Node, tell: Tell) -> None:
        self._bridge = bridge
        self._node = node
        self._tell = tell
        self._phase: Phase | None = None
        self._armed = False
        self._late = 0
        self._late_told_at: Nanoseconds = 0
        self._holds: tuple[Hold, ...] = ()

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass the packet on, and tell what has changed."""
        self._end_failed_start_up()
        return self._told(self._node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the bridge, and tell what has changed."""
        self._end_failed_start_up()
        return self._told(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the bridge, and tell what has changed."""
        reaction = self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()
        return self._told(reaction, now)

    def _end_failed_start_up(self) -> None:
        """End the run one call after the failure, so that what the bridge sent because of it has left."""
        bridge = self._bridge
        if bridge.failure is not None and bridge.phase is Phase.FAILED:
            raise StartUpFailedError(f"start-up failed: {bridge.failure}")

    def _told(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        bridge = self._bridge
        if bridge.phase is not self._phase:
            self._phase = bridge.phase
            self._say(self._phase.value, now)
        if bridge.seen.armed != self._armed:
            self._armed = bridge.seen.armed
            self._say("armed" if self._armed else "disarmed", now)
        late = bridge.link.late
        if late != self._late and now - self._late_told_at >= SECOND:
            self._say(f"late: {late - self._late} cycles were longer than the robot file says", now)
            self._late, self._late_told_at = late, now
        if bridge.holds != self._holds and bridge.phase is not Phase.FAILED:  # what failed is told at the end
            self._tell_holds({hold.name: hold for hold in bridge.holds}, now)
            self._holds = bridge.holds
        return reaction

    def _tell_holds(self, standing: Mapping[str, Hold], now: Nanoseconds) -> None:
        known = {hold.name: hold.reason for hold in self._holds}
        for name in known:
            if name not in standing:
                self._say(f"lets go: {name}", now)
        for name, hold in standing.items():
            if known.get(name) != hold.reason:
                self._say(f"holds: {name}: {hold.reason} ({hold.remedy})", now)

    def _say(self, text: str, now: Nanoseconds) -> None:
        self._tell(f"{to_seconds(now):9.3f} s  {text}")


def drive(
    robot: str,
    *,
    interface: str | None,
    channel: str | None,
    bit_rate: int | None,
    mavlink: str,
    serial: str | None,
    baud: int | None,
    protocol: Generation | None,
    duration: float | None,
) -> None:
    """Do what `drive` says; what is wrong ends the program with a message."""
    machine = _with_line(find_robot(robot), serial, protocol, baud)
    with one_message(PlanError):
        bridge = Bridge(machine)
    guard = guarded(bridge, machine)
    if machine.bus.link is Link.SERIAL:
        way = _serial_way(machine, guard, serial)
    else:
        way = _can_way(machine, guard, interface, channel, bit_rate)
    carry(
        Narrated(bridge, way.node, say),
        {way.link: way.opener, OPERATOR: lambda: UdpPort(mavlink)},
        until(duration),
        f"{machine.name}: bridge on {way.title}, operator on {mavlink}",
        StartUpFailedError,
    )


class _Way(NamedTuple):
    """How packets leave for the drives."""

    link: str
    node: Node
    opener: Callable[[], Port]
    title: str


def _with_line(machine: Robot, serial: str | None, protocol: Generation | None, baud: int | None) -> Robot:
    """Return the robot on its serial link where that is asked for."""
    if serial is None and machine.bus.link is not Link.SERIAL:
        if protocol is not None or baud is not None:
            raise refusal("--protocol and --baud are of a serial port; name it with --serial DEVICE")
        return machine
    return machine.over_serial(protocol, baud)


def _serial_way(machine: Robot, guard: Guarded, device: str | None) -> _Way:
    bus = machine.bus
    if device is None:
        raise refusal(f"{machine.name} is driven over a serial line; name its port with --serial DEVICE")
    title = f"{device} ({bus.protocol.value}, {bus.line_rate} Bd), node {bus.gateway} passes on to the others"
    return _Way(SERIAL, MaxonLine(guard, bus.protocol), lambda: ReturningLine(device, bus.line_rate), title)


def _can_way(
    machine: Robot, guard: Guarded, interface: str | None, channel: str | None, bit_rate: int | None
) -> _Way:
    rate = machine.bus.bit_rate
    title = channel or "the configured bus"
    return _Way(CAN, guard, lambda: open_can(interface, channel, bit_rate, default_bit_rate=rate), title)
