"""The climber's surface, joint and magnets in numbers: what its rules and its odometry rest on."""

import math
from dataclasses import replace

import pytest

from emulators.bench.cases import Situation
from emulators.motion_capture.bodies import Attitude, product, turned
from emulators.testing.inherited.fake_driver import START, gate_of, seen
from firmware_bridge.drivers.driver import SeenPose
from firmware_bridge.motion.differential import twist, wheel_speeds
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot.file import text_of
from firmware_bridge.robot_types import find, parse, robot_type_named
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.paths import PATHS
from firmware_bridge.robots.climber.surface import placed, planar_motion, track_on, unrolled
from hil_tests.rows import every
from validation.climber.constraints import Robot
from validation.climber.plant import sizes

CLIMBER = find("climber")
GEOMETRY = CLIMBER.geometry
RADIUS = GEOMETRY.tank.radius_m
UP = math.pi / 2.0


def about(axis: int, angle: float) -> tuple[float, float, float, float]:
    parts = [0.0, 0.0, 0.0, math.cos(angle / 2.0)]
    parts[axis] = math.sin(angle / 2.0)
    return parts[0], parts[1], parts[2], parts[3]


def on_tank(arc: float, height: float, heading: float, off: float = 0.0) -> SeenPose:
    """Return a body on the tank as geometry has it: x ahead, y left, z off the wall."""
    round_it = arc / RADIUS
    # Looking along the arc at its begin: ahead is the room's y, left its z, up its x.
    flat = product(about(2, UP), about(0, UP))
    attitude = product(product(about(2, round_it), flat), about(2, heading))
    far = RADIUS + off
    place = (
        GEOMETRY.tank.axis_x_m + far * math.cos(round_it),
        GEOMETRY.tank.axis_y_m + far * math.sin(round_it),
        height,
    )
    assert turned(attitude, (0.0, 0.0, 1.0)) == pytest.approx((math.cos(round_it), math.sin(round_it), 0.0))
    assert Attitude(place, attitude)
    return SeenPose(place, attitude, math.nan, 0)


@every(
    ("arc", "height", "heading"),
    [(0.0, 0.0, UP), (0.3, 1.0, 0.0), (-5.0, -1.0, 2.5), (7.0, 2.0, -1.0), (25.0, 3.0, 0.7)],
)
def test_a_pose_in_the_room_is_unrolled_near_where_it_is_believed_to_be(
    arc: float, height: float, heading: float
) -> None:
    near = Pose(arc + 0.3, height, heading)
    for off in (0.0, 0.05):
        found = unrolled(GEOMETRY, on_tank(arc, height, heading, off), near)
        assert (found.x_m, found.y_m) == pytest.approx((arc, height))
        assert math.remainder(found.heading_rad - heading, math.tau) == pytest.approx(0.0, abs=1e-12)


def test_odometry_counts_from_how_the_robot_was_put_on() -> None:
    found = placed(GEOMETRY, Pose(1.0, 0.5, 0.1))
    assert (found.x_m, found.y_m, found.heading_rad) == pytest.approx((-0.5, 1.0, UP + 0.1))


def test_the_track_is_the_narrower_the_more_the_axle_is_bent() -> None:
    """Round it the axle is straight; along it upright wheels stand at atan(b / (r_c + r_w))."""
    upright = math.atan(0.1 / (RADIUS + 0.05))
    assert track_on(GEOMETRY, 0.0) == pytest.approx(0.2)
    assert track_on(GEOMETRY, UP) == pytest.approx(2.0 * RADIUS * upright)
    assert track_on(GEOMETRY, UP, 2.0 * upright) == pytest.approx(track_on(GEOMETRY, UP), rel=1e-4)
    leaning = 2.0 * (0.1 * math.cos(0.1) - 0.04 * math.sin(0.1))
    assert track_on(GEOMETRY, 0.0, 0.2) == pytest.approx(leaning)


SIDES = pytest.mark.parametrize("side", ["left", "right"])


def jointed(side: str) -> ClimberGeometry:
    """Return the robot whose joint is on this side."""
    found: ClimberGeometry = GEOMETRY.model_copy(
        update={"joint": GEOMETRY.joint.model_copy(update={"side": side})}
    )
    return found


def looks(robot: Robot) -> float:
    """Return its heading: wheels toe a little where the joint is turned, so their mean."""
    read = robot.readings()
    return 0.5 * (read["psi_left"] + read["psi_right"]) - UP


