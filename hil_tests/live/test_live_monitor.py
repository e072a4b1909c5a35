"""A real bus on the live page: nodes, frames in words, incidents, and nothing is sent."""

import lzma
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge.cli.monitor import Listening
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.explain.explainer import BusExplainer, Setup
from firmware_bridge.live.bus import LiveBus
from firmware_bridge.live.monitor import LiveMonitor
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import parse_candump
from firmware_bridge.units import MILLISECOND
from hil_tests.live.paged import Paged

MASTERS: Final = Path(__file__).parents[1] / "recordings" / "rars" / "canopen-master.log.xz"
FRAMES: Final = [
    (at, Packet(CAN, packet.address, packet.payload))
    for at, _, packet in map(parse_candump, lzma.decompress(MASTERS.read_bytes()).decode().splitlines())
]


@pytest.fixture
def bus() -> Paged:
    picture = BusPicture(1_000_000, device="epos2")
    listening = Listening(picture, lambda _: None, lambda: None)
    bus = LiveBus(picture, BusExplainer(Setup(device="epos2")), "can0")
    return Paged(LiveMonitor(listening, bus, "can0"))


def plays(bus: Paged, count: int) -> None:
    """Let the bus carry the recording's first frames, each at its instant."""
    begun = FRAMES[0][0]
    for at, packet in FRAMES[:count]:
        bus.now = max(bus.now, at - begun)
        bus.receives(packet)


def test_nodes_are_introduced_as_they_appear(bus: Paged) -> None:
    hello, events, incidents, state = bus.opens()
    assert (hello["mode"], hello["axes"], hello["can"]) == ("bus", [], ["watch_frames"])
    assert (events["events"], incidents["incidents"], state["axes"]) == ([], [], [])
    plays(bus, len(FRAMES))
    bus.runs(0.2)
    assert [one["number"] for one in bus.kept("hello")[-1]["axes"]] == [1, 2, 3, 4]
    axes = {one["name"]: one for one in bus.kept("state")[-1]["axes"]}
    assert any("0x" in one["state"] for one in axes.values())
    assert bus.sent == []


def test_power_and_values_are_those_of_the_newest_frames(bus: Paged) -> None:
    bus.opens()
    for at_ms, address, text in (
        (0, 0x701, "05"),
        (1, 0x581, "43181001FB000000"),  # it states that it is maxon's
        (2, 0x181, "3702"),
        (3, 0x601, "23011A0110004160"),  # TPDO 2: Statusword and position
        (4, 0x601, "23011A0220006460"),
        (5, 0x601, "2F011A0002000000"),
        (6, 0x281, "3702FEFFFFFF"),
        (60, 0x181, "0802"),
        (120, 0x081, "1023010000000000"),
    ):
        bus.now = at_ms * MILLISECOND
        bus.receives(Packet(CAN, address, bytes.fromhex(text)))
    powers = [one["power"] for state in bus.kept("state") for one in state["axes"]]
    assert powers.count("fault") >= 1
    bus.runs(0.1)
    (axis,) = bus.kept("state")[-1]["axes"]
    assert (axis["power"], axis["position"]) == ("fault", -2)
    assert "operational" in axis["state"].lower()
    assert "0x2310" in axis["fault"] or "overcurrent" in axis["fault"].lower()


def test_incidents_come_as_they_are_found(bus: Paged) -> None:
    bus.opens()
    plays(bus, len(FRAMES))
    bus.runs(1.0)
    found = bus.kept("incidents")[-1]["incidents"]
    assert found
    assert [one["at_s"] for one in found] == sorted(one["at_s"] for one in found)
    assert all(one["title"] and one["check"] for one in found)


def test_frames_are_in_words_by_a_filter_and_no_more_than_a_page_can_show(bus: Paged) -> None:
    bus.opens()
    plays(bus, 200)
    bus.runs(0.1)
    assert bus.kept("frames") == []
    assert bus.does("watch_frames", on=True, filter="sdo")["ok"]
    plays(bus, len(FRAMES))
    bus.runs(0.1)
    shown = [one["frames"] for one in bus.kept("frames")]
    assert shown
    assert all(len(frames) <= 100 for frames in shown)
    assert all("SDO" in text for frames in shown for *_, text in frames)


def test_every_other_request_is_refused(bus: Paged) -> None:
    bus.opens()
    for name in ("stop", "emergency_stop", "arm", "inject", ""):
        refused = bus.does(name)
        assert (refused["ok"], "only shown" in refused["error"]) == (False, True)
    assert bus.sent == []
