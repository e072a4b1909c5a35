"""A bench at the clock's pace on the live page: what it shows, and what a page may request."""

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from emulators.bench.columns import POSE
from emulators.bench.faults import FaultError
from emulators.control.desk import Desk
from emulators.live.control import PageControl
from emulators.live.hello import hello
from emulators.live.incidents import LiveIncidents
from emulators.live.missions import PageMissions
from emulators.live.moments import Moments
from emulators.live.on_desk import OF_DESK, desk_does
from emulators.live.page_station import NEUTRAL, ORDERS, PageStation, Stick
from emulators.live.trace import TracedFrames
from emulators.paced import OutsideOperator, PacedRig
from emulators.rig import Rig
from firmware_bridge.live.messages import LEVELS
from firmware_bridge.live.page_node import PageError, PageNode
from firmware_bridge.live.state import Json, bridge_state, number
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Reaction
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from emulators.run import RunOrder
    from emulators.wires.ends import Observed

STATION: Final = "live page"
SLOWEST, FASTEST = 0.1, 10.0
LONGEST_STEP_S: Final = 10.0


class LiveBench(PageNode):
    """A node around the control desk; its events have the world's instants."""

    def __init__(self, rig: Rig, paced: PacedRig, desk: Desk, order: "RunOrder") -> None:
        """Take the bench, what paces it, its desk, and what it was ordered to drive."""
        super().__init__(desk)
        self._rig: Final = rig
        self._paced: Final = paced
        self._ordered: Final = order
        self._moments: Final = Moments(rig)
        self._frames: Final = TracedFrames(rig)
        self._incidents: Final = LiveIncidents(rig)
        self._branched = False
        """True once time was put back."""
        robot = rig.robot.operator
        self._station: Final = PageStation((robot.system_id, robot.component_id))
        rig.world.attach(STATION, self._station, {OPERATOR: rig.operator_wire})
        self._control: Final = PageControl(rig, self._station, order.operator)
        self._missions: Final = PageMissions(rig, order.mission)
        self._does: Final[Mapping[str, Callable[[Json, Nanoseconds], Json | None]]] = {
            "pause": self._pause,
            "speed": self._speed,
            "step": self._step,
            "rewind": self._rewind,
            "mission": self._mission,
            "drive": self._drive,
            "watch_frames": self._watch_frames,
            **dict.fromkeys((name for name, _ in ORDERS), self._order),
        }

    def report(self, text: str) -> None:
        """Show what the desk has done among the events."""
        self._happened(text, "warning")

    def wake(self, now: Nanoseconds) -> Reaction:
        """Let time pass, and show it."""
        reaction = self._node.wake(now)
        self._moments.keep(self._rig.world.now)
        if self._control.turn():
            self._rig.world.rouse(STATION)
        return self._shown(reaction, now)

    def _left(self) -> None:
        self._station.leaves(self._rig.world.now)

    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json | None]:
        work = self._does.get(name)
        if work is None:
            return desk_does(self._node, request, now)
        answer = work(request, now)
        return self._node.wake(now), answer

    # Requests

    def _pause(self, request: Json, now: Nanoseconds) -> Json:
        on = request.get("on")
        if not isinstance(on, bool):
            raise PageError('pause: give "on", true or false')
        self._paced.paces(now, paused=on)
        return {}

    def _speed(self, request: Json, now: Nanoseconds) -> Json:
        factor = _number(request, "factor", SLOWEST, FASTEST)
        self._paced.paces(now, factor=factor)
        return {}

    def _step(self, request: Json, now: Nanoseconds) -> Json:
        seconds = _number(request, "seconds", 0.0, LONGEST_STEP_S)
        self._paced.steps(now, from_seconds(seconds))
        return {"at_s": to_seconds(self._rig.world.now)}

    def _rewind(self, request: Json, now: Nanoseconds) -> Json:
        first, last = self._moments.first or 0, self._rig.world.now
        to = from_seconds(_number(request, "to_s", to_seconds(first), to_seconds(last)))
        if not self._branched:
            self._branched = True
            # A recording in which time steps back would mislead: it ends here.
            for wire in _wires(self._rig):
                wire.unobserved()
            self._frames.follow()
            self._happened("the recording of this run ends here", "warning")
        with suppress(ValueError):
            self._moments.go_back(to)
        self._frames.forget()
        self._incidents.follow()
        self._control.forget()
        self._paced.paces(now, paused=True)
        self._happened(f"time is put back from {to_seconds(last):.2f} s to {to_seconds(to):.2f} s", "info")
        return {"at_s": to_seconds(self._rig.world.now)}

    def _mission(self, request: Json, now: Nanoseconds) -> Json:
        name = request.get("name")
        if name not in self._missions.names:
            raise PageError(f"mission: give one of {', '.join(self._missions.names)}")
        if isinstance(self._ordered.operator, OutsideOperator):
            raise PageError("mission: stations outside drive this bench (--mavlink)")
        self._control.take(on=False)
        self._control.forget()
        try:
            end = self._missions.start(name)
        except FaultError as error:
            raise PageError(f"mission: its faults meet those that are planned: {error}") from error
        self._paced.ends_at(end)
        self._paced.paces(now, paused=False)
        self._happened(f"mission {name} begins, to {to_seconds(end):g} s", "info")
        return {"until_s": to_seconds(end)}

    def _drive(self, request: Json, _now: Nanoseconds) -> None:
        """Hold the stick; that has no answer, 20 times a second."""
        x, y, r = (_number(request, name, -1.0, 1.0) for name in "xyr")
        z = _number({"z": NEUTRAL.z, **request}, "z", 0.0, 1.0)
        buttons = request.get("buttons", 0)
        if not isinstance(buttons, int):
            raise PageError("drive: buttons are bits of a whole number")
        self._station.moves(Stick(x, y, z, r, buttons), self._rig.world.now)
        self._rig.world.rouse(STATION)

    def _order(self, request: Json, now: Nanoseconds) -> Json:
        name, on = request["do"], request.get("on", True)
        if not isinstance(on, bool) or (name, on) not in ORDERS:
            raise PageError(f'{name}: "on" is true or false')
        if name.endswith("stop"):
            # A bench that stands still would not carry it out.
            self._paced.paces(now, paused=False)
        if name == "stop":
            self._control.stop()
        elif name == "take_control":
            self._control.take(on=on)
        else:
            self._station.orders(name, on=on)
        self._control.turn()
        self._rig.world.rouse(STATION)
        return {}

    def _watch_frames(self, request: Json, _now: Nanoseconds) -> Json:
        wanted = request.get("filter", "")
        self._frames.watch(on=bool(request.get("on")), wanted=wanted if isinstance(wanted, str) else "")
        return {}

    # What is shown

    def _hello(self) -> Json:
        title = f"{self._ordered.robot.name}, {self._ordered.mission_name}"
        return hello(title, self._rig.robot, (*OF_DESK, *self._does), self._missions.names)

    def _known(self) -> "Iterable[Json]":
        return ({"kind": "incidents", "incidents": self._incidents.found},)

    def _news(self, now: Nanoseconds) -> "Iterable[Json]":
        del now
        self._texts()
        incidents = self._incidents.news()
        if incidents is not None:
            yield {"kind": "incidents", "incidents": incidents}
        if frames := self._frames.take():
            yield {"kind": "frames", "frames": frames}

    def _texts(self) -> None:
        """Show what the robot has sent to the page's station, or refused it."""
        for severity, text in self._station.texts.take(self._rig.world.now):
            self._happened(text, LEVELS[severity & 7])
        refusals, self._station.refusals = self._station.refusals, []
        for text in refusals:
            self._happened(text, "warning")

    def _state(self, _now: Nanoseconds) -> Json:
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
            **bridge_state(rig.robot, rig.bridge),
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

    def _happened(self, text: str, level: str) -> None:
        self.event(text, level, self._rig.world.now)


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
