"""`drive`: the bridge on a real bus, telling the user what it does."""

from collections.abc import Callable, Mapping
from typing import Annotated, Final, TypeAlias

import typer

from firmware_bridge.bridge import Bridge, Phase
from firmware_bridge.cli.console import find_robot
from firmware_bridge.cli.options import (
    BitRateOption,
    ChannelOption,
    DurationOption,
    InterfaceOption,
    RobotArgument,
    until,
)
from firmware_bridge.cli.real_time import carry
from firmware_bridge.node import CAN, OPERATOR, Node, Packet, Reaction, Stoppable
from firmware_bridge.safety.guard import Guarded
from firmware_bridge.safety.guard_rules import rules_for
from firmware_bridge.safety.snapshot import Hold
from firmware_bridge.shell.ports import UdpPort, open_can
from firmware_bridge.units import Nanoseconds, to_seconds

EXAMPLES: Final = """Examples:

`firmware-bridge drive rars -i socketcan -c can0`

`firmware-bridge drive rars -i slcan -c /dev/ttyACM0 -b 1000000 --mavlink udpout:192.168.1.10:14550`"""

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
    robot: RobotArgument,
    *,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    bit_rate: BitRateOption = None,
    mavlink: Annotated[
        str,
        typer.Option(
            metavar="LINK",
            help="The operator's link: udpin:HOST:PORT waits for a station, udpout:HOST:PORT calls one.",
        ),
    ] = "udpin:127.0.0.1:14550",
    duration: DurationOption = None,
) -> None:
    """Run the bridge on a real CAN bus: find the drives, set them up, and obey the operator's MAVLink.

    Ends on Ctrl-C: the robot is brought to rest first, then its drives are disabled.
    """
    machine = find_robot(robot)
    bridge = Bridge(machine)
    node = Narrated(bridge, Guarded(bridge, rules_for(machine)), typer.echo)
    rate = machine.bus.bit_rate
    carry(
        node,
        {
            CAN: lambda: open_can(interface, channel, bit_rate, default_bit_rate=rate),
            OPERATOR: lambda: UdpPort(mavlink),
        },
        until(duration),
        f"{machine.name}: bridge on {channel or 'the configured bus'}, operator on {mavlink}",
        StartUpFailedError,
    )
