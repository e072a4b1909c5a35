"""A recording in MCAP as the live page shows it: the state at each instant, and what happened between two.

Importing this module needs the extra `mcap`.
"""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from firmware_bridge.live.state import Json, number
from firmware_bridge.mcap_file import channels
from firmware_bridge.mcap_file.reader import messages
from firmware_bridge.mcap_file.rows import EventKind
from firmware_bridge.units import Nanoseconds, to_seconds

MOST_FRAMES: Final = 100
"""So many frames are shown at a time; of more the newest."""
LEVELS: Final = ("info", "info", "info", "warning", "error", "error")
"""The page's levels by those of foxglove.Log."""


@dataclass(slots=True)
class Track:
    """Values of one channel, each with its instant, in the order of time."""

    at: list[Nanoseconds] = field(default_factory=list)
    values: list[Any] = field(default_factory=list)

    def add(self, at: Nanoseconds, value: Any) -> None:
        """Add a value, which is not before the last."""
        self.at.append(at)
        self.values.append(value)

    def newest(self, now: Nanoseconds) -> Any:
        """Return the last value up to an instant; None before the first."""
        place = bisect_right(self.at, now)
        return self.values[place - 1] if place else None

    def between(self, after: Nanoseconds, now: Nanoseconds) -> list[tuple[Nanoseconds, Any]]:
        """Return the values behind one instant, up to another."""
        first, last = bisect_right(self.at, after), bisect_right(self.at, now)
        return list(zip(self.at[first:last], self.values[first:last], strict=True))


class Recording:
    """One recording, whole in memory."""

    def __init__(self, path: Path, note: Callable[[str], None]) -> None:
        """Read it; `note` takes remarks. RecordingError, OSError."""
        self.end: Nanoseconds = 0
        """Its last instant."""
        self._drives: Final[dict[str, Track]] = {}
        self._poses: Final = {channels.POSE: Track(), channels.ODOMETRY: Track()}
        self._events, self._frames, self._armed = Track(), Track(), Track()
        self._interlocks, self._faults = Track(), Track()
        self._active: dict[str, Json] = {}
        self._on: dict[tuple[str, tuple[str, ...]], Json] = {}
        for at, topic, message in messages(path, note):
            self.end = max(self.end, at)
            self._take(at, topic, message)

    @property
    def axes(self) -> list[Json]:
        """The axes as the page introduces them, in the order of their channels."""
        found = []
        for topic, track in self._drives.items():
            first, name = track.values[0], topic.removeprefix("/drive/").removesuffix("/state")
            found.append({"name": first.axis, "title": first.axis, "unit": first.unit, "number": name})
        return found

    def state(self, now: Nanoseconds) -> Json:
        """Return everything at an instant."""
        true, odometry = (self._poses[topic].newest(now) for topic in (channels.POSE, channels.ODOMETRY))
        return {
            "armed": bool(self._armed.newest(now)),
            "mode": "",
            "pose": odometry or true,
            "true_pose": true,
            "command": {},
            "measured": {},
            "axes": [_axis(value) for track in self._drives.values() if (value := track.newest(now))],
            "interlocks": list(self._interlocks.newest(now) or ()),
            "operator": {"station": "", "age_s": None, "loss_percent": None},
            "buses": [],
            "faults": list(self._faults.newest(now) or ()),
        }

    def events(self, after: Nanoseconds, now: Nanoseconds) -> list[Json]:
        """Return what happened behind one instant, up to another."""
        found = self._events.between(after, now)
        return [{"at_s": to_seconds(at), "text": text, "level": level} for at, (text, level) in found]

    def frames(self, after: Nanoseconds, now: Nanoseconds) -> list[tuple[Nanoseconds, Any]]:
        """Return the frames behind one instant, up to another."""
        return self._frames.between(after, now)

    def _take(self, at: Nanoseconds, topic: str, message: Any) -> None:
        if topic in self._poses:
            self._poses[topic].add(at, _pose(message))
        elif topic == channels.FRAMES:
            self._frames.add(at, message)
        elif topic == channels.EVENTS:
            self._event(at, message)
        elif topic == channels.LOG:
            self._events.add(at, (message.message, LEVELS[min(message.level, len(LEVELS) - 1)]))
        elif topic.startswith("/drive/"):
            self._drives.setdefault(topic, Track()).add(at, message)

    def _event(self, at: Nanoseconds, message: Any) -> None:
        begun, key = to_seconds(message.since_ns), (message.name, tuple(message.devices))
        match message.kind:
            case EventKind.ARMED | EventKind.DISARMED:
                self._armed.add(at, message.kind == EventKind.ARMED)
            case EventKind.INTERLOCK_ACTIVE:
                shown = {"name": message.name, "reason": message.text, "remedy": message.remedy}
                self._active[message.name] = {**shown, "since_s": begun}
                self._interlocks.add(at, tuple(self._active.values()))
            case EventKind.INTERLOCK_CLEARED:
                self._active.pop(message.name, None)
                self._interlocks.add(at, tuple(self._active.values()))
            case EventKind.FAULT_BEGAN:
                fault = {"number": len(self._faults.at), "kind": message.name, "nodes": list(message.devices)}
                self._on[key] = {**fault, "began_s": begun}
                self._faults.add(at, tuple(self._on.values()))
                self._events.add(
                    at, (f"fault {message.name} begins: {', '.join(message.devices)}", "warning")
                )
            case EventKind.FAULT_ENDED:
                self._on.pop(key, None)
                self._faults.add(at, tuple(self._on.values()))
                self._events.add(at, (f"fault {message.name} ends", "info"))


def _axis(message: Any) -> Json:
    return {
        "name": message.axis,
        "power": message.power,
        "state": message.state,
        "position": number(message.position) if message.HasField("position") else None,
        "velocity": number(message.velocity) if message.HasField("velocity") else None,
        "target": None,
        "current_a": number(message.current_a) if message.HasField("current_a") else None,
        "temperature_c": None,
        "fault": message.fault,
    }


def _pose(message: Any) -> list[float | None]:
    place, turned = message.pose.position, message.pose.orientation
    heading = 2.0 * math.atan2(turned.z, turned.w)
    return [number(place.x), number(place.y), number(heading)]
