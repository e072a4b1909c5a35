"""A pilot's station on the live page: what it receives of the robot, and a stop."""

from collections.abc import Callable
from typing import Final

from firmware_bridge.live.messages import VERSION
from firmware_bridge.live.page_node import PageError, PageNode
from firmware_bridge.live.state import Json, number, outline_of
from firmware_bridge.node import Node
from firmware_bridge.packet import Reaction
from firmware_bridge.pilot.cockpit import SAFETY_SWITCH
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds, to_seconds


class LivePilot(PageNode):
    """A node around a station; of the robot's axes it knows the speeds of those that roll."""

    def __init__(
        self,
        node: Node,
        station: PilotStation,
        robot: AnyRobot,
        rolling: tuple[str, ...],
        end: Callable[[], None],
    ) -> None:
        """Take the station as it is carried and itself, its robot, which axes roll, and what ends the run."""
        super().__init__(node)
        self._station: Final = station
        self._robot: Final = robot
        self._rolling: Final = rolling
        self._end: Final = end
        self._lines = 0
        """So many of the robot's texts are events."""

    def _hello(self) -> Json:
        return {
            "kind": "hello",
            "version": VERSION,
            "title": f"{self._robot.title}, pilot",
            "mode": "station",
            "axes": [{"name": name, "title": name, "unit": "rad", "number": None} for name in self._rolling],
            "outline": outline_of(self._robot),
            "faults": [],
            "can": ["stop", "emergency_stop"],
        }

    def _state(self, now: Nanoseconds) -> Json:
        shown, link = self._station.shown, self._station.link
        trip = link.round_trip(now)
        lines = shown.lines
        for line in lines[self._lines :]:
            self.event(line.text, "warning" if line.text == shown.warning else "info", line.at)
        self._lines = len(lines)
        moving = None if shown.sight is None else shown.sight.moving
        pose = None if moving is None else moving.pose
        speed = {} if moving is None else {"speed": number(moving.speed_mps)}
        battery = {} if shown.battery_v is None else {"battery": number(shown.battery_v)}
        return {
            "kind": "state",
            "at_s": to_seconds(now),
            "paused": False,
            "speed": 1.0,
            "armed": shown.armed if shown.received else None,
            "pose": None if pose is None else [number(pose.x_m), number(pose.y_m), number(pose.heading_rad)],
            "command": {},
            "measured": {name: number(value) for name, value in shown.values.items()} | speed | battery,
            "axes": [_axis(*one) for one in zip(self._rolling, shown.speeds, strict=False)],
            "interlocks": [],
            "operator": {
                "station": "this one",
                "age_s": None if trip is None else to_seconds(trip) / 2.0,
                "loss_percent": None if link.lost is None else number(100.0 * link.lost),
            },
            "buses": [],
            "faults": [],
        }

    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json]:
        del request
        if name == "stop":
            # As Ctrl-C does: the controls go to neutral, and the robot is disarmed.
            self._end()
        elif name == "emergency_stop":
            self._station.order(*SAFETY_SWITCH, now)
        else:
            raise PageError(f"'{name:.40}': the pilot's own controls drive; the page shows, and stops")
        self.event(f"{name.replace('_', ' ')} of the live page", "warning", now)
        return self._node.wake(now), {}


def _axis(name: str, speed: float) -> Json:
    return {
        "name": name,
        "power": "unknown",
        "state": "",
        "position": None,
        "velocity": number(speed),
        "target": None,
        "current_a": None,
        "temperature_c": None,
        "fault": "",
    }
