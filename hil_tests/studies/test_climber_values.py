"""Check values of the climber's paper, Fig. 6 and (30) (Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016).

The paper prints no numbers of Fig. 6: those here were computed by exact rolling, apart from this repository.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from validation.climber.constraints import Robot
from validation.climber.three_ways import (
    HEADINGS,
    Chains,
    Three,
    closed_along,
    driven,
    laboratory,
    largest,
    planar,
    three_ways,
)

DEVIATIONS = {
    # heading [°]: largest deviation to the left on 0.5 m [mm], caster trailing, caster leading
    0.0: (0.0, 0.0),
    45.0: (1.73, 1.76),
    90.0: (-2.78, 3.67),
    135.0: (-5.49, 2.32),
}
TAILS = pytest.mark.parametrize("tail", [False, True], ids=["trailing", "leading"])
SIDES = pytest.mark.parametrize("side", [1.0, -1.0], ids=["joint left", "joint right"])
DEGREES = pytest.mark.parametrize("degrees", HEADINGS)


FEW = pytest.mark.long(keeps=["45.0-trailing-joint left", "135.0-leading-joint right"])
"""Two of sixteen drives are enough for the first lane."""


@cache
def drive(degrees: float, side: float, *, tail: bool) -> Three:
    return driven(degrees, tail=tail, side=side)


def expected(degrees: float, side: float, *, tail: bool) -> float:
    """Return it in mm: the mirrored robot exchanges 45 and 135 degrees and turns the signs."""
    exchanged = degrees if side > 0.0 else 180.0 - degrees if degrees else 0.0
    return side * DEVIATIONS[exchanged][1 if tail else 0]


@FEW
@SIDES
@TAILS
@DEGREES
def test_exact_rolling_leaves_the_straight_line_by_so_much_sizes_assumed(
    degrees: float, side: float, *, tail: bool
) -> None:
    """Fig. 6, the non-planar model; r_t 5 mm, c 12 mm, caster wheel 25.4 mm."""
    run = drive(degrees, side, tail=tail)
    assert largest(run.aside(run.exact)) == pytest.approx(expected(degrees, side, tail=tail), abs=0.005)


@FEW
@SIDES
@TAILS
@DEGREES
def test_the_plant_leaves_the_straight_line_by_so_much_sizes_assumed(
    degrees: float, side: float, *, tail: bool
) -> None:
    """Fig. 6, the plant in place of what was measured."""
    run = drive(degrees, side, tail=tail)
    assert largest(run.aside(run.plant)) == pytest.approx(expected(degrees, side, tail=tail), abs=0.005)


@FEW
@SIDES
@TAILS
@DEGREES
def test_plant_and_exact_rolling_go_one_way_sizes_assumed(degrees: float, side: float, *, tail: bool) -> None:
    """Fig. 6, at every instant: both on one unrolled surface."""
    run = drive(degrees, side, tail=tail)
    assert 1e3 * np.abs(run.plant - run.exact).max() < 0.001


@TAILS
@DEGREES
def test_the_planar_model_stays_on_the_straight_line(degrees: float, *, tail: bool) -> None:
    """(1)-(3) at equal speeds."""
    run = drive(degrees, 1.0, tail=tail)
    assert np.abs(run.aside(run.planar)).max() < 1e-9
    course = np.array([math.cos(run.course), math.sin(run.course)])
    assert run.planar[:, -1] @ course == pytest.approx(-0.5 if tail else 0.5, abs=1e-12)


def test_the_planar_model_turns_on_a_circle() -> None:
    """(1)-(3): one wheel alone turns it about the other one by r_w q / 2b."""
    p = laboratory(90.0)
    arc, height = planar(p, (0.0, 0.5))
    turned = 10.0 * 0.5 * 0.0254 / 0.1016
    assert (arc[-1], height[-1]) == pytest.approx(
        (-0.0508 * (1.0 - math.cos(turned)), 0.0508 * math.sin(turned)), abs=1e-9
    )


@SIDES
@DEGREES
def test_the_wheel_fixed_in_the_chassis_stands_upright_at_the_start(degrees: float, side: float) -> None:
    """2.1: the right one, or the mirrored robot's left one."""
    p = laboratory(degrees, side)
    robot = Robot.standing(p, p["start_heading"], 0.0, p["start_joint"])
    assert robot.touches()[1 if side > 0.0 else 0].tube == pytest.approx(0.0, abs=1e-13)


@pytest.mark.long(keeps=["45.0"])
@DEGREES
def test_the_closed_chains_give_the_poses_of_integrated_rates_sizes_assumed(degrees: float) -> None:
    """(30), tail first, steps of 2 mm: no drift, the chains stay closed."""
    closing = closed_along(degrees, 0.002, 0.5 if degrees == 45.0 else 0.3, tail=True)
    assert closing.apart.max() < 1e-6
    assert closing.joint.max() < 2e-5
    assert closing.turned.max() < 2e-5
    assert closing.open.max() < 1e-13


@pytest.mark.long(beside="test_the_chains_are_closed_where_they_start")
def test_the_closed_chains_do_so_where_the_joint_runs_away_sizes_assumed() -> None:
    """(30), nose first, steps of 1 mm: differences grow there as the joint does."""
    closing = closed_along(45.0, 0.001, 0.2, tail=False)
    assert closing.apart.max() < 1e-6
    assert closing.open.max() < 1e-13


@pytest.mark.long(beside="test_the_chains_are_closed_where_they_start")
def test_half_the_step_leaves_a_quarter_of_the_difference_sizes_assumed() -> None:
    """(30): what remains is that of constant turns within a step."""
    coarse, fine = (closed_along(90.0, step, 0.2, tail=True).apart.max() for step in (0.004, 0.002))
    assert coarse / fine == pytest.approx(4.0, abs=0.05)


@DEGREES
def test_the_chains_are_closed_where_they_start(degrees: float) -> None:
    """(30): wheels, contacts and angles by the geometry of a robot that stands."""
    p = laboratory(degrees)
    robot = Robot.standing(p, p["start_heading"], 0.4, p["start_joint"])
    chains = Chains.of(robot)
    frames, middles = chains.poses()
    assert chains.open() < 1e-13
    assert np.abs(frames - robot.frame).max() < 1e-13
    assert np.abs(middles - robot.middle).max() < 1e-13


def test_the_elements_of_30_do_not_fix_a_rotation_in_the_surface_s_axes() -> None:
    """(30): twelve unknowns, of which at 0 degrees one is free there; it is not in the assumed base."""
    p = laboratory(0.0)
    chains = Chains.of(Robot.standing(p, 0.0, 0.0, p["start_joint"]))
    surface = replace(chains, base=np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
    ranks = [np.linalg.matrix_rank(each.slope(np.zeros(18))[1], 1e-6) for each in (chains, surface)]
    assert ranks[0] == 12
    assert ranks[1] < 12
    assert chains.observed() == pytest.approx(0.5, abs=1e-12)
    assert surface.observed() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.long(beside="test_the_planar_model_turns_on_a_circle")
def test_the_study_holds_its_bounds_in_short() -> None:
    """Fig. 6 and (30), at 45 degrees."""
    findings = three_ways(True)  # noqa: FBT003
    assert findings.out_of_bounds == ()
    for plot in findings.plots:
        assert all(len(curve.x) == len(curve.y) for curve in plot.curves)
