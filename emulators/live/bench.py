"""A bench at the clock's pace on the live page: what it shows, and what a page may request."""

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from emulators.bench.columns import POSE
from emulators.control.desk import CONTROL, Desk
from emulators.control.lines import LineError, request_of
from emulators.live.control import PageControl
from emulators.live.hello import hello
from emulators.live.incidents import LiveIncidents
from emulators.live.moments import Moments
from emulators.live.page_station import NEUTRAL, ORDERS, PageStation, Stick
from emulators.live.trace import TracedFrames
from emulators.paced import PacedRig
from emulators.rig import Rig
from firmware_bridge.live.messages import (
    ALL_PAGES,
    CLOSED,
    LEVELS,
    LIVE,
    MOST_EVENTS,
    OPENED,
    SHOWN_EVERY,
    encoded,
)
from firmware_bridge.live.state import Json, bridge_state, number
from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from emulators.wires.ends import Observed

STATION: Final = "live page"
SLOWEST, FASTEST = 0.1, 10.0
LONGEST_STEP_S: Final = 10.0
OF_DESK: Final = ("inject", "clear", "set", "restart", "shutdown")


class PageError(Exception):
    """A request of the page that cannot be carried out: why."""


class LiveBench:
    """A node around the control desk; what is not the page's passes to it."""

    def __init__(self, rig: Rig, paced: PacedRig, desk: Desk, title: str, operator: Node | None) -> None:
        """Take the bench, what paces it, its desk, its title for people, and its operator."""
        self._rig: Final = rig
        self._paced: Final = paced
        self._desk: Final = desk
        self._title: Final = title
        self._type: Final = robot_type_of(rig.robot)
        self._moments: Final = Moments(rig)
        self._frames: Final = TracedFrames(rig)
        self._incidents: Final = LiveIncidents(rig)
        self._pages: Final[set[int]] = set()
        self._events: Final[list[Json]] = []
        self._shown_at: Nanoseconds = -SHOWN_EVERY
        self._now: Nanoseconds = 0
        self._branched = False
        """True once time was put back."""
        robot = rig.robot.operator
        self._station: Final = PageStation((robot.system_id, robot.component_id))
        rig.world.attach(STATION, self._station, {OPERATOR: rig.operator_wire})
        self._control: Final = PageControl(rig, self._station, operator)
        self._does: Final[Mapping[str, Callable[[Json], Json]]] = {
            "pause": self._pause,
            "speed": self._speed,
            "step": self._step,
            "rewind": self._rewind,
            "drive": self._drive,
            "watch_frames": self._watch_frames,
            **dict.fromkeys((name for name, _ in ORDERS), self._order),
        }

    @property
    def finished(self) -> bool:
        """True at the end of its time, or once a client has ended it."""
        return self._desk.finished

    def report(self, text: str) -> None:
        """Show what the desk has done among the events."""
        self._event(text, "warning")

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Carry out a page's request; pass on everything else."""
        self._now = now
        if packet.link != LIVE:
            return self._shown(self._desk.receive(packet, now), now)
        if packet.payload == OPENED:
            self._pages.add(packet.address)
            reaction = self._desk.wake(now)
            first = hello(self._title, self._rig.robot, (*OF_DESK, *self._does))
            known = {"kind": "incidents", "incidents": self._incidents.found}
            messages = (first, {"kind": "events", "events": self._events}, known, self._state())
            sent = tuple(Packet(LIVE, packet.address, encoded(one)) for one in messages)
            return Reaction((*reaction.sent, *sent), reaction.wake_at)
        if packet.payload == CLOSED:
            self._pages.discard(packet.address)
            if not self._pages:
                self._station.leaves(self._rig.world.now)
            return self._desk.wake(now)
        return self._shown(self._requested(packet), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Let time pass, and show it."""
        self._now = now
        reaction = self._desk.wake(now)
        self._moments.keep(self._rig.world.now)
        if self._control.turn():
            self._rig.world.rouse(STATION)
        return self._shown(reaction, now)

    def _requested(self, packet: Packet) -> Reaction:
        """Carry out one request; a stick has no answer."""
        before = self._desk.wake(self._now)
        request: Json = {}
        answer: Json
        try:
            request = request_of(packet.payload)
            work = self._does.get(request["do"])
            if work is None:
                reaction = self._desk.receive(Packet(CONTROL, packet.address, packet.payload), self._now)
                mine = [one for one in reaction.sent if one.link == CONTROL]
                others = [one for one in reaction.sent if one.link != CONTROL]
                answers = (Packet(LIVE, packet.address, one.payload) for one in mine)
                return Reaction((*before.sent, *others, *answers), reaction.wake_at)
            answer = {"id": request.get("id"), "ok": True, **work(request)}
        except (LineError, PageError) as error:
            answer = {"id": request.get("id"), "ok": False, "error": str(error)}
        after = self._desk.wake(self._now)
        sent = (*before.sent, *after.sent)
        if request.get("do") != "drive":
            sent = (*sent, Packet(LIVE, packet.address, encoded(answer)))
        return Reaction(sent, after.wake_at)

    # Requests

    def _pause(self, request: Json) -> Json:
        on = request.get("on")
        if not isinstance(on, bool):
            raise PageError('pause: give "on", true or false')
        self._paced.paces(self._now, paused=on)
        return {}

    def _speed(self, request: Json) -> Json:
        factor = _number(request, "factor", SLOWEST, FASTEST)
        self._paced.paces(self._now, factor=factor)
        return {}

    def _step(self, request: Json) -> Json:
        seconds = _number(request, "seconds", 0.0, LONGEST_STEP_S)
        self._paced.steps(self._now, from_seconds(seconds))
        return {"at_s": to_seconds(self._rig.world.now)}

    def _rewind(self, request: Json) -> Json:
        first, last = self._moments.first or 0, self._rig.world.now
        to = from_seconds(_number(request, "to_s", to_seconds(first), to_seconds(last)))
        if not self._branched:
            self._branched = True
            # A recording in which time steps back would mislead: it ends here.
            for wire in _wires(self._rig):
                wire.unobserved()
            self._frames.follow()
            self._event("the recording of this run ends here", "warning")
        with suppress(ValueError):
            self._moments.go_back(to)
        self._frames.forget()
        self._incidents.follow()
        self._control.forget()
        self._paced.paces(self._now, paused=True)
        self._event(f"time is put back from {to_seconds(last):.2f} s to {to_seconds(to):.2f} s", "info")
        return {"at_s": to_seconds(self._rig.world.now)}

    def _drive(self, request: Json) -> Json:
        x, y, r = (_number(request, name, -1.0, 1.0) for name in "xyr")
        z = _number({"z": NEUTRAL.z, **request}, "z", 0.0, 1.0)
        buttons = request.get("buttons", 0)
        if not isinstance(buttons, int):
            raise PageError("drive: buttons are bits of a whole number")
        self._station.moves(Stick(x, y, z, r, buttons), self._rig.world.now)
        self._rig.world.rouse(STATION)
        return {}

    def _order(self, request: Json) -> Json:
        name, on = request["do"], request.get("on", True)
        if not isinstance(on, bool) or (name, on) not in ORDERS:
            raise PageError(f'{name}: "on" is true or false')
        if name.endswith("stop"):
            # A bench that stands still would not carry it out.
            self._paced.paces(self._now, paused=False)
        if name == "stop":
            self._control.stop()
        elif name == "take_control":
            self._control.take(on=on)
        else:
            self._station.orders(name, on=on)
        self._control.turn()
        self._rig.world.rouse(STATION)
        return {}

    def _watch_frames(self, request: Json) -> Json:
        wanted = request.get("filter", "")
        self._frames.watch(on=bool(request.get("on")), wanted=wanted if isinstance(wanted, str) else "")
        return {}

    # What is shown

    def _shown(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        """Add what the pages have not seen yet, where it is time."""
        if now - self._shown_at < SHOWN_EVERY:
            return reaction
        self._shown_at = now
        texts = self._station.texts.take(self._rig.world.now)
        refusals, self._station.refusals = self._station.refusals, []
        new = [self._event(text, LEVELS[severity & 7]) for severity, text in texts]
        new += [self._event(text, "warning") for text in refusals]
        if not self._pages:
            return reaction
        messages = [self._state()]
        if new:
            messages.append({"kind": "events", "events": new})
        incidents = self._incidents.news()
        if incidents is not None:
            messages.append({"kind": "incidents", "incidents": incidents})
        if frames := self._frames.take():
            messages.append({"kind": "frames", "frames": frames})
        sent = tuple(Packet(LIVE, ALL_PAGES, encoded(one)) for one in messages)
        return Reaction((*reaction.sent, *sent), reaction.wake_at)

    def _state(self) -> Json:
        rig, now = self._rig, self._rig.world.now
        faults, first = rig.faults, self._moments.first
        return {
            "kind": "state",
            "at_s": to_seconds(now),
            "paused": self._paced.paused,
            "speed": self._paced.factor,
            "measured": self._measured(),
            "buses": [
                {"name": name, "load_percent": number(wire.load_percent())}
                for name, wire in rig.can_wires.items()
            ],
            "faults": [
                {"number": one, "kind": it.kind, "nodes": list(it.nodes), "began_s": to_seconds(it.began)}
                for one in faults.standing
                for it in (faults.record_of(one),)
            ],
            "kept_s": None if first is None else [to_seconds(first), to_seconds(now)],
            **bridge_state(self._type, rig.bridge),
            **self._true_pose(),
        }

    def _measured(self) -> Json:
        samples = self._rig.samples
        if not len(samples):
            return {}
        newest = samples[-1]
        return {column.name: number(newest[column.name]) for column in samples.columns}

    def _true_pose(self) -> Json:
        samples = self._rig.samples
        if not len(samples) or not all(samples.has(name) for name in POSE):
            return {"true_pose": None}
        return {"true_pose": [number(samples[-1][name]) for name in POSE]}

    def _event(self, text: str, level: str) -> Json:
        event = {"at_s": to_seconds(self._rig.world.now), "text": text, "level": level}
        self._events.append(event)
        del self._events[:-MOST_EVENTS]
        return event


def _wires(rig: Rig) -> "Iterator[Observed]":
    """Yield every wire that is recorded."""
    yield from rig.can_wires.values()
    yield from (line.wire for line in rig.lines.values())
    yield from rig.datagram_wires.values()
    yield rig.operator_wire


def _number(request: Json, name: str, least: float, most: float) -> float:
    value: Any = request.get(name, 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
        raise PageError(f"{request['do']}: {name} is a number from {least:g} to {most:g}, not {value!r:.40}")
    return float(value)
