"""The arm on the bench: what stops it, and that nothing moves it unless someone knows where it stands."""

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from emulators.rig import BRIDGE, Rig
from emulators.testing.inherited.scripted import scripted
from emulators.testing.rig import VirtualRig
from firmware_bridge.cli import program
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2.arm import AR2

STILL_M = 3e-4
"""Less than two steps of its shoulder take the tool."""
GOES = """
title = "upwards"
duration_s = 20.0
input = "stick"
{faults}
[[step]]
at_s = 2.0
title = "say where it stands"
zero = {{ j1 = 0.0, j2 = -90.0, j3 = 90.0, j4 = 0.0, j5 = 60.0, j6 = 0.0 }}
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 3.5
title = "go"
up_mps = 0.012
{later}
"""


@contextmanager
def driven(later: str = "", faults: str = "") -> Iterator[Rig]:
    """Yield a rig whose operator confirms the arm's pose, arms, and lifts the tool at 12 mm/s from 3.5 s."""
    with scripted(find("ar2"), GOES.format(later=later, faults=faults)) as rig:
        yield rig


def step(at_s: float, word: str) -> str:
    return f'[[step]]\nat_s = {at_s}\ntitle = "then"\n{word}\n'


def fault(at_s: float, kind: str, more: str = "") -> str:
    return f'[[fault]]\nat_s = {at_s}\nkind = "{kind}"\n{more}\n'


def moved(rig: Rig, begin: float, end: float) -> float:
    """Return the tool's distance up and down by truth in this time, m."""
    seconds = rig.samples.seconds
    heights = rig.samples.column("y_m")[(seconds >= begin) & (seconds <= end)]
    return float(np.ptp(heights))


def standing(rig: Rig) -> set[str]:
    return {record.name for record in rig.interlock_events if record.ended is None}


def height(rig: Rig) -> float:
    return float(rig.samples[-1]["y_m"])


def test_it_goes_where_the_stick_states_and_loses_no_step() -> None:
    with driven() as rig:
        rig.runs(3.4)
        begin = height(rig)
        rig.runs(4.1)
        assert height(rig) - begin == pytest.approx(0.0468, abs=0.003)
        assert max(abs(rig.samples[-1][f"lag_j{joint}_rad"]) for joint in range(1, 7)) < math.tau / 200.0
        assert rig.guard.refused == 0


@pytest.mark.long(keeps=["up_mps -0.02"])
@pytest.mark.parametrize(
    "stick",
    [
        {"up_mps": -0.02},
        {"up_mps": 0.02},
        {"speed_mps": 0.02},
        {"speed_mps": -0.02},
        {"left_mps": 0.02},
        {"turn_deg_s": 4.5},
        {"speed_mps": 0.02, "up_mps": -0.02},
        {"speed_mps": 0.02, "left_mps": 0.02, "turn_deg_s": 4.5},
    ],
    ids=lambda stick: ", ".join(f"{key} {value:g}" for key, value in stick.items()),
)
def test_at_full_stick_it_loses_no_step(stick: dict[str, float]) -> None:
    """Until it is at its limits, stretched out or folded; two full steps behind its field a rotor is lost."""
    rig = VirtualRig(find("ar2"))
    rig.arms()
    rig.operator.drives(**stick)
    rig.runs(20.0)
    lags = [np.abs(rig.bench.samples.column(f"lag_j{joint}_rad")).max() for joint in range(1, 7)]
    assert max(lags) < 1.5 * math.tau / 200.0
    assert rig.bench.guard.refused == 0
    rig.finish()


def test_after_a_reset_nothing_moves_until_someone_has_stated_where_it_stands() -> None:
    arms = step(9.0, "up_mps = 0.0") + step(10.0, "arm = true") + step(11.0, "up_mps = 0.012")
    with driven(arms, fault(6.0, "board_reset")) as rig:
        rig.runs(16.0)
        assert moved(rig, 6.4, 16.0) < STILL_M
        assert "axis restarted: j2" in standing(rig)
        assert not rig.bridge.seen.facts.armed


