"""Mission files: the shipped ones, and each way to get one wrong."""

from pathlib import Path

import pytest

from emulators.bench import mission as missions
from emulators.bench.mission import Mission, MissionFileError
from emulators.bench.step import Input
from emulators.robots.rars import BENCH_SETUP, RarsStep
from hil_tests.unit.bench_operator.joined import RARS, find, parse

HEAD = 'title = "t"\nduration_s = 10.0\n'
ARM = "arm = true"
STEP = '[[step]]\nat_s = 1.0\ntitle = "s"\n'
LATE_PILOT = '[pilot]\npath = "line"\nbegins_s = 10.0\n'


def refusal(text: str) -> str:
    with pytest.raises(MissionFileError) as caught:
        parse(text, "my.toml")
    return str(caught.value)


def steps(mission: Mission) -> list[RarsStep]:
    return [step for step in mission.step if isinstance(step, RarsStep)]


def test_eleven_missions_are_shipped() -> None:
    assert list(BENCH_SETUP.shipped()) == [
        "circles", "faults", "interlocks", "left_failed", "line", "pursuit", "steering_failed", "stuck",
        "survey", "thesis", "video",
    ]  # fmt: skip


def test_line_is_the_line_of_the_thesis() -> None:
    mission = find("line")
    up, down = (step for step in steps(mission) if step.ramp_mps2 is not None)
    assert (up.speed_mps, up.ramp_mps2, down.speed_mps, down.ramp_mps2) == (0.24, 0.024, 0.0, 0.024)
    assert mission.duration_s - down.at_s > 0.24 / 0.024
    assert mission.noise.stick == 0.0


def test_circles_change_the_radius_at_125_s() -> None:
    mission = find("circles")
    first, second = (step for step in steps(mission) if step.radius_m is not None)
    assert second.at_s == 125.0
    # The thesis's yaw rate steps down there: the second circle is the larger one.
    assert (first.radius_m, second.radius_m) == (1.0, 1.5)
    assert {step.speed_mps for step in steps(mission)} >= {0.3, 0.0}
    assert mission.noise.stick > 0.0
    assert mission.duration_s == 250.0


def test_interlocks_gives_each_attempt_a_title() -> None:
    mission = find("interlocks")
    assert mission.input is Input.TWIST
    assert len(mission.step) > 50
    assert all(step.title for step in mission.step)


def test_faults_gives_each_of_them_a_title_and_most_of_them_an_end() -> None:
    mission = find("faults")
    assert len({fault.kind for fault in mission.fault}) > 15
    assert all(fault.title for fault in mission.fault)
    assert {fault.kind for fault in mission.fault if fault.end == fault.begin} == {"nmt_foreign_node"}


