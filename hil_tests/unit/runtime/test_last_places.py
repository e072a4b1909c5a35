"""The file in which the axes' places outlive the bridge: whole, rare, and never more than an offer."""

import json
from pathlib import Path

import pytest

from firmware_bridge.runtime.last_places import EVERY, LastPlaces, usual_path


def test_what_was_kept_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "deeper" / "rars.json"
    kept = LastPlaces(path)
    kept.keep({"lift": 0.2, "steer": -45.0}, 0)
    assert kept.file.settled() is None
    assert LastPlaces(path).read() == {"lift": 0.2, "steer": -45.0}
    assert [one.name for one in path.parent.iterdir()] == ["rars.json"], "nothing else is left there"


@pytest.mark.parametrize(
    "text", ["", "{", "[1.0]", "null", '{"lift": "up"}', '{"lift": NaN}', '{"lift": Infinity}', "\x00"]
)
def test_a_damaged_file_offers_nothing(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rars.json"
    path.write_text(text, encoding="utf-8")
    assert LastPlaces(path).read() == {}
    assert LastPlaces(tmp_path / "none.json").read() == {}


def test_it_is_written_when_something_has_changed_and_no_more_often_than_it_may(tmp_path: Path) -> None:
    kept = LastPlaces(tmp_path / "rars.json")

    def written() -> object:
        assert kept.file.settled() is None
        return json.loads(kept.path.read_text(encoding="utf-8"))

    kept.keep({"lift": 0.1}, 0)
    kept.keep({"lift": 0.2}, EVERY - 1)
    assert written() == {"lift": 0.1}
    kept.keep({"lift": 0.2}, EVERY)
    assert written() == {"lift": 0.2}
    kept.path.unlink()
    kept.keep({"lift": 0.2}, 3 * EVERY)
    assert kept.file.settled() is None
    assert not kept.path.exists(), "it is what was written last"


def test_no_places_make_no_file(tmp_path: Path) -> None:
    kept = LastPlaces(tmp_path / "rars.json")
    kept.keep({}, 0)
    assert kept.file.settled() is None
    assert list(tmp_path.iterdir()) == []


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = LastPlaces(tmp_path / "rars.json")
    kept.keep({"lift": 0.1}, 0)
    assert kept.file.settled() is None

    def broken(*_: object, **__: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", broken)
    kept.keep({"lift": 0.2}, EVERY)
    assert kept.file.settled() == f"{kept.path}: No space left on device"
    assert kept.read() == {"lift": 0.1}


def test_it_is_where_such_files_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert usual_path("rars") == tmp_path / "firmware-bridge" / "rars.json"
    monkeypatch.delenv("XDG_STATE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert usual_path("rars") == tmp_path / ".local" / "state" / "firmware-bridge" / "rars.json"
