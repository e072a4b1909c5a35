"""A campaign's file: its mistakes, all at once, each with the key; what the runs are made of."""

from pathlib import Path
from typing import Any

import pytest

from emulators.bench.toml_text import as_toml
from emulators.campaign.campaign_file import CampaignError, load, parse
from emulators.campaign.plan import order_of, plan, texts_of
from hil_tests.campaign.campaigns import CAMPAIGN, MISSION, written

DELAY = {"path": "link.delay", "least": 0.0, "most": 0.4}

WRONG: list[tuple[dict[str, Any], str]] = [
    ({"robots": None}, "robots: is missing"),
    ({"robotz": ["rars"]}, "robotz: no such key; perhaps 'robots'?"),
    ({"parameter": [{"path": "plane.slope", "values": [1]}]}, "parameter[0].path"),
    ({"parameter": [{"path": "plant.slope"}]}, "needs either `values`, or `least` and `most`"),
    ({"parameter": [{"path": "plant.slope", "values": []}]}, "`values` is empty"),
    ({"parameter": [{"path": "plant.slope", "least": 1.0, "most": 1.0}]}, "needs `least` below `most`"),
    ({"parameter": [{**DELAY, "log": True}]}, "an even logarithm needs `least` above 0"),
    ({"parameter": [DELAY, DELAY]}, "given twice: link.delay"),
    ({"sample": "random"}, "`samples` goes with sample = random, latin_hypercube, sobol"),
    ({"samples": 3}, "`samples` goes with sample = random, latin_hypercube, sobol"),
    ({"seeds": [1, 1]}, "seeds are different numbers from 0 on"),
    ({"require": [{"key": "path_length_m"}]}, "`least`, `most` or both go with `key`"),
    ({"require": [{"never": "base slips", "most": 1.0}]}, "`least`, `most` or both go with `key`"),
    ({"require": [{}]}, "needs one of `key`, `never` and `always`"),
]


@pytest.mark.parametrize(("change", "message"), WRONG)
def test_a_wrong_key_is_named(change: dict[str, Any], message: str) -> None:
    table = {key: value for key, value in (CAMPAIGN | change).items() if value is not None}
    with pytest.raises(CampaignError) as refused:
        parse(as_toml(table), "floors.toml")
    assert message in str(refused.value)
    assert str(refused.value).startswith("floors.toml: ")


def test_a_file_that_is_missing_is_one_line() -> None:
    with pytest.raises(CampaignError, match=r"floors.toml: cannot be read"):
        load(Path("nowhere/floors.toml"))


UNFIT: list[tuple[dict[str, Any], str]] = [
    ({"robots": ["rarz"]}, "robots[0]: rarz: no such robot; perhaps 'rars'?"),
    ({"missions": ["shorter"]}, "missions[0]: for rars: shorter: rars has no such mission; there are"),
    ({"missions": ["absent.toml"]}, "missions[0]: for rars: absent.toml: cannot be read"),
    ({"protocols": ["v9"]}, "robots[0]"),
    ({"faults": [{"kind": "bus_silentt", "at_s": 2.0}]}, "faults: for rars, short.toml"),
    ({"parameter": [{"path": "mission.noise.stik", "values": [0.1]}]}, "parameter 'mission.noise.stik'"),
    ({"parameter": [{"path": "mission.step[9].at_s", "values": [0.1]}]}, "no such table or row on the way"),
    ({"parameter": [{"path": "robot.axes.lefd.ratio", "values": [26]}]}, "no such table or row on the way"),
    ({"parameter": [{"path": "link.dellay", "values": [0.1]}]}, "parameter 'link.dellay'"),
    ({"parameter": [{"path": "plant.floor", "values": [0.1]}]}, "parameter 'plant.floor'"),
    (
        {"require": [{"never": "axis timeout"}]},
        "require[0].never: rars has no interlock 'axis timeout'; perhaps",
    ),
    ({"require": [{"always": "stale"}]}, "require[0].always: rars has no interlock 'stale'"),
    (
        {"parameter": [{"path": "robot.axes.left.ratio", "values": [26.0, -1.0]}]},
        "parameter 'robot.axes.left.ratio'",
    ),
]


@pytest.mark.parametrize(("change", "message"), UNFIT)
def test_what_does_not_fit_is_named_before_anything_is_driven(
    change: dict[str, Any], message: str, tmp_path: Path
) -> None:
    file = written(tmp_path, **change)
    with pytest.raises(CampaignError) as refused:
        plan(load(file), "floors.toml", tmp_path)
    assert message in str(refused.value)


