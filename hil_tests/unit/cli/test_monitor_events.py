"""`monitor --changes`: events are chosen by node, as frames are."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.cli.monitor import Listening
from firmware_bridge.cli.monitor_frames import FrameLines, chosen
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND

BESIDE = (
    (0x703, "7F"),
    (0x704, "05"),
    (0x084, "2032040000000000"),
    (0x000, "0104"),
    (0x000, "0100"),
    (0x604, "2B40600006000000"),
    (0x584, "8040600000000206"),
    (0x083, "2032040000000000"),
)
"""Nodes 3 and 4: heartbeats, emergencies, commands to one and to both, a transfer that is aborted."""


def events(log: Path, *words: str) -> list[str]:
    """Return the lines that are no frames, without their instants."""
    shown = CliRunner().invoke(program, ["monitor", "--changes", "--log", str(log), *words]).stdout
    lines = [line.partition(" s ")[2] for line in shown.splitlines()]
    # The identifier of a frame stands in front of where an event begins.
    return [line.strip() for line in lines if not line[:6].strip()]


def test_events_are_chosen_by_node(tmp_path: Path) -> None:
    log = tmp_path / "can.log"
    log.write_text("".join(f"({k}.000000) can0 {at:03X}#{text}\n" for k, (at, text) in enumerate(BESIDE)))
    assert events(log, "--node", "3") == [
        "node 3 is there",
        "node 3: pre-operational",
        "NMT start, all nodes",
        "EMCY node 3: 0x3220, under-voltage; error register 0x04 (voltage)",
    ]
    assert "node 4 is there" in events(log, "--node", "4")
    assert "NMT start, node 4" in events(log)


@pytest.mark.parametrize("changes", [False, True])
def test_on_a_bus_events_are_chosen_by_node_too(*, changes: bool) -> None:
    picture = BusPicture(1_000_000)
    frames = FrameLines(picture, chosen(None, "3"), changes=changes)
    shown = list[str]()
    node = Listening(picture, shown.extend, lambda: None, frames)
    for at in range(0, 400, 100):
        for number in (0x703, 0x704):
            node.receive(Packet(CAN, number, b"\x05"), at * MILLISECOND)
    node.wake(SECOND)
    assert shown == ["node 3: no heartbeat for more than 2 x 100 ms"]
