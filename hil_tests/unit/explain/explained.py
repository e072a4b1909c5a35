"""What `explain` finds in frames that a test has written."""

from pathlib import Path

from firmware_bridge.explain.explainer import Explained, Setup, explain
from firmware_bridge.explain.incident import Incident
from firmware_bridge.explain.source import frames
from hil_tests.unit.explain.bus_log import BusLog


def explained(log: BusLog, folder: Path, setup: Setup | None = None) -> Explained:
    notes: list[str] = []
    found = explain(frames(log.save(folder / "can.log"), notes.append), setup or Setup())
    assert notes == []
    return found


def named(found: Explained, kind: str) -> list[Incident]:
    return [one for one in found.incidents if one.kind.name == kind]
