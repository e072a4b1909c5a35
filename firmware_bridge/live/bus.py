"""One CAN bus on the live page: its nodes, its frames in words, the incidents on it."""

from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Final, Protocol

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import STATES, PowerState
from firmware_bridge.dissector.bus_picture import BusPicture, NodeSeen
from firmware_bridge.drivers.driver import Power
from firmware_bridge.live.state import Json
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire.can import identifier

MOST_FRAMES: Final = 100
"""So many frames at a time; of more the newest."""
VALUES: Final[Mapping[Address, str]] = {
    od.POSITION_ACTUAL: "position",
    od.VELOCITY_ACTUAL: "velocity",
    od.TARGET_POSITION: "target",
    od.TARGET_VELOCITY: "target",
}
"""Objects whose values are shown, in the drive's own units."""
_POWER: Final = {
    PowerState.OPERATION_ENABLED: Power.ON,
    PowerState.QUICK_STOP_ACTIVE: Power.STOPPED,
    PowerState.FAULT: Power.FAULT,
    PowerState.FAULT_REACTION_ENABLED: Power.FAULT,
}
_MILLI: Final = 1000.0


class Incident(Protocol):
    """What `explain` has found."""

    @property
    def at(self) -> Nanoseconds:
        """Its first evidence."""

    @property
    def where(self) -> str:
        """The node or the bus, for people."""

    @property
    def what(self) -> str:
        """What happened."""

    @property
    def causes(self) -> Sequence[str]:
        """Most likely first."""

    @property
    def check(self) -> str:
        """What to check first."""


class Explainer(Protocol):
    """What finds incidents in frames."""

    def take(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a frame."""

    @property
    def found(self) -> Sequence[Incident]:
        """The incidents so far."""


def incidents(found: Iterable[Incident]) -> list[Json]:
    """Return incidents as the page shows them, the oldest first."""
    shown = [
        {
            "at_s": to_seconds(one.at),
            "title": f"{one.where}: {one.what}",
            "causes": list(one.causes),
            "check": one.check,
        }
        for one in found
    ]
    return sorted(shown, key=lambda one: float(str(one["at_s"])))


def known(buses: Collection["LiveBus"]) -> Json:
    """Return all incidents on some buses, which replace those that the page has."""
    return {"kind": "incidents", "incidents": incidents(one for bus in buses for one in bus.found)}


def news(buses: Collection["LiveBus"]) -> Iterable[Json]:
    """Return the frames and incidents on some buses that are new."""
    if frames := [frame for bus in buses for frame in bus.frames()]:
        yield {"kind": "frames", "frames": frames}
    # Each bus is looked at, whatever the one before has found.
    if sum(bus.finds() for bus in buses):
        yield known(buses)


class LiveBus:
    """What a page shows of a bus; its picture is the caller's."""

    def __init__(self, picture: BusPicture, explainer: Explainer, name: str = "CAN") -> None:
        self.picture: Final = picture
        self.name: Final = name
        self._explainer: Final = explainer
        self._new: Final[deque[list[Any]]] = deque(maxlen=MOST_FRAMES)
        self._wanted: str | None = None
        """Part of the frames' texts that are shown; None: no frame."""
        self._count = 0

    def take(self, now: Nanoseconds, packet: Packet) -> None:
        """Take a frame that the picture has noted already."""
        self._explainer.take(now, packet.address, packet.payload)
        if self._wanted is None:
            return
        name, text = f"{identifier(packet.address):03X}", self.picture.text_of(packet)
        if self._wanted in text.lower() or self._wanted in name.lower():
            self._new.append([to_seconds(now), self.name, name, text])

    def watch(self, request: Json) -> Json:
        """Show frames with a filter, or none: the page's request `watch_frames`."""
        wanted = request.get("filter", "")
        self._wanted = str(wanted).lower() if request.get("on") is True else None
        self._new.clear()
        return {}

    @property
    def found(self) -> Sequence[Incident]:
        """The incidents so far."""
        return self._explainer.found

    def frames(self) -> list[list[Any]]:
        """Return the frames that are new."""
        taken = list(self._new)
        self._new.clear()
        return taken

    def finds(self) -> bool:
        """Return whether there are more incidents, or fewer, than at the last call."""
        before, self._count = self._count, len(self.found)
        return self._count != before

    @property
    def nodes(self) -> list[Json]:
        """The nodes so far, as the page introduces axes."""
        return [
            {"name": _name(it), "title": it.title or _name(it), "unit": "", "number": it.node}
            for it in self.picture.nodes
        ]

    def state(self) -> Json:
        """Return the nodes' states, and the load."""
        values: dict[int, Json] = {}
        for node, address, value in self.picture.numbers((*VALUES, od.CURRENT_ACTUAL)):
            if address == od.CURRENT_ACTUAL:
                values.setdefault(node, {})["current_a"] = value / _MILLI
            else:
                values.setdefault(node, {})[VALUES[address]] = value
        return {
            "axes": [_axis(one, values.get(one.node, {})) for one in self.picture.nodes],
            "buses": [{"name": self.name, "load_percent": round(self.picture.load_percent, 1)}],
        }


def _name(seen: NodeSeen) -> str:
    return f"node {seen.node}"


def _axis(seen: NodeSeen, values: Json) -> Json:
    network = "state not known" if seen.network is None else seen.network.title
    return {
        "name": _name(seen),
        "power": _power(seen).value,
        "state": "; ".join(filter(None, (seen.status, network, "heartbeat missing" if seen.missing else ""))),
        "position": None,
        "velocity": None,
        "target": None,
        "current_a": None,
        "temperature_c": None,
        **values,
        "fault": seen.emergency,
    }


def _power(seen: NodeSeen) -> Power:
    state = STATES.state_of(int.from_bytes(seen.raw_status, "little")) if seen.raw_status else None
    return Power.UNKNOWN if state is None else _POWER.get(state, Power.OFF)