def test_two_mistakes_are_two_lines(tmp_path: Path) -> None:
    file = written(tmp_path, robots=["rarz", "romee"])
    with pytest.raises(CampaignError) as refused:
        plan(load(file), "floors.toml", tmp_path)
    assert len(str(refused.value).splitlines()) == 2


def test_a_grid_is_every_value_with_every_other(tmp_path: Path) -> None:
    made = plan(load(written(tmp_path)), "floors.toml", tmp_path)
    assert [run.number for run in made.runs] == list(range(12))
    keys = [(run.values["plant.floor_friction"], run.values["link.delay"], run.seed) for run in made.runs]
    assert keys == [(mu, delay, seed) for mu in (0.2, 0.6) for delay in (0.0, 0.2, 0.4) for seed in (0, 1)]


def test_the_values_reach_robot_mission_plant_and_link(tmp_path: Path) -> None:
    rows = [
        {"path": "plant.slope", "values": [0.05]},
        {"path": "mission.step[2].speed_mps", "values": [0.1]},
        {"path": "mission.noise.stick", "values": [0.01]},
        {"path": "robot.axes.left.top_speed", "values": [15.0]},
        {"path": "link.up.loss", "values": [0.02]},
    ]
    file = written(
        tmp_path, parameter=rows, seeds=[7], faults=[{"kind": "node_silent", "node": "left", "at_s": 3.0}]
    )
    (run,) = plan(load(file), "floors.toml", tmp_path).runs
    order = order_of(run)
    assert order.seed == 7
    assert order.mission.plant == {"slope": 0.05}
    assert order.mission.step[2].model_dump()["speed_mps"] == 0.1
    assert order.mission.noise.stick == 0.01
    assert order.mission.conditions.up.loss == 0.02
    assert [fault.kind for fault in order.mission.fault] == ["node_silent"]
    assert next(axis for axis in order.robot.axes if axis.name == "left").top_speed == 15.0
    robot, mission = texts_of(run)
    assert "top_speed = 15.0" in robot
    assert "node_silent" in mission


def test_a_condition_of_the_mission_s_own_link_is_replaced(tmp_path: Path) -> None:
    file = written(tmp_path, parameter=[{"path": "link.jitter", "values": [0.03]}], seeds=1)
    (tmp_path / "short.toml").write_text(
        as_toml(MISSION | {"link": "delay=0.2, jitter=0.01"}), encoding="utf-8"
    )
    (run,) = plan(load(file), "floors.toml", tmp_path).runs
    conditions = order_of(run).mission.conditions
    assert (conditions.up.delay, conditions.up.jitter) == (100_000_000, 30_000_000)


def test_every_failure_of_a_robot_is_a_run(tmp_path: Path) -> None:
    file = written(tmp_path, parameter=[], seeds=1, faults={"all_at_s": 3.0, "for_s": 1.0})
    made = plan(load(file), "floors.toml", tmp_path)
    titles = {run.case.fault for run in made.runs}
    assert len(titles) == len(made.runs) > 100
    assert all(row["at_s"] == 3.0 for run in made.runs for row in run.case.faults)


@pytest.mark.parametrize("sample", ["random", "latin_hypercube", "sobol"])
def test_draws_stay_within_the_ranges_and_come_again(sample: str, tmp_path: Path) -> None:
    rows = [DELAY, {"path": "plant.floor_friction", "least": 0.1, "most": 1.0, "log": True}]
    file = written(tmp_path, parameter=rows, sample=sample, samples=20, seeds=1)
    first, second = (plan(load(file), "floors.toml", tmp_path) for _ in range(2))
    assert first.sha256 == second.sha256
    delays = sorted(run.values["link.delay"] for run in first.runs)
    assert len(delays) == 20
    assert 0.0 <= delays[0] < delays[-1] <= 0.4
    assert all(0.1 <= run.values["plant.floor_friction"] <= 1.0 for run in first.runs)
    if sample == "latin_hypercube":
        # One in each twentieth.
        assert [int(delay / 0.02) for delay in delays] == list(range(20))
    other = plan(
        load(written(tmp_path, parameter=rows, sample=sample, samples=20, seeds=1, draw_seed=1)), "", tmp_path
    )
    assert other.sha256 != first.sha256


def test_another_requirement_is_another_campaign(tmp_path: Path) -> None:
    first = plan(load(written(tmp_path)), "", tmp_path)
    second = plan(load(written(tmp_path, require=[{"never": "emergency stop"}])), "", tmp_path)
    assert first.sha256 != second.sha256
