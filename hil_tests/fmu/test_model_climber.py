"""The climbing robot's motion: against eleven unknowns solved by another way, and against closed forms."""

import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from fmu.build import ensure
from fmu.climber.parameters import SETS
from fmu.plant import FmuPlant, PlantError
from hil_tests.fmu.climber_rolled import NUMBERS, Rolled
from validation.climber.constraints import Robot

Maker = Callable[..., Rolled]
UP, SLANT = math.pi / 2, math.pi / 4
LEADING = {"start_swivel": math.pi}
RIGHT = {"joint_side": -1.0}


@pytest.fixture(scope="module")
def unzipped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("climber") / "fmu"


@pytest.fixture
def rolled(unzipped: Path) -> Iterator[Maker]:
    opened: list[Rolled] = []

    def make(parameters: Mapping[str, float]) -> Rolled:
        opened.append(Rolled(unzipped, parameters))
        return opened[-1]

    yield make
    for each in opened:
        each.close()


def same(found: Mapping[str, float], expected: Mapping[str, float], within: float) -> None:
    for name, value in expected.items():
        off = found[name] - value
        off = math.remainder(off, 2 * math.pi) if name.startswith("psi") else off
        assert abs(off) < within, (name, found[name], value)


STARTS = {
    "up the tank": ("lab", {}),
    "slantwise": ("lab", {"start_heading": SLANT}),
    "slantwise, caster leading": ("lab", {"start_heading": SLANT, **LEADING}),
    "round it, caster aside": ("lab", {"start_heading": 0.0, "start_swivel": 1.5}),
    "down, joint turned": ("lab", {"start_heading": -2.0, "start_joint": 0.1}),
    "ratio 13": ("ratio_13", {"start_heading": 0.3}),
    "plane": ("plane", {"start_heading": 1.0}),
    "slantwise, joint right": ("lab", {"start_heading": SLANT, **RIGHT}),
    "down, joint right and turned": ("lab", {"start_heading": -2.0, "start_joint": 0.1, **RIGHT}),
}


@pytest.mark.parametrize(("kind", "more"), STARTS.values(), ids=STARTS)
def test_it_starts_where_all_wheels_touch(rolled: Maker, kind: str, more: dict[str, float]) -> None:
    """Any heading, swivel and joint: the same place as a search by geometry alone finds."""
    plant = rolled({**SETS[kind], **more})
    p = plant.numbers
    robot = Robot.standing(p, p["start_heading"], p["start_swivel"], p["start_joint"])
    assert max(abs(each.gap) for each in robot.touches()) < 1e-12
    same(plant.start, robot.readings(), 1e-5)
    # As the plant's joint stands, contacts are exact.
    moved = rolled({**plant.numbers, "start_arc": 0.2, "start_height": -0.3})
    for name, value in plant.start.items():
        by = {"arc": 0.2, "height": -0.3}.get(name.partition("_")[0], 0.0)
        assert moved.start[name] == pytest.approx(value + by, abs=1e-9)


def test_where_it_cannot_stand_it_refuses_to_start() -> None:
    with pytest.raises(PlantError, match="is not a number: the parameters contradict each other"):
        FmuPlant(ensure("climber", 3), [], [], {"tank_radius": 0.05})


def wavy(sign: float) -> Callable[[float], float]:
    return lambda t: 2.0 + sign * math.sin(2 * t)


