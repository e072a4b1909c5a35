"""Case 2 of the climber's paper, and equal speeds on its laboratory's tank: both mirror images of the robot.

[C] is Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016. Its 2.1 has the joint in the left wheel's chain, its 3
and case 1 hold v_x and w_z of the chassis {r}, open loop. It prints no numbers of these paths: those here
were computed by exact rolling, apart from this repository, for the robot of its section 4 (b = 0.1 m, r_w =
0.05 m) with r_t = 0.01 m and a caster of the wheels' size, 0.2 m behind them, with an offset of 0.025 m.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from fmu.climber.parameters import SETS
from hil_tests.fmu.climber_rolled import NUMBERS, Rolled
from validation.climber.constraints import Robot
from validation.climber.plant import Way

SPEED, TURN, RADIUS = 0.05, 0.1, 0.5
ROUND_S = math.tau / TURN
LEFT, RIGHT = 1.0, -1.0
CASTER = {"caster_distance": 0.2, "caster_offset": 0.025, "caster_radius": 0.05, "caster_crown": 0.01}
SIDES = pytest.mark.parametrize("side", [LEFT, RIGHT], ids=["joint left", "joint right"])

CIRCLES = {
    # r_c / b: off the circle [mm], not closed by [mm], width over height; to the left, to the right
    2000.0: (("0.09", "0.00", "0.9999"), ("0.09", "0.00", "0.9999")),
    500.0: (("0.38", "0.01", "0.9997"), ("0.38", "0.00", "0.9997")),
    20.0: (("12.01", "10.66", "0.9896"), ("10.08", "2.33", "0.9917")),
    15.0: (("17.20", "27.90", "0.9823"), ("13.72", "5.77", "0.9890")),
    13.3: (("21.91", "49.61", "0.9766"), ("15.63", "7.19", "0.9885")),
}
"""Once round 0.5 m from round the tank, of the paper's robot, whose joint is left."""


def on(ratio: float, side: float, heading: float = 0.0) -> dict[str, float]:
    ratio_20 = {**NUMBERS, **SETS["ratio_20"], **CASTER}
    tank = ratio * ratio_20["half_track"]
    return {**ratio_20, "tank_radius": tank, "joint_side": side, "start_heading": heading}


@SIDES
@pytest.mark.parametrize("turns", [1.0, -1.0], ids=["to the left", "to the right"])
@pytest.mark.parametrize("ratio", CIRCLES)
def test_circles_by_the_chassis_s_speeds(ratio: float, turns: float, side: float) -> None:
    """[C] case 2: the closing circle and the oblong one; the mirrored robot's turns are exchanged."""
    p, turn = on(ratio, side), turns * TURN
    rows = Robot.standing(p, 0.0).steered(SPEED, turn, ROUND_S, ROUND_S / 480)
    way = Way.of([row.readings() for row in rows], p["tank_radius"])
    off, gap = way.off_circle(SPEED / turn, 0.0), way.gap()
    found = (f"{1e3 * off:.2f}", f"{1e3 * gap:.2f}", f"{way.width_over_height():.4f}")
    assert found == CIRCLES[ratio][0 if turns * side > 0.0 else 1]


LABORATORY = {
    # heading [°]: drift to the left [mm], caster trailing, caster leading
    0.0: (0.0, 0.0),
    45.0: (1.73, 1.76),
    90.0: (-2.78, 3.67),
    135.0: (-5.49, 2.32),
}
"""The largest one on 0.5 m by equal speeds, of the paper's robot on the tank of its section 5: all wheels
have 25.4 mm with r_t = 5 mm, c = 12 mm; the wheel that is fixed in the chassis is upright at the start."""


@SIDES
@pytest.mark.parametrize("nose", [1.0, -1.0], ids=["trailing", "leading"])
@pytest.mark.parametrize("degrees", LABORATORY)
def test_equal_speeds_on_the_laboratory_s_tank(degrees: float, nose: float, side: float) -> None:
    """[C] 5, Fig. 6. Mirrored, 45 and 135 degrees are exchanged, and the drift is to the other side."""
    p = {**NUMBERS, "caster_radius": 0.0254, "caster_crown": 0.005, "joint_side": side}
    heading = math.radians(degrees)
    spin = nose * SPEED / p["wheel_radius"]
    rows = upright(p, heading).driven(lambda _: spin, lambda _: spin, 10.0, 0.1)
    way = Way.of([row.readings() for row in rows], p["tank_radius"])
    arc, height = way.arc - way.arc[0], way.height - way.height[0]
    aside = 1e3 * (height * math.cos(heading) - arc * math.sin(heading))
    expected = LABORATORY[degrees if side > 0.0 else 180.0 - degrees if degrees else 0.0]
    largest = aside[int(np.argmax(np.abs(aside)))]
    assert round(float(largest), 2) == side * expected[0 if nose > 0.0 else 1]


