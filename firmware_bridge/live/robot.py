"""A bridge on a real robot, on the live page: it is shown, and the page may stop it, and nothing else."""

from collections.abc import Callable
from contextlib import suppress
from typing import Final

from firmware_bridge.bridge import Bridge
from firmware_bridge.json_line import JsonLineError, read_object
from firmware_bridge.live.messages import (
    ALL_PAGES,
    CLOSED,
    LEVELS,
    LIVE,
    MOST_EVENTS,
    OPENED,
    SHOWN_EVERY,
    VERSION,
    encoded,
)
from firmware_bridge.live.state import Json, axes_of, bridge_state
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.operator_texts import OperatorTexts
from firmware_bridge.node import OPERATOR, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire.internet import number_of

SYSTEM: Final = 254
COMPONENT: Final = 190
PLACE: Final = number_of("127.0.0.1", 14_551)
"""What the page's emergency stop comes from, as a station of its own; answers to it end here."""


class LiveRobot:
    """A node around a bridge."""

    def __init__(self, node: Node, bridge: Bridge, robot: AnyRobot, end: Callable[[], None]) -> None:
        """Take the bridge as it is carried and itself, its robot, and what ends the run in good order."""
        self._node: Final = node
        self._bridge: Final = bridge
        self._robot: Final = robot
        self._type: Final = robot_type_of(robot)
        self._end: Final = end
        self._codec: Final = Codec(SYSTEM, COMPONENT)
        self._reader: Final = OperatorTexts()
        self._pages: Final[set[int]] = set()
        self._events: Final[list[Json]] = []
        self._new: list[Json] = []
        self._shown_at: Nanoseconds = -SHOWN_EVERY
        self._stops: Final = {"stop": self._stop, "emergency_stop": self._emergency_stop}

    @property
    def holding(self) -> bool:
        """True while the bridge keeps the robot from moving after a command to end."""
        return holds(self._node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take what a page has sent; pass on everything else."""
        if packet.link != LIVE:
            return self._shown(self._node.receive(packet, now), now)
        if packet.payload == OPENED:
            self._pages.add(packet.address)
            messages = (self._hello(), {"kind": "events", "events": self._events}, self._state(now))
            sent = tuple(Packet(LIVE, packet.address, encoded(one)) for one in messages)
            reaction = self._node.wake(now)
            return Reaction((*reaction.sent, *sent), reaction.wake_at)
        if packet.payload == CLOSED:
            self._pages.discard(packet.address)
            return self._shown(self._node.wake(now), now)
        return self._requested(packet, now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the bridge, and show it."""
        return self._shown(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the bridge."""
        reaction = self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()
        return self._shown(reaction, now)

    def _requested(self, packet: Packet, now: Nanoseconds) -> Reaction:
        number, name = None, ""
        # What cannot be read is refused as a request without a name.
        with suppress(JsonLineError):
            request = read_object(packet.payload)
            number, name = request.get("id"), str(request.get("do"))
        stop = self._stops.get(name)
        if stop is None:
            refusal = f"'{name:.40}': a real robot is shown and stopped here; a ground station drives it"
            reaction, answer = self._node.wake(now), {"id": number, "ok": False, "error": refusal}
        else:
            reaction, answer = stop(now), {"id": number, "ok": True}
            self._event(f"{name.replace('_', ' ')} of the live page", "warning", now)
        shown = self._shown(reaction, now)
        return Reaction((*shown.sent, Packet(LIVE, packet.address, encoded(answer))), shown.wake_at)

    def _stop(self, now: Nanoseconds) -> Reaction:
        """End the run as Ctrl-C does: standstill, then no power."""
        self._end()
        return self._node.wake(now)

    def _emergency_stop(self, now: Nanoseconds) -> Reaction:
        seven = (float(dialect.SAFETY_SWITCH_STATE_SAFE), *(0.0,) * 6)
        robot, number = self._robot.operator, dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
        message = dialect.MAVLink_command_long_message(robot.system_id, robot.component_id, number, 0, *seven)
        return self._node.receive(Packet(OPERATOR, PLACE, self._codec.encode(message)), now)

    def _shown(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        """Read the bridge's texts, keep answers to the page here, and add what the pages have not seen."""
        sent = []
        for packet in reaction.sent:
            if packet.link == OPERATOR:
                for text in self._reader.read(packet.payload):
                    self._event(text.text, LEVELS[text.severity & 7], now)
            if packet.link != OPERATOR or packet.address != PLACE:
                sent.append(packet)
        if now - self._shown_at >= SHOWN_EVERY:
            self._shown_at = now
            new, self._new = self._new, []
            if self._pages:
                messages = (self._state(now), *([{"kind": "events", "events": new}] if new else ()))
                sent += [Packet(LIVE, ALL_PAGES, encoded(one)) for one in messages]
        return Reaction(tuple(sent), reaction.wake_at)

    def _hello(self) -> Json:
        robot = self._robot
        return {
            "kind": "hello",
            "version": VERSION,
            "title": robot.title,
            "mode": "robot",
            "axes": axes_of(robot),
            "outline": [],
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
            **bridge_state(self._type, self._bridge),
        }

    def _event(self, text: str, level: str, now: Nanoseconds) -> None:
        event = {"at_s": to_seconds(now), "text": text, "level": level}
        self._events.append(event)
        self._new.append(event)
        del self._events[:-MOST_EVENTS]
        del self._new[:-MOST_EVENTS]
