"""`monitor` on a terminal: its tables beside rich's own, its end on Ctrl-C, and how often it wakes."""

import io
import logging
import signal
import sys
from collections import deque
from collections.abc import Sequence
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from firmware_bridge.cli.monitor import MonitorOptions, run
from firmware_bridge.cli.monitor_clock import TOGETHER, GatheringClock
from firmware_bridge.cli.monitor_frames import Chosen, FrameLines
from firmware_bridge.cli.monitor_grid import Grid
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds
from hil_tests.rows import every
from hil_tests.unit.cli.test_monitor import RECEIVED, Scripted

HEADINGS = ("node", "what", "the last one")
ROWS = (
    ("1 left", "operational", "0x0737 (operation enabled, power stage on, remote, target reached)"),
    ("2 右", "", "12 µm/s²"),
    ("", "a-word-that-is-longer-than-a-narrow-column-and-has-no-space", "none"),
)


def printed(renderable: object, width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width, color_system=None)
    console.print(renderable)
    assert isinstance(console.file, io.StringIO)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]


def reference(rows: Sequence[Sequence[str]]) -> Table:
    table = Table(title="nodes")
    for heading in HEADINGS:
        table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    return table


@every("width", [250, 160, 110, 80, 60])
def test_a_table_looks_as_rich_has_it(width: int) -> None:
    assert printed(Grid("nodes", HEADINGS, ROWS), width) == printed(reference(ROWS), width)


def test_a_table_without_rows_looks_as_rich_has_it() -> None:
    assert printed(Grid("nodes", HEADINGS, ()), 80) == printed(reference(()), 80)


@every("width", [20, 30, 45])
def test_a_table_fits_a_narrow_terminal_with_all_that_it_has(width: int) -> None:
    lines = printed(Grid("nodes", HEADINGS, ROWS), width)
    assert max(map(cell_len, lines)) <= width
    shown = "".join(char for line in lines for char in line if char.isalnum())
    assert sorted(shown) == sorted(
        char for row in (("nodes",), HEADINGS, *ROWS) for text in row for char in text if char.isalnum()
    )


def test_data_of_a_node_command_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert "│ \\x1b[2J\\n │" in printed(Grid("", ("text",), [("\x1b[2J\n",)]), 80)
    # The answer to a read of the device's name, of four characters.
    frame = Packet(CAN, 0x583, b"\x43\x08\x10\x00\x1b[2J")
    FrameLines(BusPicture(1_000_000), Chosen()).note(0, frame)
    shown = capsys.readouterr().out
    assert "\\x1b[2J" in shown
    assert "\x1b" not in shown


class Interrupted(Scripted):
    """A port on which some frames come, a warning of its library, and then Ctrl-C."""

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        frames, self._frames = self._frames, []
        logging.getLogger("library").warning("a slow adapter")  # noqa: TID251 - as python-can does
        signal.raise_signal(signal.SIGINT)
        return frames


@pytest.mark.parametrize("ask", [False, True])
def test_ctrl_c_on_a_terminal_leaves_the_picture_and_how_it_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], *, ask: bool
) -> None:
    path = tmp_path / "screen"
    with path.open("w", encoding="utf-8") as screen:
        console = Console(file=screen, force_terminal=True, width=140, height=50, color_system=None)
        monkeypatch.setattr(
            "firmware_bridge.runtime.ports.open_can", lambda *_, **_more: Interrupted(RECEIVED)
        )
        monkeypatch.setattr("firmware_bridge.cli.tables.terminal", lambda: console)
        monkeypatch.setattr("firmware_bridge.cli.monitor.on_a_terminal", lambda: True)
        monkeypatch.setattr(sys, "stdout", screen)
        run(MonitorOptions(interface="virtual", channel="foreign", ask=ask))
    *_, picture, end = path.read_text(encoding="utf-8").splitlines()
    assert picture.startswith("└")
    assert "ended: SIGINT" in end
    assert "4 frames in" in path.read_text(encoding="utf-8")
    assert "library: a slow adapter" in capfd.readouterr().err


class Bus:
    """Frames at their instants, in place of select and of the machine's clock."""

    def __init__(self, instants: Sequence[Nanoseconds]) -> None:
        self.now: Nanoseconds = 0
        self.waiting = deque(instants)

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        if filenos and self.waiting and self.waiting[0] <= max(self.now, until):
            self.now = max(self.now, self.waiting[0])
            return list(filenos)
        self.now = max(self.now, until)
        return []

    def read(self) -> None:
        """Take all frames that have come."""
        while self.waiting and self.waiting[0] <= self.now:
            self.waiting.popleft()


def received_at(
    monkeypatch: pytest.MonkeyPatch, instants: Sequence[Nanoseconds], due: Nanoseconds
) -> list[Nanoseconds]:
    """Return the instants at which frames are received; the node is to be woken each `due`, and is."""
    bus, woken = Bus(instants), 0
    monkeypatch.setattr(Clock, "wait", bus.wait)
    monkeypatch.setattr(Clock, "now", lambda _clock: bus.now)
    clock, received = GatheringClock(), list[Nanoseconds]()
    while bus.waiting:
        if clock.wait([7], woken + due):
            received.append(bus.now)
            bus.read()
        assert bus.now <= woken + due
        woken += due * (bus.now == woken + due)
    return received


BUSY_BUS = range(0, 100 * MILLISECOND, 100 * MICROSECOND)


def test_frames_of_a_busy_bus_are_received_together(monkeypatch: pytest.MonkeyPatch) -> None:
    received = received_at(monkeypatch, BUSY_BUS, 50 * MILLISECOND)
    assert 100 * MILLISECOND // TOGETHER <= len(received) <= 100 * MILLISECOND // TOGETHER + 5


def test_frames_of_a_calm_bus_are_received_at_their_instants(monkeypatch: pytest.MonkeyPatch) -> None:
    pairs = [at + later for at in BUSY_BUS[::200] for later in (0, 300 * MICROSECOND)]
    assert received_at(monkeypatch, pairs, 50 * MILLISECOND) == pairs


def test_gathering_makes_no_wake_late(monkeypatch: pytest.MonkeyPatch) -> None:
    assert received_at(monkeypatch, BUSY_BUS, 300 * MICROSECOND)