@pytest.mark.long(beside="test_after_a_reset_nothing_moves_until_someone_has_stated_where_it_stands")
def test_once_it_was_stated_again_it_goes_on() -> None:
    again = step(9.0, "up_mps = 0.0") + step(
        10.0, "zero = { j1 = 0.0, j2 = -85.0, j3 = 88.0, j4 = 0.0, j5 = 57.0, j6 = 0.0 }"
    )
    again += step(12.0, "arm = true") + step(13.0, "up_mps = 0.012")
    with driven(again, fault(6.0, "board_reset")) as rig:
        rig.runs(16.0)
        assert moved(rig, 13.5, 16.0) > 10 * STILL_M


def test_noise_on_the_line_moves_nothing_and_what_is_counted_stays_true() -> None:
    with driven(step(9.0, "up_mps = 0.0"), fault(5.0, "line_garbage", "for_s = 2.0")) as rig:
        rig.runs(12.0)
        lost = any(axis.reference_lost for axis in rig.bridge.seen.facts.axes.values())
        row = rig.samples[-1]
        assert lost or row["odometry_y_m"] == pytest.approx(row["y_m"], abs=1e-3)


def test_it_ends_in_good_order_and_is_held_by_its_motors() -> None:
    with driven() as rig:
        rig.runs(6.0)
        rig.world.stop(BRIDGE)
        rig.runs(3.0)
        assert rig.bridge.finished
        assert rig.bridge.not_acknowledged == ()
        assert moved(rig, 6.5, 9.0) < STILL_M


def test_its_board_speaks_one_language(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        program(["drive", "ar2", "--serial", "/dev/null", "--protocol", "v1"])
    assert ended.value.code
    assert "ar2 has nothing that takes it" in capsys.readouterr().err


def test_where_no_joint_can_stand_is_refused() -> None:
    wrong = GOES.replace("j3 = 90.0", "j3 = 0.5")
    with scripted(find("ar2"), wrong.format(later="", faults="")) as rig:
        texts: list[bytes] = []
        rig.operator_wire.observe(lambda _now, _sender, packet: texts.append(packet.payload))
        rig.runs(6.0)
        assert any(b"zero: j3 at 0.5 deg is not within 1 to 141" in text for text in texts)
        assert not rig.bridge.seen.facts.armed
        assert moved(rig, 0.5, 6.0) < STILL_M


def test_the_law_takes_the_tool_to_its_pose_in_the_times_of_the_source() -> None:
    """Fig. 4.3 and 4.4: the position within 1 s, the orientation within 5 s; by truth."""
    with scripted(find("ar2"), "pose") as rig:
        rig.runs(4.9)
        wanted = pose(rig)
        courses = rig.robot.geometry.courses.pose
        angle = math.radians(math.hypot(*courses.tilt_deg))
        wanted[:3, 3] += courses.by_m
        wanted[:3, :3] = turned(courses.tilt_deg) @ wanted[:3, :3]
        assert apart(wanted, pose(rig)) == pytest.approx((math.hypot(*courses.by_m), angle), rel=1e-6)
        rig.runs(1.1)
        assert apart(wanted, pose(rig))[0] < 1e-3
        rig.runs(4.0)
        assert apart(wanted, pose(rig))[0] < 3e-4
        assert apart(wanted, pose(rig))[1] < math.radians(0.1)


def turned(degrees: tuple[float, float, float]) -> np.ndarray:
    """Return the rotation about a vector by its length, from the exponential's series."""
    x, y, z = np.radians(degrees)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    total, term = np.eye(3), np.eye(3)
    for order in range(1, 12):
        term = term @ cross / order
        total = total + term
    return total


def pose(rig: Rig) -> np.ndarray:
    """Return where the tool is by the plant's joints."""
    return AR2.pose([rig.samples[-1][f"angle_j{joint}_rad"] for joint in range(1, 7)])


def apart(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return how far two poses are apart, m and rad."""
    turn = one[:3, :3] @ other[:3, :3].T
    angle = math.acos(min(1.0, max(-1.0, (float(np.trace(turn)) - 1.0) / 2.0)))
    return float(np.linalg.norm(one[:3, 3] - other[:3, 3])), angle
