"""Several buses on one page: the frames and incidents of all of them."""

from dataclasses import dataclass, field

from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.live.bus import Incident, LiveBus, known, news
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import SECOND, Nanoseconds


@dataclass(frozen=True)
class Found:
    """An incident."""

    at: Nanoseconds
    where: str
    what: str = "is silent"
    causes: tuple[str, ...] = ("no power",)
    check: str = "its cable"


@dataclass
class Finds:
    """An explainer that finds what a test gives it."""

    found: list[Incident] = field(default_factory=list)

    def take(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a frame."""


def test_incidents_of_all_buses_are_shown_in_their_order_whichever_has_found_the_newest() -> None:
    first, second = Finds(), Finds()
    buses = [LiveBus(BusPicture(1_000_000), one, name) for one, name in ((first, "a"), (second, "b"))]
    assert list(news(buses)) == []
    first.found.append(Found(2 * SECOND, "node 1"))
    second.found.append(Found(SECOND, "node 2"))
    titles = ["node 2: is silent", "node 1: is silent"]
    assert [[it["title"] for it in one["incidents"]] for one in news(buses)] == [titles]
    assert list(news(buses)) == []
    assert [it["title"] for it in known(buses)["incidents"]] == titles
    second.found.append(Found(3 * SECOND, "node 3"))
    assert [len(one["incidents"]) for one in news(buses)] == [3]


def test_frames_of_all_buses_are_shown_with_their_bus() -> None:
    buses = [LiveBus(BusPicture(1_000_000), Finds(), name) for name in "ab"]
    for bus in buses:
        bus.watch({"on": True})
        packet = Packet(CAN, 0x701, b"\x05")
        bus.picture.note(SECOND, packet)
        bus.take(SECOND, packet)
    (message,) = news(buses)
    assert [(at, bus, name) for at, bus, name, _ in message["frames"]] == [
        (1.0, "a", "701"),
        (1.0, "b", "701"),
    ]
