"""ROME whole: its halves, its center of gravity, and what its path followers show."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.testing.inherited.fake_driver import seen
from firmware_bridge.motion.captured import Located, Source
from firmware_bridge.motion.orbit import THESIS
from firmware_bridge.motion.orbit_elements import elements
from firmware_bridge.motion.orbit_tle import state_of_tle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import AnyRobot, Robot, RobotFileError
from firmware_bridge.robot_types import find, load, robot_type_of
from firmware_bridge.robots.ar2 import motion as arm
from firmware_bridge.robots.rome import motion as base
from firmware_bridge.robots.rome_arm import ROBOT_TYPE
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.kinematics import FOLLOWED, LEAST, RomeArmKinematics
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState
from firmware_bridge.robots.rome_arm.orbit import PATHS
from firmware_bridge.teleop.station import Stick, Velocity
from firmware_bridge.units import STANDARD_GRAVITY
from hil_tests.unit.motion.test_orbit_tle import FIVE

ROBOT: Robot[Any] = find("rome_arm")
BENT = tuple(map(math.radians, (0.0, -90.0, 90.0, 0.0, 60.0, 0.0)))
OUT = tuple(map(math.radians, (0.0, -30.0, 30.0, 0.0, 0.0, 0.0)))
STANDS = base.RomeState(0.0, 0.0, 0.0)


def changed(table: str, **values: Any) -> Robot[Any]:
    other = getattr(ROBOT.geometry, table).model_copy(update=values)
    return ROBOT.model_copy(update={"geometry": ROBOT.geometry.model_copy(update={table: other})})


def standing(angles: tuple[float, ...]) -> RomeArmState:
    return RomeArmState(STANDS, arm.Ar2State(angles, (0.0,) * 6))


@pytest.mark.parametrize("name", PATHS)
def test_the_bench_expects_what_the_bridge_shows_by_other_equations(name: str) -> None:
    """An orbit goes by F and G here and by Kepler's equation there."""
    seconds = np.linspace(0.5, 70.0, 140)
    x, y, z = bench_setup_of(ROBOT).paths[name](ROBOT)(seconds)
    path = PATHS[name](ROBOT.geometry)
    places, tools = [path.base(it) for it in seconds], [path.tool(it) for it in seconds]
    assert [it.x for it in places] == pytest.approx(x, abs=1e-9)
    assert [it.y for it in places] == pytest.approx(y, abs=1e-9)
    first = bench_setup_of(ROBOT).paths[name](ROBOT)(np.zeros(1))[2]
    assert [it.by[2] for it in tools] == pytest.approx(z - first, abs=1e-9)


@pytest.mark.parametrize("name", ["orbit", "formation"])
def test_a_path_reports_the_speeds_that_it_has(name: str) -> None:
    path, step = PATHS[name](ROBOT.geometry), 1e-4
    for seconds in np.linspace(1.0, 60.0, 20):
        before, now, after = (path.base(seconds + it) for it in (-step, 0.0, step))
        assert now.x_rate == pytest.approx((after.x - before.x) / (2.0 * step), abs=1e-6)
        assert now.y_rate == pytest.approx((after.y - before.y) / (2.0 * step), abs=1e-6)
        up = (path.tool(seconds + step).by[2] - path.tool(seconds - step).by[2]) / (2.0 * step)
        assert path.tool(seconds).speed[2] == pytest.approx(up, abs=1e-6)


def test_the_printed_orbit_comes_back_after_a_minute_and_one_second_is_one_tu() -> None:
    path = PATHS["orbit"](ROBOT.geometry)
    assert path.stretch == 1.0
    first, last = path.base(1e-9), path.base(60.835)
    assert (last.x, last.y) == pytest.approx((first.x, first.y), abs=2e-4)
    assert math.dist(path.base(0.0)[:2], first[:2]) == pytest.approx(0.1414, abs=1e-4), "it begins beside"


def test_a_larger_orbit_takes_longer_by_what_the_base_lacks() -> None:
    large = PATHS["orbit"](changed("orbit", m_per_du=1.0).geometry)
    limit = ROBOT.geometry.base.limits.speed_mps
    fastest = max(math.hypot(*large.base(it)[3:5]) for it in np.linspace(0.01, 61.0 * large.stretch, 2000))
    assert large.stretch > 1.9
    assert fastest == pytest.approx(0.9 * limit, rel=1e-3)


