"""A rig in a test's hands: its reports on the robot, its refusals, and its complete restoration."""

from collections.abc import Iterator

import pytest

from emulators.testing.errors import RigError
from emulators.testing.kept import Kept
from emulators.testing.rig import VirtualRig
from hil_tests.rows import every

ROBOT = "rome"


@pytest.fixture(scope="module")
def kept() -> Iterator[Kept]:
    several = Kept()
    yield several
    several.finish()


@pytest.fixture
def rig(kept: Kept) -> VirtualRig:
    return kept.armed(ROBOT, 0)


def traces(rig: VirtualRig) -> tuple[object, ...]:
    return (
        rig.bench.world.trace_sha256,
        rig.recording.chunks,
        rig.interlock_history,
        rig.operator.texts,
        rig.bench.samples.csv(),
    )


def drives(rig: VirtualRig) -> None:
    rig.operator.drives(forward=0.2)
    rig.runs(0.5)


def test_a_test_that_went_before_is_not_to_be_seen(kept: Kept) -> None:
    rig = kept.armed(ROBOT, 0)
    drives(rig)
    first = traces(rig)
    rig.fault("datagram_loss")
    rig.operator.stops()
    rig.runs(0.3)
    assert kept.armed(ROBOT, 0) is rig
    drives(rig)
    assert traces(rig) == first


def test_a_branch_has_not_been(rig: VirtualRig) -> None:
    drives(rig)
    before = traces(rig)
    with rig.branch():
        rig.operator.stops()
        rig.runs(0.5)
        assert "emergency stop" in rig.interlock_events
    assert traces(rig) == before
    rig.runs(0.5)
    assert rig.body.speed > 0.15
    assert rig.body.speed == rig.body.speed_mps


def test_what_fails_in_a_branch_stays_for_the_report(rig: VirtualRig) -> None:
    began = rig.now
    with pytest.raises(AssertionError), rig.branch():
        rig.runs_until(lambda: False, within=0.5)
    assert rig.now == pytest.approx(began + 0.5)


def test_a_rig_that_was_broken_off_is_made_again(kept: Kept, rig: VirtualRig) -> None:
    rig.whole = False
    assert kept.armed(ROBOT, 0) is not rig


def test_the_operator_falls_silent_and_comes_back(rig: VirtualRig) -> None:
    rig.operator.falls_silent()
    assert rig.runs_until(
        lambda: "operator link timeout" in rig.interlock_events, within=1.0
    ) == pytest.approx(0.5, abs=0.06)
    rig.operator.comes_back()
    rig.runs_until(lambda: "operator link timeout" not in rig.interlock_events, within=1.0)
    with pytest.raises(AssertionError, match=r"not so within 0.1 s of virtual time, at \d"):
        rig.runs_until(lambda: rig.body.speed > 1.0, within=0.1)


@every(
    ("wrong", "stated"),
    [
        (lambda rig: rig.body.wings, "rome has no 'wings'; it has x_m, y_m"),
        (lambda rig: rig.operator.drives(forwards=1), "forwards"),
        (lambda rig: rig.operator.drives(forward=50.0), "beyond full stick"),
        (
            lambda rig: rig.fault("can_cuts"),
            "no such fault as 'can_cuts'; rome cannot have 'can_cut'; there are: ",
        ),
        (lambda rig: rig.fault("datagram_loss", four_s=1.0), "four_s"),
        (lambda rig: rig.fault("encoder_cable_off"), "encoder_cable_off needs node: one or two or three"),
        (lambda rig: rig.fault("node_silent", node="x"), "cannot have the fault 'node_silent': .*rome"),
    ],
)
def test_what_cannot_be_is_stated_in_one_line(rig: VirtualRig, wrong: object, stated: str) -> None:
    assert callable(wrong)
    with pytest.raises(RigError, match=stated) as error:
        wrong(rig)
    assert "\n" not in str(error.value)
