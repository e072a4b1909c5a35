"""A recording on the live page: played at any pace, paused, and put to any instant."""

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.json_line import JsonLineError, read_object
from firmware_bridge.live.messages import (
    ALL_PAGES,
    CLOSED,
    LIVE,
    OPENED,
    SHOWN_EVERY,
    VERSION,
    encoded,
)
from firmware_bridge.live.recording import MOST_FRAMES, Recording
from firmware_bridge.live.state import Json, Outline
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds
from firmware_bridge.wire.can import EXTENDED, REMOTE
from firmware_bridge.wire.can_error import error_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

SLOWEST, FASTEST = 0.1, 10.0
BIT_RATE: Final = 1_000_000
"""Only for the load, which is not shown from here."""
ERROR_NAME: Final = "error"
"""In the place of an identifier, which a report of the CAN interface has none of."""


class PlayerError(Exception):
    """A request that cannot be carried out: why."""


class Player:
    """A node that has only pages."""

    def __init__(
        self,
        recording: Recording,
        title: str,
        device: str = "",
        incidents: "Sequence[Json]" = (),
        outline: "Sequence[Outline]" = (),
    ) -> None:
        """Take the recording, its title, the family of nodes whose mapping it lacks, and its incidents.

        `outline` is its robot's; none: an arrow.
        """
        self._outline: Final = list(outline)
        self._incidents: Final = list(incidents)
        self._recording: Final = recording
        self._title: Final = title
        self._device: Final = device
        self._picture = BusPicture(BIT_RATE, device=device)
        self._read: Nanoseconds = -1
        """The last instant whose frames the picture has; they show what is mapped."""
        self._pages: Final[set[int]] = set()
        self._factor, self._paused = 1.0, False
        self._since: Nanoseconds = 0
        self._base: Nanoseconds = 0
        """The instant of the recording at that of the clock, since it has this pace."""
        self._shown: Nanoseconds = -1
        """The last instant that was shown."""
        self._wanted: str | None = None
        """What a frame's text has to hold; None where no frames are wanted."""
        self._does: Final[dict[str, Callable[[Json, Nanoseconds], Json]]] = {
            "pause": self._pause,
            "speed": self._speed,
            "step": self._step,
            "rewind": self._rewind,
            "watch_frames": self._watch_frames,
        }

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take what a page has sent."""
        if packet.payload == OPENED:
            self._pages.add(packet.address)
            at = self._at(now)
            events = {"kind": "events", "events": self._recording.events(-1, at)}
            incidents = {"kind": "incidents", "incidents": self._incidents}
            sent = [encoded(one) for one in (self._hello(), events, incidents, self._state(at))]
            return Reaction(tuple(Packet(LIVE, packet.address, one) for one in sent), now + SHOWN_EVERY)
        if packet.payload == CLOSED:
            self._pages.discard(packet.address)
            return Reaction((), now + SHOWN_EVERY)
        answer = self._answer(packet.payload, now)
        return Reaction((Packet(LIVE, packet.address, encoded(answer)),), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Show the instant of now, and what happened since the last one."""
        at, before, self._shown = self._at(now), self._shown, self._at(now)
        if not self._pages:
            return Reaction((), now + SHOWN_EVERY)
        messages = [self._state(at)]
        if events := self._recording.events(before, at):
            messages.append({"kind": "events", "events": events})
        if frames := self._frames(before, at):
            messages.append({"kind": "frames", "frames": frames})
        sent = tuple(Packet(LIVE, ALL_PAGES, encoded(one)) for one in messages)
        return Reaction(sent, now + SHOWN_EVERY)

    def _at(self, now: Nanoseconds) -> Nanoseconds:
        """Return the recording's instant."""
        gone = 0 if self._paused else round((now - self._since) * self._factor)
        return min(self._base + gone, self._recording.end)

    def _paces(self, now: Nanoseconds, base: Nanoseconds) -> None:
        self._base, self._since = max(0, min(base, self._recording.end)), now

    def _answer(self, line: bytes, now: Nanoseconds) -> Json:
        request: Json = {}
        with suppress(JsonLineError):
            request = read_object(line)
        name = request.get("do")
        work = self._does.get(name) if isinstance(name, str) else None
        if work is None:
            return {
                "id": request.get("id"),
                "ok": False,
                "error": f"a recording has: {', '.join(self._does)}",
            }
        try:
            return {"id": request.get("id"), "ok": True, **work(request, now)}
        except PlayerError as error:
            return {"id": request.get("id"), "ok": False, "error": str(error)}

    def _pause(self, request: Json, now: Nanoseconds) -> Json:
        on = request.get("on")
        if not isinstance(on, bool):
            raise PlayerError('pause: give "on", true or false')
        self._paces(now, self._at(now))
        self._paused = on
        return {}

    def _speed(self, request: Json, now: Nanoseconds) -> Json:
        factor = _number(request, "factor", SLOWEST, FASTEST)
        self._paces(now, self._at(now))
        self._factor = factor
        return {}

    def _step(self, request: Json, now: Nanoseconds) -> Json:
        by = from_seconds(_number(request, "seconds", 0.0, 60.0))
        self._paces(now, self._at(now) + by)
        self._paused = True
        return {"at_s": to_seconds(self._base)}

    def _rewind(self, request: Json, now: Nanoseconds) -> Json:
        to = from_seconds(_number(request, "to_s", 0.0, to_seconds(self._recording.end)))
        self._paces(now, to)
        self._shown = self._base
        return {"at_s": to_seconds(self._base)}

    def _watch_frames(self, request: Json, now: Nanoseconds) -> Json:
        del now
        wanted = request.get("filter", "")
        self._wanted = str(wanted).lower() if request.get("on") is True else None
        return {}

    def _frames(self, after: Nanoseconds, now: Nanoseconds) -> list[list[Any]]:
        if self._wanted is None:
            return []
        if after < self._read:
            self._picture, self._read = BusPicture(BIT_RATE, device=self._device), -1
        found = []
        for at, frame in self._recording.frames(self._read, now):
            name, text = self._shown_frame(at, frame, shown=at > after)
            if at > after and (self._wanted in text.lower() or self._wanted in name.lower()):
                found.append([to_seconds(at), frame.bus, name, text])
        self._read = now
        return found[-MOST_FRAMES:]

    def _shown_frame(self, at: Nanoseconds, frame: Any, *, shown: bool) -> tuple[str, str]:
        """Take a frame; return its identifier, and where it is shown its text."""
        if frame.error:
            return ERROR_NAME, error_text(frame.id, frame.data)
        flags = (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
        packet = Packet(CAN, frame.id | flags, bytes(min(frame.requested, 8)) if frame.remote else frame.data)
        self._picture.note(at, packet)
        return f"{frame.id:03X}", self._picture.text_of(packet) if shown else ""

    def _hello(self) -> Json:
        return {
            "kind": "hello",
            "version": VERSION,
            "title": self._title,
            "mode": "recording",
            "axes": self._recording.axes,
            "outline": self._outline,
            "faults": [],
            "can": list(self._does),
        }

    def _state(self, at: Nanoseconds) -> Json:
        return {
            "kind": "state",
            "at_s": to_seconds(at),
            "paused": self._paused or at >= self._recording.end,
            "speed": self._factor,
            "kept_s": [0.0, to_seconds(self._recording.end)],
            **self._recording.state(at),
        }


def _number(request: Json, name: str, least: float, most: float) -> float:
    value = request.get(name, 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
        raise PlayerError(
            f"{request['do']}: {name} is a number from {least:g} to {most:g}, not {value!r:.40}"
        )
    return float(value)