@pytest.mark.parametrize(
    ("path", "changes"), [("orbit", {"height_per_du": 3.0}), ("formation", {"height_m": 1.0})]
)
def test_a_higher_path_takes_longer_by_what_the_arm_lacks(path: str, changes: dict[str, float]) -> None:
    high = PATHS[path](changed(path, **changes).geometry)
    limit = ROBOT.geometry.arm.limits.speed_mps
    rises = max(abs(high.tool(it).speed[2]) for it in np.linspace(0.01, 61.0 * high.stretch, 2000))
    assert high.stretch > 1.2
    assert rises == pytest.approx(0.9 * limit, rel=1e-3)


@pytest.mark.parametrize(
    "changes", [{"s_per_tu": 2.0}, {"m_per_du": 1.0, "s_per_tu": 1.5}, {"height_per_du": 3.0}]
)
def test_the_bench_knows_the_orbit_that_the_guide_flies(changes: dict[str, float]) -> None:
    robot = changed("orbit", **changes)
    flown, known = PATHS["orbit"](robot.geometry), bench_setup_of(robot).paths["orbit"](robot)
    times = np.linspace(0.1, 100.0, 50)
    x, y, _up = known(times)
    for at, seconds in enumerate(times):
        base = flown.base(seconds)
        assert (base.x, base.y) == pytest.approx((x[at], y[at]), abs=1e-3)


def test_an_orbit_at_its_center_is_refused_by_its_key(tmp_path: Path) -> None:
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    file = tmp_path / "other.toml"
    file.write_text(text.replace("start_du = [-0.5985, 1.6634, 0.0279]", "start_du = [0.0, 0.0, 0.0]"))
    with pytest.raises(RobotFileError, match=r"geometry\.orbit: .*start_du"):
        load(file)


PRINTED = "start_du = [-0.5985, 1.6634, 0.0279]\nspeed_du_tu = [-0.9523, -0.0639, 0.0110]\n"
TLE = "\n".join(f'  "{line}",' for line in FIVE)


def other(folder: Path, orbit: str) -> AnyRobot:
    """Return the robot with another orbit in its file."""
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    assert PRINTED in text
    file = folder / "other.toml"
    file.write_text(text.replace(PRINTED, orbit), encoding="utf-8")
    return load(file)


def test_an_orbit_is_given_by_its_elements_too(tmp_path: Path) -> None:
    of = elements(THESIS)
    angles = (of.inclination, of.node, of.periapsis, of.anomaly)
    names = ("inclination_deg", "node_deg", "periapsis_deg", "anomaly_deg")
    stated = ", ".join(f"{name} = {math.degrees(it)!r}" for name, it in zip(names, angles, strict=True))
    robot = other(
        tmp_path, f"kepler = {{ axis_du = {of.axis!r}, eccentricity = {of.eccentricity!r}, {stated} }}\n"
    )
    printed, given = (PATHS["orbit"](one.geometry) for one in (ROBOT, robot))
    for seconds in np.linspace(0.1, 60.0, 7):
        assert given.base(seconds)[:5] == pytest.approx(printed.base(seconds)[:5], abs=1e-9)
        assert given.tool(seconds).by == pytest.approx(printed.tool(seconds).by, abs=1e-9)


def test_an_orbit_is_given_by_a_two_line_element_set_too(tmp_path: Path) -> None:
    robot = other(tmp_path, f"tle = [\n{TLE}\n]\ntle_s = 21600.0\n")
    begin = PATHS["orbit"](robot.geometry).base(1e-9)
    meant = 0.4 * state_of_tle(*FIVE, 360.0).place
    assert (begin.x, begin.y) == pytest.approx((meant[0], meant[1]), abs=1e-6)


@pytest.mark.parametrize(
    ("orbit", "states"),
    [
        ("", "needs one of: start_du with speed_du_tu, kepler, tle"),
        ("start_du = [1.0, 0.0, 0.0]\n", "needs one of"),
        ("start_du = [0.0, 0.0, 0.0]\nspeed_du_tu = [0.0, 1.0, 0.0]\n", "start_du: an orbit's body"),
        (
            "kepler = { axis_du = 1.0, eccentricity = 0.1 }\ntle_s = 1.0\n",
            "tle_s: only",
        ),
        ("kepler = { axis_du = 1.0, eccentricity = 1.5 }\n", "no orbit has a = 1, e = 1.5"),
        ('tle = ["1 nonsense", "2 nonsense"]\n', "line 1 of a two-line element set"),
        (PRINTED + f"tle = [\n{TLE}\n]\n", "needs one of"),
    ],
)
def test_an_orbit_that_no_one_can_fly_is_refused_by_its_table(
    tmp_path: Path, orbit: str, states: str
) -> None:
    with pytest.raises(RobotFileError, match=rf"geometry\.orbit.*{re.escape(states)}"):
        other(tmp_path, orbit)


