"""A bridge that is watched: a look where something is new, and events for each change."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.mcap_file.bridge_watch import BridgeWatch, DriveWords
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find
from firmware_bridge.safety.interlock_base import InterlockBase
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot, Facts, Snapshot
from firmware_bridge.units import Nanoseconds
from hil_tests.unit.mcap_file.recorded_run import rows

RULE = InterlockBase("battery low", "charge it")


def snapshot(now: Nanoseconds, *, armed: bool = False, feedback: Feedback | None = None) -> AnySnapshot:
    facts = Facts(
        now=now,
        armed=armed,
        emergency_stopped=False,
        received_at=NEVER_RECEIVED,
        neutral=True,
        axes={} if feedback is None else {feedback.axis: feedback},
        sensors={},
        links_lost={},
    )
    return Snapshot[Any, Any](facts=facts, command=None, commanded=None, body=None, pose=Pose(1.0, 2.0, 0.5))


def active(since: Nanoseconds, reason: str = "19 V") -> ActiveInterlock:
    return ActiveInterlock(RULE.name, reason, RULE, since)


@dataclass
class FakeBridge:
    seen: AnySnapshot
    interlock_events: tuple[ActiveInterlock, ...] = ()


class Watched:
    """A watch with its file."""

    def __init__(self, words: dict[str, DriveWords] | None = None) -> None:
        self.bridge = FakeBridge(snapshot(0))
        self.watch = BridgeWatch(find("rars"), lambda: self.bridge, lambda: words or {})
        self.file = io.BytesIO()
        self.writer = RecordingWriter(self.file, {})

    def look(self, now: Nanoseconds) -> bool:
        """Look, and write what is new; return whether something was."""
        look = self.watch.look(now)
        if look is not None:
            self.watch.write(look, self.writer)
        return look is not None

    def ended(self, folder: Path) -> list[tuple[Nanoseconds, str, Any]]:
        """Return what is in the file."""
        self.writer.finish()
        (folder / "it.mcap").write_bytes(self.file.getvalue())
        return [(row.at, row.topic, row.message) for row in rows(folder / "it.mcap")]


def test_a_cycle_is_looked_at_once() -> None:
    watched = Watched()
    assert [watched.look(at) for at in (1, 2)] == [True, False]
    watched.bridge.seen = snapshot(50)
    assert [watched.look(at) for at in (51, 52)] == [True, False]


def test_what_begins_clears_and_begins_again_between_two_looks_is_an_event_each(tmp_path: Path) -> None:
    watched = Watched()
    watched.look(1)
    for at, events in ((10, (active(9),)), (20, (active(9, "18 V"),)), (30, (active(25),)), (40, ())):
        watched.bridge.interlock_events = events
        assert watched.look(at)
    found = [
        (at, one.Kind.Name(one.kind), one.since_ns)
        for at, topic, one in watched.ended(tmp_path)
        if topic == "/events"
    ]
    began, cleared = "INTERLOCK_ACTIVE", "INTERLOCK_CLEARED"
    assert found == [(10, began, 9), (30, cleared, 9), (30, began, 25), (40, cleared, 25)]


def test_an_event_in_the_middle_of_a_cycle_is_no_second_row_of_its_drives(tmp_path: Path) -> None:
    watched = Watched()
    watched.bridge.seen = snapshot(10, feedback=Feedback("left"))
    for at, events in ((11, ()), (12, (active(12),))):
        watched.bridge.interlock_events = events
        assert watched.look(at)
    assert [(at, topic) for at, topic, _ in watched.ended(tmp_path)] == [
        (11, "/drive/1/state"),
        (12, "/events"),
    ]


def test_arming_is_an_event_at_its_change(tmp_path: Path) -> None:
    watched = Watched()
    for at, armed in ((10, False), (20, True), (30, True), (40, False)):
        watched.bridge.seen = snapshot(at, armed=armed)
        watched.look(at)
    found = [
        (at, one.Kind.Name(one.kind)) for at, topic, one in watched.ended(tmp_path) if topic == "/events"
    ]
    assert found == [(20, "ARMED"), (40, "DISARMED")]


def test_before_the_first_sample_a_drive_has_no_position_and_no_joint(tmp_path: Path) -> None:
    watched = Watched({"left": DriveWords(0x0237, -1)})
    watched.bridge.seen = snapshot(10, feedback=Feedback("left"))
    watched.look(10)
    watched.bridge.seen = snapshot(20, feedback=Feedback("left", sampled_at=19, position=3.0, current_a=0.5))
    watched.look(20)
    found = watched.ended(tmp_path)
    before, after = (one for _, topic, one in found if topic == "/drive/1/state")
    assert not before.HasField("position")
    assert (after.position, after.HasField("current_a")) == (3.0, False), "no current was received"
    assert (after.statusword, after.mode, after.mode_name) == (0x0237, -1, ""), "a maker's own mode"
    assert [at for at, topic, _ in found if topic in {"/robot/joints", "/robot/odometry"}] == [20, 20]
    (pose,) = (one.pose for _, topic, one in found if topic == "/robot/odometry")
    assert (pose.position.x, pose.position.y) == (1.0, 2.0)
