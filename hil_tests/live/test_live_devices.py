"""Emulated devices on the live page: their states, frames and incidents, and faults that the page begins."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from emulators.live.devices import LiveDevices
from firmware_bridge.canopen.cia301 import SDO_REQUEST
from firmware_bridge.node import Finite
from firmware_bridge.packet import Packet
from hil_tests.live.paged import Paged
from hil_tests.unit.control.live_bench import live

BUS = "drives"


@contextmanager
def shown(robot: str) -> Iterator[Paged]:
    with live(robot) as bench:
        page = Paged(LiveDevices(bench.desk, bench.live))
        page.now = bench.now
        yield page


@pytest.fixture
def rars() -> Iterator[Paged]:
    with shown("rars") as page:
        yield page


@pytest.fixture
def rome() -> Iterator[Paged]:
    with shown("rome") as page:
        yield page


def test_it_shows_the_drives_and_faults_that_a_real_bus_can_carry(rars: Paged) -> None:
    hello, events, incidents, state = rars.opens()
    assert (hello["mode"], [one["name"] for one in hello["axes"]]) == (
        "devices",
        ["left", "right", "steer", "lift"],
    )
    kinds = {one["kind"] for one in hello["faults"]}
    assert {"drive_restart", "encoder_cut", "supply_sag"} <= kinds
    assert not kinds & {"bus_off", "datagram_loss", "bridge_ends"}
    assert "inject" in hello["can"]
    assert (events["events"], incidents["incidents"]) == ([], [])
    left = state["axes"][0]
    assert (left["power"], left["position"], left["fault"]) == ("off", 0, "")
    assert "switch on disabled" in left["state"]
    assert state["buses"][0]["name"] == BUS
    assert state["measured"]


def test_a_fault_of_the_page_is_on_the_device_until_it_is_cleared(rars: Paged) -> None:
    rars.opens()
    answer = rars.does("inject", fault="supply_sag", keys={"node": "left", "to_v": 5.0})
    assert answer["ok"], answer
    rars.runs(0.2)
    state = rars.kept("state")[-1]
    assert [one["kind"] for one in state["faults"]] == ["supply_sag"]
    assert rars.does("clear")["cleared"] == [answer["number"]]
    assert rars.runs(0.1)[-1]["faults"] == []
    refused = rars.does("inject", fault="bus_off", keys={"node": "left"})
    assert (refused["ok"], "not on a real bus" in refused["error"]) == (False, True)


def test_a_drive_without_supply_is_shown_so(rars: Paged) -> None:
    rars.opens()
    assert rars.does("restart", node="left")["ok"]
    rars.runs(0.1)
    assert rars.kept("state")[-1]["axes"][0]["fault"] == "without supply"
    rars.runs(1.0)
    assert rars.kept("state")[-1]["axes"][0]["fault"] == ""


def test_frames_are_shown_in_words_while_they_are_wanted(rars: Paged) -> None:
    rars.opens()
    request = Packet(BUS, SDO_REQUEST + 1, bytes.fromhex("4018100100000000"))
    rars.receives(request)
    rars.runs(0.1)
    assert rars.kept("frames") == []
    assert rars.does("watch_frames", on=True, filter="sdo")["ok"]
    rars.receives(request)
    rars.runs(0.1)
    texts = [text for one in rars.kept("frames") for *_, text in one["frames"]]
    assert len(texts) == 2
    assert "read 0x1018:01" in texts[0]
    assert all("SDO" in text for text in texts)


def test_a_request_that_is_none_is_refused_and_it_goes_on(rome: Paged) -> None:
    hello, *_ = rome.opens()
    assert {"board_hangs", "motor_cable_off"} <= {one["kind"] for one in hello["faults"]}
    refused = rome.does("arm", on=True)
    assert (refused["ok"], "inject" in refused["error"]) == (False, True)
    for garbage in (b"", b"{", b"[1]", b'{"do":[]}', b'{"do":"inject","fault":5}'):
        (answer,) = rome.receives(Packet("live", 1, garbage or b" "))[-1:]
        assert answer["ok"] is False
    assert len([one for one in rome.runs(1.0) if one["kind"] == "state"]) >= 18
    rome.closes()
    assert rome.runs(0.5) == []


def test_the_page_ends_the_program(rome: Paged) -> None:
    rome.opens()
    assert rome.does("shutdown")["ok"]
    assert isinstance(rome.node, Finite)
    assert rome.node.finished