def test_its_first_joint_takes_the_center_of_gravity_round_the_middle() -> None:
    ahead = balance(ROBOT.geometry, BENT)
    for degrees in (0.0, 60.0, 120.0, 170.0, -100.0):
        turn = math.radians(degrees)
        turned = balance(ROBOT.geometry, (turn, *BENT[1:]))
        meant = (ahead.x_m * math.cos(turn), ahead.x_m * math.sin(turn))
        assert (turned.x_m, turned.y_m) == pytest.approx(meant, abs=1e-12)
        assert turned.height_m == pytest.approx(ahead.height_m, abs=1e-12)
    # Over a wheel there is more room than over the middle of a side.
    assert balance(ROBOT.geometry, (math.pi / 3.0, *BENT[1:])).room_m == pytest.approx(0.08 - ahead.x_m)
    assert ahead.room_m == pytest.approx(0.08 - ahead.x_m / 2.0)


def test_the_further_out_its_arm_the_more_gently_the_base_changes_its_speed() -> None:
    body, fast = RomeArmKinematics(ROBOT), RomeArmMotion(base.RomeMotion(ahead_mps=0.5))
    steps = []
    for angles in (BENT, tuple(map(math.radians, (60.0, -85.0, 85.0, 0.0, 60.0, 0.0))), OUT):
        state = standing(angles)
        ramped = body.ramped(RomeArmMotion(), fast, state, ROBOT.cycle)
        steps.append(ramped.base.ahead_mps / body.share(state))
    assert steps == pytest.approx([steps[0]] * 3, rel=1e-6)
    assert body.share(standing(BENT)) == FOLLOWED
    assert body.share(standing(OUT)) == LEAST, "to stop it needs some"
    assert body.share(standing((math.nan,) * 6)) == LEAST


def test_the_acceleration_that_uses_up_the_room_would_tip_it() -> None:
    at = balance(ROBOT.geometry, BENT)
    gentlest = at.gentlest(0.0)
    assert at.room_m == pytest.approx(gentlest * at.height_m / STANDARD_GRAVITY)
    assert at.gentlest(at.room_m + 0.001) == 0.0


def test_until_the_cameras_have_seen_it_neither_half_begins_to_fly() -> None:
    path_follower = ROBOT_TYPE.path_followers["orbit"](ROBOT)
    unseen = Located(Pose(), Source.UNSEEN, 0.0, 0.0, 0.0, 0)
    at = seen(ROBOT)
    for _ in range(5):
        command = path_follower.command(type(at)(**{**shown(at), "located": unseen}), ROBOT.cycle)
        assert command.arm == arm.Ar2Motion()
        assert command.base.twist == (0.0, 0.0, 0.0)
    first = path_follower.command(at, ROBOT.cycle)
    assert (first.base.path_s, first.arm.path_s) == (0.0, 0.0)
    second = path_follower.command(at, ROBOT.cycle)
    assert second.base.path_s == second.arm.path_s == pytest.approx(0.1)
    path_follower.reset()
    waited = path_follower.command(at, ROBOT.cycle)
    assert waited.base.path_s == waited.arm.path_s == second.base.path_s


def shown(at: Any) -> dict[str, Any]:
    return {name: getattr(at, name) for name in ("facts", "command", "commanded", "body", "pose", "located")}


def test_by_stick_the_base_drives_and_the_tool_goes_up_and_down_alone() -> None:
    command = ROBOT_TYPE.station.stick(
        Stick(forward=0.5, left=-0.5, turn=1.0, up=0.25), RomeArmMotion(), ROBOT
    )
    limits, tool = ROBOT.geometry.base.limits, ROBOT.geometry.arm.limits
    full = 0.98 * limits.speed_mps
    assert command.base.twist == (0.5 * full, -0.5 * full, limits.turn_rate_rad_s)
    assert command.arm.twist == (0.0, 0.0, 0.25 * tool.speed_mps, 0.0, 0.0, 0.0)
    requested = ROBOT_TYPE.station.target(Velocity(0.1, 0.2, 0.3), command, ROBOT)
    assert isinstance(requested, RomeArmMotion)
    assert (requested.base.twist, requested.arm) == ((0.1, 0.2, 0.3), arm.Ar2Motion())


def test_each_half_sees_itself_alone() -> None:
    kind = robot_type_of(ROBOT)
    names = [row.name for row in (*kind.interlocks, *kind.limits)]
    assert len(set(names)) == len(names)
    assert {"speed limit", "tool speed limit", "acceleration limit", "tool acceleration limit"} <= set(names)
    assert kind.groups == {
        "base": frozenset({"wheel_one", "wheel_two", "wheel_three"}),
        "tool": frozenset({f"j{joint}" for joint in range(1, 7)}),
    }
