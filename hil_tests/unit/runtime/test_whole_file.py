"""A small file on a disk that takes nothing for a while: a pipe that no one reads stands for it."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware_bridge.runtime.whole_file import STALLS, WholeFile


@pytest.fixture
def stalled(tmp_path: Path) -> Iterator[tuple[WholeFile, Path]]:
    """A file whose first text the disk does not take."""
    file = WholeFile(tmp_path / "places.json")
    fresh = tmp_path / f"places.json.{os.getpid()}"
    os.mkfifo(fresh)
    file.replace("first", 1000)
    yield file, fresh
    if fresh.exists():
        fresh.read_bytes()
    file.settled()


def test_who_keeps_something_is_not_held_up_and_receives_of_it(stalled: tuple[WholeFile, Path]) -> None:
    file, _ = stalled
    file.replace("second", 2000)
    assert file.problem(1000 + STALLS - 1) is None
    assert file.problem(1000 + STALLS) == f"{file.path}: the disk takes nothing for 5 s"
    assert file.settled(0.01) == f"{file.path}: the disk takes nothing within 0.01 s"


def test_when_the_disk_takes_it_the_newest_text_is_there(stalled: tuple[WholeFile, Path]) -> None:
    file, fresh = stalled
    for text in ("second", "third"):
        file.replace(text, 2000)
    assert fresh.read_bytes() == b"first"
    assert file.settled() is None
    assert file.path.read_text(encoding="utf-8") == "third"
    assert file.problem(1000 + STALLS) is None


def test_the_same_text_is_not_written_again_unless_that_failed(tmp_path: Path) -> None:
    file = WholeFile(tmp_path / "deeper" / "places.json")
    (tmp_path / "deeper").write_text("", encoding="utf-8")
    file.replace("text", 0)
    assert file.settled() == f"{file.path}: File exists"
    (tmp_path / "deeper").unlink()
    file.replace("text", 0)
    assert file.settled() is None
    file.path.unlink()
    file.replace("text", 0)
    assert file.settled() is None
    assert not file.path.exists()
    assert list(file.path.parent.iterdir()) == [], "nothing else is left there"
