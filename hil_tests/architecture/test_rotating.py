"""The rotating share: it covers the long lane, and what failed before a change is not the change's."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import rotating

from hil_tests.lanes import Share

ROOT = Path(__file__).parents[2]
MAKEFILE = f"long:\n\t@echo share $(SHARE)\n\t@{sys.executable} -m pytest -q\n"
GOOD, BAD = "def test_{}() -> None:\n    pass\n", "def test_{}() -> None:\n    assert False\n"


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "Makefile").write_text(MAKEFILE)
    git("init", "-q")
    return tmp_path


def git(*words: str) -> None:
    author = ("-c", "user.name=a", "-c", "user.email=a@b.example", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *author, *words], check=True, capture_output=True)  # noqa: S607


def commit(clone: Path, **tests: str) -> None:
    for name, text in tests.items():
        (clone / f"test_{name}.py").write_text(text.format(name))
    git("add", "-A")
    git("commit", "-q", "-m", "a change")


def test_each_test_is_in_one_share_and_all_are_about_as_large() -> None:
    shares = [Share.parse(f"{number}/16") for number in range(1, 17)]
    sizes = [0] * 16
    for name in (f"hil_tests/unit/test_some.py::test_{number}[case]" for number in range(4_000)):
        (holder,) = (number for number, share in enumerate(shares) if share.has(name))
        sizes[holder] += 1
    assert min(sizes) > 150


def test_pytest_runs_a_share_and_no_more(tmp_path: Path) -> None:
    (tmp_path / "test_many.py").write_text(
        "import pytest\n@pytest.mark.parametrize('n', range(40))\ndef test_it(n): pass\n"
    )
    counts = []
    for share in ("1/3", "2/3", "3/3"):
        # Below its own root a test has the same name in every run, and so the same share.
        words = ["-m", "pytest", "-q", "-p", "hil_tests.lanes", "--share", share]
        words += [f"--rootdir={tmp_path}", str(tmp_path)]
        ended = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True, check=True)
        (count,) = re.findall(r"(\d+) passed", ended.stdout)
        counts.append(int(count))
    assert sum(counts) == 40
    assert min(counts) > 5


@pytest.mark.parametrize("text", ["", "3", "0/4", "5/4", "1/0", "a/b", "-1/4"])
def test_what_is_no_share_is_refused(text: str) -> None:
    with pytest.raises(Exception, match="is no share: write K/N"):
        Share.parse(text)


def test_a_test_that_failed_on_the_parent_commit_is_named_and_does_not_count(
    clone: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    commit(clone, old=BAD, good=GOOD)
    commit(clone, another=GOOD)
    assert rotating.main() == 0
    assert "does not count: test_old.py::test_old" in capsys.readouterr().out
    assert not (clone / ".git" / "worktrees").exists() or not list((clone / ".git" / "worktrees").iterdir())


@pytest.mark.parametrize("there", [GOOD, None], ids=["it passed", "it was not there"])
def test_a_test_that_fails_with_this_commit_counts(
    clone: Path, capsys: pytest.CaptureFixture[str], there: str | None
) -> None:
    commit(clone, old=BAD, **({} if there is None else {"mine": there}))
    commit(clone, mine=BAD)
    assert rotating.main() == 1
    reported = capsys.readouterr().out
    assert "does not count: test_old.py::test_old" in reported
    assert "fails: test_mine.py::test_mine" in reported


def test_without_a_parent_commit_every_failure_counts(
    clone: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    commit(clone, old=BAD)
    assert rotating.main() == 1
    assert "fails: test_old.py::test_old" in capsys.readouterr().out


def test_what_fails_before_any_test_has_run_counts(clone: Path) -> None:
    commit(clone, good=GOOD)
    (clone / "Makefile").write_text("long:\n\t@false\n")
    assert rotating.main() != 0
