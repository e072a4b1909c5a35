"""A night: what has passed on the same sources does not run again, whatever ended the last one."""

import subprocess
import sys
from pathlib import Path

import nightly
import nights
import pytest
from nights import Step

STEPS = (
    Step(
        "first", "two commands", ("echo a >> ran; echo '=== 3 passed in 1 s ==='", "echo b >> ran; echo done")
    ),
    Step("second", "one that fails", ("echo c >> ran; echo no; false",)),
)


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for module in (nightly, nights):
        monkeypatch.setattr(module, "STEPS", STEPS)
    monkeypatch.setattr(nightly, "ROOT", tmp_path)
    monkeypatch.setattr(nights, "OUTCOMES", tmp_path / "tools" / "nightly_results.toml")
    monkeypatch.setattr("nightly_page.write", lambda: None)
    monkeypatch.setattr("os.nice", lambda _: 0)
    monkeypatch.setattr("sys.argv", ["nightly"])
    (tmp_path / "tools").mkdir()
    git(tmp_path, "init", "-q")
    commit(tmp_path)
    return tmp_path


def git(place: Path, *words: str) -> None:
    author = ("-c", "user.name=a", "-c", "user.email=a@b.example", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *author, *words], cwd=place, check=True, capture_output=True)  # noqa: S607


def commit(place: Path, source: str = "1") -> None:
    (place / "source").write_text(source)
    git(place, "add", "source", "tools")
    git(place, "commit", "-q", "-m", "a change")


def ran(place: Path) -> str:
    return (place / "ran").read_text().replace("\n", "")


def test_what_has_passed_does_not_run_again_and_what_failed_does(place: Path) -> None:
    assert nightly.main() == 1
    assert nightly.main() == 1
    assert ran(place) == "abcc"
    outcomes = nights.read()
    assert [outcomes[it].passed for step in STEPS for it in step.commands] == [True, True, False]
    assert [outcomes[it].result for step in STEPS for it in step.commands] == [
        "3 passed in 1 s",
        "done",
        "no",
    ]


def test_a_commit_of_results_alone_changes_nothing_and_one_of_sources_everything(place: Path) -> None:
    nightly.main()
    commit(place, "1")
    nightly.main()
    assert ran(place) == "abcc"
    commit(place, "2")
    nightly.main()
    assert ran(place) == "abccabc"


def test_a_night_that_is_killed_keeps_what_had_passed(place: Path) -> None:
    killed = (STEPS[0].commands[0], "echo x >> ran; kill -9 $PPID")
    script = f"""
import sys; sys.path.insert(0, {str(Path(nights.__file__).parent)!r})
import nightly, nights, nightly_page
from pathlib import Path
nights.STEPS = nightly.STEPS = (nights.Step("first", "", {killed!r}),)
nightly.ROOT, nights.OUTCOMES = Path("."), Path("tools/nightly_results.toml")
nightly_page.write = lambda: None
nightly.main()
"""
    ended = subprocess.run([sys.executable, "-c", script], cwd=place, capture_output=True, check=False)
    assert ended.returncode == -9
    nightly.main()
    assert ran(place) == "axbc"


def test_a_result_is_of_a_commit(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "source").write_text("changed")
    assert nightly.main() == 2
    assert "commit first, or put away: source" in capsys.readouterr().out
    assert not (place / "ran").exists()