@pytest.mark.long(keeps=["lab-more0-1.0"])
@pytest.mark.parametrize(
    ("kind", "more", "way"),
    [
        ("lab", {"start_heading": SLANT}, 1.0),
        ("lab", {"start_heading": SLANT, **LEADING}, -1.0),
        ("lab", {}, 1.0),
        ("ratio_20", {"start_heading": 0.3}, 1.0),
        ("lab", {"start_heading": SLANT, **RIGHT}, 1.0),
    ],
)
def test_both_formulations_agree(rolled: Maker, kind: str, more: dict[str, float], way: float) -> None:
    """Montana's equations in the plant, and eleven unknowns with contacts by geometry: within 2e-6 in 2 s."""
    plant = rolled({**SETS[kind], **more})
    p = plant.numbers
    robot = Robot.standing(p, p["start_heading"], p["start_swivel"])
    left, right = (lambda t: way * wavy(1.0)(t)), (lambda t: way * wavy(-1.0)(t))
    ours, others = plant.driven(left, right, 2.0), robot.driven(left, right, 2.0, 0.04)
    same(ours[-1], others[-1].readings(), 2e-6)
    assert abs(others[-1].readings()["psi_left"] - others[0].readings()["psi_left"]) > 0.03


def test_on_a_plane_it_is_a_differential_drive(rolled: Maker) -> None:
    """r_c / b = 1e6: the circle of two wheels, all else at rest."""
    plant = rolled({**SETS["plane"]})
    *_, last = plant.driven(lambda _: 1.0, lambda _: 3.0, 4.0)
    radius, track = plant.numbers["wheel_radius"], plant.numbers["half_track"]
    turned, curve = radius * 2.0 * 4.0 / (2 * track), track * 2.0
    assert last["psi_left"] == pytest.approx(math.pi + turned, abs=1e-5)
    assert middle(last) == pytest.approx(
        (-curve * (1 - math.cos(turned)), curve * math.sin(turned)), abs=1e-6
    )
    for name in ("pitch", "joint", "tube_left", "tube_right"):
        assert last[name] == pytest.approx(0.0, abs=1e-5)
    # The caster has come round: its axle, too, points at the circle's middle.
    behind, trail, swivel = plant.numbers["caster_distance"], plant.numbers["caster_offset"], last["swivel"]
    off = behind * math.cos(swivel) + curve * math.sin(swivel) + trail
    assert off == pytest.approx(0.0, abs=1e-5)


def middle(row: Mapping[str, float]) -> tuple[float, float]:
    return (row["arc_left"] + row["arc_right"]) / 2, (row["height_left"] + row["height_right"]) / 2


def circle(rows: list[tuple[float, float]]) -> tuple[float, float]:
    """Return how far a circle is from closing, and how much higher than wide it is; m."""
    points = np.array(rows)
    high, wide = np.ptp(points[:, 1]), np.ptp(points[:, 0])
    return float(np.hypot(*(points[-1] - points[0]))), float(high - wide)


@pytest.mark.long(keeps=["13.3"])
@pytest.mark.parametrize("ratio", [13.3, 20.0, 500.0, 2000.0])
def test_circles_deviate_as_the_independent_solution_does(rolled: Maker, ratio: float) -> None:
    """A circle by the wheels' speeds does not close and is oblong: by as much as in the other solution."""
    tank = ratio * SETS["ratio_20"]["half_track"]
    # From upwards the joint runs away on the smallest one, where it turns to the left.
    plant = rolled({**SETS["ratio_20"], "tank_radius": tank, "start_heading": 0.0})
    seconds = 4 * math.pi  # 0.5 rad/s in a plane
    ours = plant.driven(lambda _: 1.0, lambda _: 3.0, seconds, seconds / 200)
    robot = Robot.standing(plant.numbers, 0.0)
    others = robot.driven(lambda _: 1.0, lambda _: 3.0, seconds, seconds / 120)
    found = circle([middle(row) for row in ours])
    expected = circle([middle(each.readings()) for each in others])
    assert found == pytest.approx(expected, rel=0.15)
    assert expected[0] > 1e-7


def drift(rows: list[dict[str, float]]) -> tuple[float, float]:
    """Return way and drift to the left, as seen from the heading at the start; m."""
    (s0, z0), (s1, z1) = middle(rows[0]), middle(rows[-1])
    heading = (rows[0]["psi_left"] + rows[0]["psi_right"]) / 2 - math.pi / 2
    s, z, cosine, sine = s1 - s0, z1 - z0, math.cos(heading), math.sin(heading)
    return s * cosine + z * sine, z * cosine - s * sine