@SIDES
@every(
    ("heading", "turn"), [(0.0, 0.1), (0.0, -0.1), (2.0, 0.1), (UP, 0.0), (math.pi / 4.0, 0.0), (4.0, -0.1)]
)
def test_the_chassis_s_speeds_take_the_wheel_speeds_of_exact_rolling(
    heading: float, turn: float, side: str
) -> None:
    """v_x and w_z of [C] (10), on 20 half tracks, within 0.8 %; those of a plane are off by up to 3 %."""
    geometry = jointed(side)
    p = sizes("driven", joint_side=geometry.joint.place)
    for robot in Robot.standing(p, heading).steered(0.05, turn, 5.0, 0.25)[5:]:
        found = wheel_speeds(geometry.base, *planar_motion(geometry, 0.05, turn, looks(robot), robot.joint))
        assert found == pytest.approx(robot.spins(0.05, turn), rel=0.008)


@SIDES
def test_a_chassis_that_leans_has_a_part_of_the_surface_s_turn_about_its_up(side: str) -> None:
    """Round the tank, the joint at 0.15 rad: to one side with the joint left, to the other with it right."""
    geometry, mirrored = jointed(side), jointed("right" if side == "left" else "left")
    p = sizes("driven", joint_side=geometry.joint.place)
    robot = Robot.standing(p, 0.0, 0.0, 0.15)
    _, exact = twist(geometry.base, *robot.spins(0.05, 0.1))
    _, found = planar_motion(geometry, 0.05, 0.1, looks(robot), robot.joint)
    _, wrong = planar_motion(mirrored, 0.05, 0.1, looks(robot), robot.joint)
    assert found == pytest.approx(exact, abs=5e-4)
    assert abs(wrong - exact) > 3e-3


@every("name", sorted(set(PATHS) - {"vertical", "horizontal", "spiral"}))
def test_closed_paths_close(name: str) -> None:
    x = y = 0.0
    for leg in PATHS[name](GEOMETRY.paths):
        arc, height, _ = leg.at(leg.length)
        x, y = x + arc, y + height
    assert math.hypot(x, y) < 1e-9


@every(
    ("joint_deg", "allowed"),
    [(0.0, 0.06), (12.0, 0.06), (13.5, 0.03), (15.0, 0.0), (24.0, 0.0)],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_is_the_slower_the_more_the_joint_is_turned_the_way_in_which_that_grows(
    joint_deg: float, allowed: float, side: float
) -> None:
    gate, body = gate_of(CLIMBER), ClimberState(0.0, 0.0, side * math.radians(joint_deg), 1.0)
    for command, expected in ((side * 0.06, side * allowed), (-side * 0.06, -side * 0.06)):
        decision = gate.rule(seen(CLIMBER, START, Situation(command=ClimberMotion(command, 0.1), body=body)))
        assert decision.allowed.speed_mps == pytest.approx(expected)
        assert decision.allowed.turn_rad_s == pytest.approx(0.1)


@every(("reported_deg", "read_deg"), [(0.0, 0.0), (-29.9, -29.9), (29.9, 29.9), (-45.0, None), (30.1, None)])
def test_an_angle_beyond_the_stops_is_a_wire_that_is_off(reported_deg: float, read_deg: float | None) -> None:
    joint = GEOMETRY.joint
    angle = joint.read(math.radians(reported_deg) + joint.rest)
    assert (None if angle is None else math.degrees(angle)) == (
        read_deg if read_deg is None else pytest.approx(read_deg)
    )


@every(
    ("before", "after", "problem"),
    [
        ("k_alpha_per_s = 3.0", "k_alpha_per_s = 0.9", "k_alpha_per_s must be larger than k_rho_per_s"),
        ("k_beta_per_s = -0.5", "k_beta_per_s = 0.5", "k_beta_per_s"),
        ("slow_deg = 12.0", "slow_deg = 16.0", "must grow in this order"),
        ("sensor_bound_deg = 30.0", "sensor_bound_deg = 15.0", "must grow in this order"),
        ("mass_kg = 4.0", "mass_kg = 7.0", "the magnets hold 6.06 kg with least_margin, mass_kg is 7"),
        ("speed_mps = 0.05\n", "speed_mps = 0.08\n", "control.speed_mps is 0.08, limits.speed_mps only 0.06"),
    ],
)
def test_a_file_that_would_fall_or_swing_is_refused(before: str, after: str, problem: str) -> None:
    text = text_of(robot_type_named("climber").file)
    assert before in text
    with pytest.raises(RobotFileError, match=problem):
        parse(text.replace(before, after), "climber.toml")


def test_off_the_wall_it_is_disarmed_and_cannot_be_armed() -> None:
    gate, well = gate_of(CLIMBER), ClimberState(0.0, 0.0, 0.0, 1.0)
    assert not gate.rule(seen(CLIMBER, START, Situation(body=well))).interlock_events
    (event,) = gate.rule(seen(CLIMBER, START, Situation(body=replace(well, on_wall=0.0)))).interlock_events
    assert event.name == "off the wall"
    assert event.interlock.disarms
    assert event.interlock.blocks_arming
