"""A run on the bench as one file in MCAP: packets, the true pose, the bridge, faults, attachments.

One seed gives one file, byte for byte: its times are the run's own, and its summary is without wall time.
"""

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from emulators.bench.columns import ODOMETRY, POSE
from emulators.bench.records import FaultRecord
from emulators.bench.summary import Summary, as_json
from emulators.canopen.slave import CanopenSlave
from emulators.rig import BRIDGE, Rig
from emulators.wires.ends import Observer
from firmware_bridge.canopen.objects import MODE_DISPLAY, STATUSWORD
from firmware_bridge.extras import from_extras
from firmware_bridge.mavlink.operator_texts import OperatorTexts
from firmware_bridge.mcap_file import channels
from firmware_bridge.mcap_file.bridge_watch import ODOMETRY_FRAME, BridgeWatch, DriveWords
from firmware_bridge.mcap_file.rows import EventKind, EventRow
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.mcap_file.writer import RecordingWriter

START_FRAME: Final = "start"
"""Axes of the true pose: those in which the run began."""
FRAMES: Final[Mapping[str, tuple[str, tuple[str, str, str]]]] = {
    channels.POSE: (START_FRAME, POSE),
    channels.ODOMETRY: (ODOMETRY_FRAME, ODOMETRY),
}
"""Axes and columns of each pose."""
WALL: Final = ("wall_s", "realtime_factor")
"""Keys of a summary that depend on the machine."""


class Unrecorded:
    """A run without a file in MCAP."""

    def observe(self, rig: Rig) -> None:
        """Begin with a rig."""

    def end(self, summary: Summary, files: Mapping[str, str]) -> None:
        """End with the run's summary and further files, by their names."""


@contextmanager
def in_mcap(path: Path | None, about: Mapping[str, str]) -> Iterator[Unrecorded]:
    """Write a run into this file while it is open, or nowhere where it is none; `about` is its metadata.

    ExtraMissingError; OSError where it cannot be written.
    """
    if path is None or path.suffix.lower() != channels.SUFFIX:
        yield Unrecorded()
        return
    with from_extras():
        from firmware_bridge.mcap_file.writer import RecordingWriter  # noqa: PLC0415 - it needs an extra
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        yield RigMcap(RecordingWriter(file, about))


class RigMcap(Unrecorded):
    """One run, in the order of time: what is sampled is written before the next packet."""

    def __init__(self, writer: "RecordingWriter") -> None:
        self._writer: Final = writer
        self._texts: Final = OperatorTexts()
        self._rig: Rig | None = None
        self._watch: BridgeWatch | None = None
        self._rows = 0
        """Count of the samples that are written."""
        self._faults: list[FaultRecord] = []
        """As they were written last."""
        self._poses: dict[str, tuple[str, tuple[int, int, int]]] = {}
        """Axes and places in a row of each pose, by topic."""

    def observe(self, rig: Rig) -> None:
        """Write what a rig does from now on."""
        self._rig = rig
        self._watch = BridgeWatch(rig.robot, lambda: rig.bridge, lambda: _words(rig), odometry=False)
        places = {column.name: place for place, column in enumerate(rig.samples.columns)}
        for topic, (frame, names) in FRAMES.items():
            if all(name in places for name in names):
                x, y, heading = (places[name] for name in names)
                self._poses[topic] = (frame, (x, y, heading))
        for link, bus in rig.can_wires.items():
            bus.observe(self._frames_noted(link))
        for link, line in rig.lines.items():
            line.wire.observe(self._bytes_noted(link))
        for link, seen in {**rig.datagram_wires, OPERATOR: rig.operator_wire}.items():
            seen.observe(self._datagrams_noted(link))

    def end(self, summary: Summary, files: Mapping[str, str]) -> None:
        """Write the last samples, the summary and further files, by their names."""
        if self._rig is not None:
            self._catch_up(self._rig.world.now)
        texts = {"summary.json": _reproducible(summary), **files}
        for name, text in texts.items():
            kind = "application/json" if name.endswith(".json") else "text/plain"
            self._writer.attach(name, kind, text.encode())
        self._writer.finish()

    def _frames_noted(self, bus: str) -> Observer:
        def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
            self._catch_up(now)
            self._writer.frame(now, bus, packet, sent=sender == BRIDGE)

        return note

    def _bytes_noted(self, link: str) -> Observer:
        def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
            self._catch_up(now)
            if packet.payload:
                self._writer.chunk(now, link, packet.payload, sent=sender == BRIDGE)

        return note

    def _datagrams_noted(self, link: str) -> Observer:
        def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
            self._catch_up(now)
            self._writer.datagram(now, link, packet, sent=sender == BRIDGE)
            for text in self._texts.read(packet.payload) if link == OPERATOR and sender == BRIDGE else ():
                self._writer.text(now, text.severity, OPERATOR, text.text)

        return note

    def _catch_up(self, now: Nanoseconds) -> None:
        """Write what is new beside packets."""
        rig, watch = self._rig, self._watch
        if rig is None or watch is None:
            return
        if len(rig.samples) != self._rows:
            self._write_samples(rig)
        look = watch.look(now)
        if look is not None:
            watch.write(look, self._writer)

    def _write_samples(self, rig: Rig) -> None:
        for sample in rig.samples[self._rows :]:
            for topic, (frame, (x, y, heading)) in self._poses.items():
                pose = (sample.values[x], sample.values[y], sample.values[heading])
                if all(map(math.isfinite, pose)):
                    self._writer.pose(sample.at, topic, frame, pose)
        self._rows = len(rig.samples)
        if rig.faults.records != self._faults:
            self._write_faults(rig.faults.records, rig.samples[-1].at)

    def _write_faults(self, records: Iterable[FaultRecord], now: Nanoseconds) -> None:
        before, self._faults = self._faults, list(records)
        for place, fault in enumerate(self._faults):
            known = before[place] if place < len(before) else None
            row = (fault.kind, fault.title, "", fault.began, fault.nodes)
            if known is None:
                self._writer.event(now, EventRow(EventKind.FAULT_BEGAN, *row))
            if fault.ended is not None and (known is None or known.ended is None):
                self._writer.event(now, EventRow(EventKind.FAULT_ENDED, *row))


def _words(rig: Rig) -> dict[str, DriveWords]:
    """Return statusword and mode of each CiA 402 drive that has its supply, by the name of its axis."""
    slaves = {
        (rig.devices.stations[name].link, slave.node_id): slave
        for name, slave in rig.devices.nodes(CanopenSlave).items()
        if rig.world.here(name)
    }
    words = {}
    for axis in rig.robot.axes:
        slave = slaves.get((axis.link, axis.settings.number))
        if slave is not None and STATUSWORD in slave.store.objects:
            store = slave.store
            words[axis.name] = DriveWords(store.get_or(STATUSWORD, 0), store.get_or(MODE_DISPLAY, 0))
    return words


def _reproducible(summary: Summary) -> str:
    table = json.loads(as_json(summary))
    return json.dumps({key: value for key, value in table.items() if key not in WALL}, indent=2) + "\n"