def test_a_mission_is_a_few_lines() -> None:
    mission = parse(HEAD + STEP + "speed_mps = 0.2\nradius_m = -0.8\n", "my.toml")
    assert (mission.send_hz, mission.input, mission.noise.loss) == (20, Input.STICK, 0.0)
    assert steps(mission)[0].radius_m == -0.8


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("x = ", "not valid TOML"),
        ("", "title: is missing"),
        ('title = "t"\n' + STEP + "arm = true", "duration_s: is missing"),
        (HEAD, "step: is missing"),
        (HEAD + "step = []", "step: "),
        (HEAD + "speed = 1\n" + STEP + "arm = true", "speed: no such key; there are 14"),
        (HEAD + STEP + "sped_mps = 0.1", "step[0].sped_mps: no such key; perhaps 'speed_mps'?"),
        (
            HEAD + STEP + "arm = true" + "\n[noise]\njiter_ms = 1.0",
            "noise.jiter_ms: no such key; perhaps 'jitter_ms'?",
        ),
        (HEAD + STEP + 'speed_mps = "fast"', "step[0].speed_mps: "),
        (HEAD + STEP + "speed_mps = nan", "step[0].speed_mps: "),
        (HEAD + STEP + "arm = false", "step[0].arm: "),
        (HEAD + STEP, "step[0]: the step does nothing"),
        (HEAD + STEP + "ramp_mps2 = 0.1", "step[0]: the step does nothing"),
        (HEAD + STEP + "arm = true\nramp_mps2 = 0.1", "step[0]: ramp_mps2 needs speed_mps"),
        (HEAD + STEP + "speed_mps = 0.1\nramp_mps2 = 0", "step[0].ramp_mps2: "),
        (HEAD + STEP + "steer_deg = 90.0", "step[0].steer_deg: "),
        (HEAD + STEP + "steer_deg = 9.0\nradius_m = 1.0", "step[0]: steer_deg and radius_m set the same"),
        (HEAD + STEP + "radius_m = 0.0", "step[0]: radius_m must not be 0"),
        (HEAD + STEP + "silent_s = 0", "step[0].silent_s: "),
        (HEAD + STEP + 'stray = "nonsense"', "step[0].stray: "),
        (HEAD + STEP + 'press = "horn"', "step[0].press: "),
        (HEAD + 'input = "mouse"\n' + STEP + "arm = true", "input: "),
        (HEAD + STEP + "arm = true\n[noise]\nloss = 1.1", "noise.loss: "),
        (HEAD + STEP.replace("1.0", "-1.0") + "arm = true", "step[0].at_s: "),
        (HEAD + STEP.replace("1.0", "10.0") + "arm = true", "step 's' is not before the end"),
        (HEAD + LATE_PILOT + STEP + "arm = true", "pilot.begins_s = 10 is not before the end"),
        (
            HEAD + STEP + "arm = true\n" + STEP.replace("1.0", "0.9") + "arm = true",
            "step 's' at 0.9 s stands behind",
        ),
        (HEAD + STEP + "speed_mps = 0.51", "step[0].speed_mps: 's' is beyond full stick"),
        (HEAD + STEP + "steer_deg = -60.1", "step[0].steer_deg: 's' is beyond full stick"),
        (HEAD + STEP + "radius_m = 0.4", "step[0].radius_m: 's' is beyond full stick"),
        (HEAD + STEP + "lift_rate_mps = 0.11", "step[0].lift_rate_mps: 's' is beyond full stick"),
        (HEAD + 'input = "twist"\n' + STEP + 'press = "headlamp"', "step[0].press: 's' needs the stick"),
        (
            HEAD + 'input = "twist"\n' + STEP + "lift_rate_mps = 0.1",
            "step[0].lift_rate_mps: 's' needs the stick",
        ),
    ],
)
def test_a_wrong_mission_is_refused_with_file_and_key(text: str, complaint: str) -> None:
    assert refusal(text).startswith(f"my.toml: {complaint}")


@pytest.mark.parametrize(
    "step", ["speed_mps = 0.5", "speed_mps = -0.5", "steer_deg = 60.0", "lift_rate_mps = -0.1"]
)
def test_full_stick_is_allowed(step: str) -> None:
    assert parse(HEAD + STEP + step, "my.toml").step


def test_a_twist_may_ask_for_anything() -> None:
    assert parse(HEAD + 'input = "twist"\n' + STEP + "speed_mps = 9.0\nsteer_deg = 89.0", "my.toml").step


def test_the_input_may_change_on_the_way() -> None:
    later = STEP.replace("1.0", "2.0")
    text = HEAD + STEP + 'input = "twist"\nspeed_mps = 0.8\n' + later + 'input = "stick"\nspeed_mps = 0.5\n'
    assert parse(text, "my.toml").step[1].input is Input.STICK
    assert "step[1].speed_mps" in refusal(text.replace("0.5\n", "0.6\n"))


def test_a_mission_that_is_not_there_names_those_that_are() -> None:
    with pytest.raises(MissionFileError, match=r"^lines: no such mission of rars; perhaps 'line'\?"):
        find("lines")


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    missing = tmp_path / "none.toml"
    with pytest.raises(MissionFileError, match=r"none\.toml: cannot be read"):
        find(str(missing))
    missing.write_bytes(b"\xff\xfe")
    with pytest.raises(MissionFileError, match=r"none\.toml: cannot be read"):
        missions.load(missing, RARS, BENCH_SETUP)


def test_a_mission_of_ones_own_is_found_by_its_path(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text(HEAD + STEP + "arm = true\n", encoding="utf-8")
    assert find(str(own)).step[0].arm is True
