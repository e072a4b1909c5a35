"""The plugin as its users have it: pytest within pytest, on stories of theirs."""

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.testing.conftest import Imported

pytest_plugins = ["pytester"]

PLUGIN = "emulators.testing.plugin"
PROJECT = Path(__file__).parents[2] / "pyproject.toml"
PAGE = PROJECT.with_name("docs") / "testing.md"
BLOCKS = {
    re.findall(r"^def (test_\w+)", block, flags=re.MULTILINE)[0]: block
    for block in re.findall(
        r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
    )
}
"""Examples by the name of the first test in each."""
IN_REAL_TIME = ("test_a_master_of_my_own", "test_both_are_found", "test_a_client_in_ros_manner")

STORIES = """
    import pytest

    def test_begins_where_the_first_test_began(rig, recording):
        assert rig.interlock_events == {}
        assert rig.body.speed == pytest.approx(0.0, abs=1e-3)
        assert rig.operator.texts[-1] == "armed"
        assert rig.now < 3.1

    def test_a_fault(rig, fault, recording):
        rig.operator.drives(forward=0.3)
        rig.runs(2)
        before = len(recording.frames)
        fault("frame_loss")
        rig.runs(1)
        assert len(recording.frames) < before + 40
        assert any(name.startswith("axis timeout") for name in rig.interlock_events)

    @pytest.mark.robot("rome")
    @pytest.mark.seeds(2)
    def test_with_seeds(rig, rig_seed):
        assert rig.seed == rig_seed

    @pytest.mark.robot("rars", "rome")
    def test_with_robots(rig, rig_robot):
        assert rig.robot.name == rig_robot

    @pytest.mark.needs("a moon")
    def test_needs_what_nobody_knows():
        pass
"""


Run = Callable[..., pytest.RunResult]


@pytest.fixture
def run(imported: Imported, pytester: pytest.Pytester, home: None) -> Run:
    del home

    def within(*args: str) -> pytest.RunResult:
        words = ("-p", PLUGIN, "-p", "no:cacheprovider", "--late-after=0", *args)
        return pytester.runpytest_inprocess(*words, plugins=[imported])

    return within


def test_the_stories_of_the_page_and_others(pytester: pytest.Pytester, run: Run) -> None:
    blocks = {name: block for name, block in BLOCKS.items() if name not in IN_REAL_TIME}
    pytester.makepyfile(test_others=STORIES, **blocks)
    result = run("--robot", "rars", "--junitxml=j.xml", "--strict-markers", "--seed", "7")
    result.assert_outcomes(passed=5 + 6, errors=1)
    result.stdout.fnmatch_lines("*needs('a moon'): there are vcan, cc*")
    report = (pytester.path / "j.xml").read_text(encoding="utf-8")
    assert '<property name="robot" value="rome"' in report
    assert '<property name="seed" value="8"' in report


def test_a_failing_test_states_what_held_and_keeps_what_happened(pytester: pytest.Pytester, run: Run) -> None:
    pytester.makeini("[pytest]\nrig_robot = rars")
    pytester.makepyfile(test_it=BLOCKS["test_silence"].replace('"operator link timeout"', '"boredom"'))
    result = run("--kept", "left", "--seed", "3", "--no-pictures", "--report-page", "new/page.html")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            "rars, seed 3, at 6.01 s of virtual time",
            "*operator link timeout: no motion command for 0.50 s, limit 0.50 s",
            "*step: falls silent",
            "kept in left/test_it.py-test_silence: can.log, operator.tlog, samples.csv",
        ]
    )
    assert "again: pytest test_it.py::test_silence --seed 3" in result.outlines
    assert "page: new/page.html" in result.outlines
    page = (pytester.path / "new" / "page.html").read_text(encoding="utf-8")
    assert "again: <code>pytest test_it.py::test_silence --seed 3</code>" in page
    assert "operator link timeout: no motion command for 0.50 s, limit 0.50 s" in page
    assert "assert &#x27;boredom&#x27; in" in page
    (folder,) = (pytester.path / "left").iterdir()
    assert " drives 701#00\n" in (folder / "can.log").read_text(encoding="ascii")
    assert (folder / "samples.csv").read_text(encoding="ascii").count("\n") == 1 + 602


def test_a_fault_of_a_motor_that_stood_states_that_it_could_not_show(
    pytester: pytest.Pytester, run: Run
) -> None:
    pytester.makepyfile(
        test_it="""
def test_dead_encoder(rig):
    rig.fault("encoder_cable_off", node="one", for_s=0.5)
    rig.runs(1.0)
    rig.operator.drives(0.2)
    rig.fault("motor_cable_off", node="two", for_s=0.5)
    rig.runs(1.0)
    assert all(hold.began_s == hold.began / 1e9 for hold in rig.interlock_history)
    assert "position not changing: one" in rig.interlock_events
"""
    )
    result = run("--robot", "rome", "--no-pictures")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["*encoder_cable_off (one); it could not show: its motor stood all that time"]
    )
    assert not any("motor_cable_off" in line and "could not show" in line for line in result.outlines)


@pytest.mark.interpreted
@pytest.mark.long(beside="test_one_that_ends_too_soon_states_what_it_printed")
@pytest.mark.parametrize(
    ("story", "bus"),
    [
        ("test_a_master_of_my_own", "vcan"),
        ("test_a_client_in_ros_manner", "vcan"),
        pytest.param("test_both_are_found", "vcan", marks=pytest.mark.vcan),
        pytest.param("test_both_are_found", "loopback_multicast", marks=pytest.mark.alone),
    ],
)
def test_the_stories_of_the_page_in_real_time(
    story: str, bus: str, pytester: pytest.Pytester, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    pytester.makepyfile(BLOCKS[story])
    run("--bus", bus).assert_outcomes(passed=1)


@pytest.mark.long(beside="test_a_failing_test_states_what_held_and_keeps_what_happened")
def test_a_failing_test_leaves_pictures(pytester: pytest.Pytester, run: Run) -> None:
    pytester.makepyfile(test_it="def test_nothing(rig):\n    rig.runs(0.5)\n    assert not rig.now")
    run("--robot", "rome", "--report-page", "page.html")
    shown = (pytester.path / "page.html").read_text(encoding="utf-8").count('src="data:image/png;base64,')
    assert shown == len(list(pytester.path.glob("out/tests/*/*.png")))
    pictures = {path.stem for path in pytester.path.glob("out/tests/*/*.png")}
    assert {"path", "speeds", "currents", "interlocks"} <= pictures


def test_a_story_for_no_robot_and_one_that_cannot_be_reported(pytester: pytest.Pytester, run: Run) -> None:
    pytester.makepyfile(
        """
        import pytest

        def test_nobody(rig):
            pass

        @pytest.mark.robot("rome")
        def test_wings(rig):
            rig.body.wings
        """
    )
    result = run()
    result.assert_outcomes(failed=1, errors=1)
    result.stdout.fnmatch_lines(
        ["which robot? Give --robot NAME*", "*RigError: rome has no 'wings'; it has x_m*"]
    )
    result.stdout.no_fnmatch_line("kept in*")


def test_a_client_that_does_not_use_it_does_not_wait_for_it() -> None:
    entries = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["entry-points"]["pytest11"]
    assert entries == {PLUGIN: PLUGIN}
    program = f"import sys, pytest, {PLUGIN}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    heavy = {"numpy", "pydantic", "can", "emulators.rig", "firmware_bridge"}
    assert heavy & set(loaded.stdout.split()) == set()