def upright(p: Mapping[str, float], heading: float) -> Robot:
    """Return it where the wheel whose axle is fixed in the chassis stands upright."""
    fixed = 1 if p["joint_side"] > 0.0 else 0

    def leans(lean: float) -> float:
        return Robot.standing(p, heading, 0.0, lean).touches()[fixed].tube

    one, other = 0.0, 1e-4
    for _ in range(4):
        slope = (leans(other) - leans(one)) / (other - one)
        one, other = other, other - leans(other) / slope if slope else other
        if abs(leans(other)) < 1e-13:
            break
    return Robot.standing(p, heading, 0.0, other)


@pytest.fixture
def rolled(tmp_path: Path) -> Iterator[Callable[[Mapping[str, float]], Rolled]]:
    opened: list[Rolled] = []

    def make(parameters: Mapping[str, float]) -> Rolled:
        opened.append(Rolled(tmp_path / "fmu", parameters))
        return opened[-1]

    yield make
    for each in opened:
        each.close()


def pitch_of(robot: Robot) -> float:
    """Return the chassis's angle about its axle from the way of the wheel that is fixed in it."""
    fixed = robot.touches()[1 if robot.p["joint_side"] > 0.0 else 0]
    way = np.cross(fixed.axle, fixed.normal)
    way /= np.linalg.norm(way)
    return math.atan2(float(robot.frame[0] @ np.cross(way, fixed.axle)), float(robot.frame[0] @ way))


@SIDES
def test_the_plant_rolls_as_exact_rolling_does(
    rolled: Callable[[Mapping[str, float]], Rolled], side: float
) -> None:
    """All rates, any way round and with the joint turned: Montana's equations, and eleven unknowns."""
    p = on(13.3, side)
    plant = rolled({name: value for name, value in p.items() if value != NUMBERS[name]})
    instant = 1e-5
    for place in range(8):
        robot = Robot.standing(p, place * math.tau / 8.0, 0.3 * place - 1.0, 0.02 * place - 0.07)
        held, (left, right) = robot.held(SPEED, TURN), robot.spins(SPEED, TURN)
        speeds = {"speed_left": p["gear_wheel"] * left, "speed_right": p["gear_wheel"] * right}
        found = plant.rates({**plant.start, **robot.readings(), **speeds, "pitch": pitch_of(robot)})
        assert (found["joint"], found["swivel"]) == pytest.approx((held[6], held[7]), abs=1e-10)
        later, sooner = (robot.steered(way * SPEED, way * TURN, instant, instant)[-1] for way in (1.0, -1.0))
        after, before = ({**at.readings(), "pitch": pitch_of(at)} for at in (later, sooner))
        for name in after.keys() - {"joint", "swivel"}:
            rate = math.remainder(after[name] - before[name], math.tau) / (2.0 * instant)
            assert found[name] == pytest.approx(rate, abs=1e-9), name


@pytest.mark.parametrize(
    "more", [{"start_heading": 0.6}, {"start_heading": 0.6, "start_swivel": 2.0, "axis_tilt": 0.3}]
)
def test_the_mirrored_robot_is_the_mirror_image(
    rolled: Callable[[Mapping[str, float]], Rolled], more: dict[str, float]
) -> None:
    """Arcs and directions turn round, left and right are exchanged, the joint's angle is the same."""
    image = {**more, "start_heading": math.pi - more["start_heading"]}
    image["start_swivel"] = -more.get("start_swivel", 0.0)
    one, other = (rolled({**each, "joint_side": side}) for each, side in ((more, LEFT), (image, RIGHT)))
    exchanged = {"left": "right", "right": "left"}
    signs = {"arc": -1.0, "tube": -1.0, "swivel": -1.0, "psi": -1.0}
    for name, value in one.start.items():
        kind, _, side = name.partition("_")
        mirrored = other.start["_".join(filter(None, (kind, exchanged.get(side, side))))]
        expected = signs.get(kind, 1.0) * mirrored
        off = math.remainder(value - expected, math.tau) if kind == "psi" else value - expected
        assert off == pytest.approx(0.0, abs=1e-12), name
