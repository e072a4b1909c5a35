# ruff: noqa: INP001 - a script, not a package
"""Run a share of the long lane that the newest commit chooses: some days of commits run all of it.

`python tools/rotating.py` runs `make long SHARE=K/N`. A test that fails is run again on the parent commit, in
a worktree, where the clone has one: what fails there as well is named and does not count.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from nights import SHARES

RUN_AGAIN_UP_TO: Final = 20
"""Failing tests: more are no accident of one share."""
FAILED: Final = Path(".pytest_cache/v/cache/lastfailed")
NATIVE: Final = Path("emulators/servo/libservo.so")
"""Library built from the sources, and in no commit; it checks itself if it fits them."""


def say(text: str) -> None:
    """Show the user at once."""
    sys.stdout.write(f"rotating: {text}\n")
    sys.stdout.flush()


def git(*words: str) -> str | None:
    """Return what git prints; None where it fails."""
    done = subprocess.run(["git", *words], capture_output=True, text=True, check=False)  # noqa: S603, S607
    return done.stdout.strip() if done.returncode == 0 else None


def failed() -> list[str]:
    """Return the names of the tests that failed, as pytest has kept them."""
    return sorted(json.loads(FAILED.read_text(encoding="utf-8"))) if FAILED.exists() else []


@contextmanager
def checkout(commit: str) -> Iterator[Path]:
    """Give a worktree of a commit for so long."""
    with tempfile.TemporaryDirectory(prefix="parent-") as folder:
        place = Path(folder, "checkout")
        git("worktree", "add", "--quiet", "--detach", str(place), commit)
        try:
            if NATIVE.exists() and (place / NATIVE.parent).is_dir():
                shutil.copy(NATIVE, place / NATIVE)
            yield place
        finally:
            git("worktree", "remove", "--force", str(place))


def fails(test: str, place: Path) -> bool:
    """Return whether a test is there, in a checkout, and fails."""
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", test]
    environment = {**os.environ, "PYTHONPATH": str(place)}
    done = subprocess.run(words, cwd=place, env=environment, capture_output=True, check=False)  # noqa: S603
    return done.returncode == 1


def new(red: list[str]) -> list[str]:
    """Return which of the failing tests do not fail on the parent commit; all, where it is not known."""
    parent = git("rev-parse", "--verify", "--quiet", "HEAD^")
    if parent is None or len(red) > RUN_AGAIN_UP_TO:
        return red
    say(f"{len(red)} failed; again on the parent commit {parent[:12]}")
    with checkout(parent) as place:
        old = [test for test in red if fails(test, place)]
    for test in old:
        say(f"fails on the parent commit as well, and does not count: {test}")
    return [test for test in red if test not in old]


def main() -> int:
    """Run the share; return the exit status."""
    commit = git("rev-parse", "HEAD") or "0"
    share = f"{int(commit, 16) % SHARES + 1}/{SHARES}"
    say(f"share {share} of the long lane, chosen by the commit {commit[:12]}: make long SHARE={share}")
    FAILED.unlink(missing_ok=True)
    status = subprocess.run(["make", "long", f"SHARE={share}"], check=False).returncode  # noqa: S603, S607
    red = failed()
    if status == 0 or not red:
        return status
    left = new(red)
    for test in left:
        say(f"fails: {test}")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
