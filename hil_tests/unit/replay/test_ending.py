"""End request of a recorded bridge, and a replay that does not compare the packets after it."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from emulators.replay import Into, ReplayOrder
from emulators.replay import replay as play
from emulators.replay.ending import end_requested_at
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.recording import EPOCH
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND

RUN = Path(__file__).with_name("end_requested_at")
"""3 s of `drive rars` at emulated drives in real time, no one driving, and its end by `--duration`."""
KNOWN = Path(__file__).with_name("places_known")
"""3 s of `drive rars` after a run that had kept where lift and steering stood."""


def as_it_was() -> AnyRobot:
    """RARS of that day: the rack at 800 rpm, no position between the samples, one quick stop."""
    robot, axes = find("rars"), []
    for axis in robot.axes:
        settings = Epos2Axis.of(axis)
        slow = {"velocity_rpm": 800} if axis.role == "steering" else {}
        profile = settings.profile.model_copy(update={"quick_stop_least_rpm_s": None, **slow})
        changed = settings.model_copy(update={"profile": profile, "position_every_ms": None})
        axes.append(axis.model_copy(update={"settings": changed}))
    return robot.model_copy(update={"axes": tuple(axes)})


ORDER = ReplayOrder(
    as_it_was(),
    RUN,
    into=Into.BRIDGE,
    confirmed=(ConfirmPosition("lift", 0.0), ConfirmPosition("steer", 0.0)),
)


def test_a_real_run_is_played_until_it_was_requested_to_end() -> None:
    with pytest.warns(RenamedWarning, match="all is compared but STATUSTEXT"):
        outcome = play(ORDER)
    assert outcome.difference is None
    assert outcome.compared > 1_000
    assert 2 * SECOND < outcome.until < 3 * SECOND
    with pytest.warns(RenamedWarning):
        assert play(replace(ORDER, until=SECOND)).until < SECOND + 10 * MILLISECOND, "he may want less"


def test_without_its_events_what_came_of_the_end_differs(tmp_path: Path) -> None:
    for name in ("can.log.xz", "operator.tlog.xz"):
        shutil.copy(RUN / name, tmp_path)
    with pytest.warns(RenamedWarning):
        outcome = play(replace(ORDER, recording=tmp_path))
    assert outcome.difference is not None
    assert outcome.until > 2_900 * MILLISECOND


HEAD = "(1795676728.749001)     0.000 s  starting\n"


@pytest.mark.parametrize(
    ("events", "after"),
    [
        (f"{HEAD}(1795676731.799123)     3.050 s  stopping\n", 3_050 * MILLISECOND),
        (f"{HEAD}(1795676731.999123)     3.050 s  leaving\n(1795676732.1) cut", 3_050 * MILLISECOND),
        (f"{HEAD}to the operator: stopping\n", None),
        ("(1795676731.799123) to the operator: stopping\n", None),
        ("", None),
    ],
)
def test_it_is_just_before_the_bridge_s_own_time_of_it(
    tmp_path: Path, events: str, after: int | None
) -> None:
    file = tmp_path / "events.log"
    file.write_text(events, encoding="utf-8")
    begun = 1_795_676_728 * SECOND + 749_001 * MICROSECOND - EPOCH
    assert end_requested_at(file) == (None if after is None else begun + after - 2 * MILLISECOND)


def test_what_was_known_of_the_run_before_is_known_to_the_replay(tmp_path: Path) -> None:
    order = ReplayOrder(as_it_was(), KNOWN, into=Into.BRIDGE)
    assert play(order).difference is None
    shutil.copytree(KNOWN, tmp_path / "run")
    (tmp_path / "run" / "places.json").unlink()
    without = play(replace(order, recording=tmp_path / "run")).difference
    assert without is not None
    assert "last known: 10 deg" in without
