"""A bridge on a real robot, on the live page: it is shown, and the page may stop it, and nothing else."""

from collections.abc import Callable
from typing import Final

from firmware_bridge.bridge import Bridge
from firmware_bridge.live.messages import LEVELS, VERSION
from firmware_bridge.live.page_node import PageError, PageNode
from firmware_bridge.live.state import Json, axes_of, bridge_state, outline_of
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.operator_texts import OperatorTexts
from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire.internet import number_of

SYSTEM: Final = 254
COMPONENT: Final = 190
PLACE: Final = number_of("127.0.0.1", 14_551)
"""What the page's emergency stop comes from, as a station of its own; answers to it end here."""


class LiveRobot(PageNode):
    """A node around a bridge."""

    def __init__(self, node: Node, bridge: Bridge, robot: AnyRobot, end: Callable[[], None]) -> None:
        """Take the bridge as it is carried and itself, its robot, and what ends the run in good order."""
        super().__init__(node)
        self._bridge: Final = bridge
        self._robot: Final = robot
        self._end: Final = end
        self._codec: Final = Codec(SYSTEM, COMPONENT)
        self._reader: Final = OperatorTexts()
        self._stops: Final = {"stop": self._stop, "emergency_stop": self._emergency_stop}

    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json]:
        del request
        stop = self._stops.get(name)
        if stop is None:
            raise PageError(
                f"'{name:.40}': a real robot is shown and stopped here; a ground station drives it"
            )
        reaction = stop(now)
        self.event(f"{name.replace('_', ' ')} of the live page", "warning", now)
        return reaction, {}

    def _stop(self, now: Nanoseconds) -> Reaction:
        """End the run as Ctrl-C does: standstill, then no power."""
        self._end()
        return self._node.wake(now)

    def _emergency_stop(self, now: Nanoseconds) -> Reaction:
        seven = (float(dialect.SAFETY_SWITCH_STATE_SAFE), *(0.0,) * 6)
        robot, number = self._robot.operator, dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
        message = dialect.MAVLink_command_long_message(robot.system_id, robot.component_id, number, 0, *seven)
        return self._node.receive(Packet(OPERATOR, PLACE, self._codec.encode(message)), now)

    def _leaves(self, packet: Packet, now: Nanoseconds) -> bool:
        """Read the bridge's texts, and keep answers to the page here."""
        if packet.link != OPERATOR:
            return True
        for text in self._reader.read(packet.payload):
            self.event(text.text, LEVELS[text.severity & 7], now)
        return packet.address != PLACE

    def _hello(self) -> Json:
        robot = self._robot
        return {
            "kind": "hello",
            "version": VERSION,
            "title": robot.title,
            "mode": "robot",
            "axes": axes_of(robot),
            "outline": outline_of(robot),
            "faults": [],
            "can": list(self._stops),
        }

    def _state(self, now: Nanoseconds) -> Json:
        return {
            "kind": "state",
            "at_s": to_seconds(now),
            "paused": False,
            "speed": 1.0,
            "measured": {},
            "buses": [],
            "faults": [],
            "kept_s": None,
            "true_pose": None,
            **bridge_state(self._robot, self._bridge),
        }