@pytest.mark.parametrize(
    ("more", "speed", "sideways"),
    [
        ({"start_heading": SLANT}, 2.0, 2.4e-4),
        ({"start_heading": SLANT, **LEADING}, -2.0, 1.4e-4),
        ({}, 2.0, 7e-6),
        ({**LEADING}, -2.0, 9e-6),
        ({**RIGHT}, 2.0, -7e-6),
        ({**LEADING, **RIGHT}, -2.0, -9e-6),
    ],
    ids=[
        "slantwise, trailing",
        "slantwise, leading",
        "up, trailing",
        "up, leading",
        "up, trailing, joint right",
        "up, leading, joint right",
    ],
)
def test_equal_speeds_do_not_keep_it_straight(
    rolled: Maker, more: dict[str, float], speed: float, sideways: float
) -> None:
    """On the laboratory's tank, after 0.2 m: it drifts at 45 degrees, and upwards, too, though little.

    With the caster trailing the joint runs away; with the caster leading it comes back.
    """
    rows = rolled(more).driven(lambda _: speed, lambda _: speed, 4.0)
    way, aside = drift(rows)
    assert way == pytest.approx(math.copysign(0.2, speed), abs=0.01)
    assert aside == pytest.approx(sideways, rel=0.1)
    assert (rows[-1]["joint"] > 1.3 * rows[0]["joint"]) == (speed > 0)
    assert (rows[-1]["joint"] < 0.8 * rows[0]["joint"]) == (speed < 0)


def pivot(turn: float, tank: float, wheel: float, track: float) -> float:
    length = math.sqrt(wheel**2 + 4 * track**2)
    return math.sqrt(
        length**2 - wheel**2 + 2 * (tank**2 + wheel * tank) * (math.cos(turn) - 1)
    )  # (33) corrected


@pytest.mark.parametrize("ratio", [7.5, 20.0, 500.0])
def test_the_corrected_pivot_keeps_its_distance(ratio: float) -> None:
    wheel, track = NUMBERS["wheel_radius"], NUMBERS["half_track"]
    tank = ratio * track
    for turn in np.linspace(0.0, 1.9 * track / (tank + wheel), 7):
        height = pivot(turn, tank, wheel, track)
        place = np.array([(tank + wheel) * math.cos(turn), (tank + wheel) * math.sin(turn), height])
        away = float(np.linalg.norm(place - np.array([tank, 0.0, 0.0])))
        assert away == pytest.approx(math.hypot(wheel, 2 * track), rel=1e-12)
    # In a plane, the circle of radius 2 b, where the print has an ellipse.
    assert pivot(0.06 / 1e4, 1e4, wheel, track) == pytest.approx(math.sqrt(4 * track**2 - 0.06**2), rel=1e-4)


@pytest.mark.parametrize(("ratio", "share"), [(20.0, 0.04), (200.0, 5e-3)])
def test_the_robot_pivots_as_the_reduced_solution_states(rolled: Maker, ratio: float, share: float) -> None:
    """With wheels like balls, for which (33) holds; its standing wheel shifts by a share of b / r_c."""
    wheel, track = NUMBERS["wheel_radius"], NUMBERS["half_track"]
    tank = ratio * track
    plant = rolled({"tank_radius": tank, "crown_radius": wheel, "start_heading": UP})
    height = 0.0
    for row in plant.driven(lambda _: 0.0, lambda _: 1.0, 4.0):
        turn = (row["arc_right"] - row["arc_left"]) / tank
        height = row["height_right"] - row["height_left"]
        if height > track:
            assert height == pytest.approx(pivot(turn, tank, wheel, track), abs=share * 2 * track)
    assert height > 1.5 * track
