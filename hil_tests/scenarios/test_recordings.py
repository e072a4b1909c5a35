"""Every recording in `hil_tests/recordings` plays again without a difference; its README has the commands."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from emulators.replay import Into, ReplayOrder, replay
from firmware_bridge.robot_types import find
from firmware_bridge.units import MICROSECOND, from_seconds

FOLDER = Path(__file__).parents[1] / "recordings"
OPTIONS = {"into", "until", "tolerance_us", "without", "channel"}


def orders(folder: Path) -> Iterator[tuple[str, ReplayOrder]]:
    """Yield title and order of each replay that the files of a folder ask for."""
    files = [file for file in sorted(folder.glob("*/*")) if file.name.split(".")[1] in {"log", "tlog"}]
    by_name: dict[Path, dict[str, Path]] = {}
    for file in files:
        stem, kind = file.name.split(".")[:2]
        by_name.setdefault(file.parent / stem, {})[kind] = file
    for name, found in by_name.items():
        options = options_of(name.with_suffix(".toml"))
        log, tlog = found.get("log"), found.get("tlog")
        stages = [Into.DRIVES, *([Into.BRIDGE] if tlog else [])] if log else [Into.BENCH]
        for into in map(Into, options.get("into", stages)):
            until = options.get("until")
            yield (
                f"{name.parent.name} {name.name} into {into}",
                ReplayOrder(
                    find(name.parent.name),
                    log or tlog or name,
                    tlog if log and into is Into.BRIDGE else None,
                    into,
                    options.get("channel"),
                    None if until is None else from_seconds(until),
                    round(options.get("tolerance_us", 0.0) * MICROSECOND),
                    frozenset(options.get("without", ())),
                ),
            )


def options_of(file: Path) -> dict[str, Any]:
    options = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    assert set(options) <= OPTIONS, f"{file}: unknown options"
    return options


ALL = dict(orders(FOLDER))


@pytest.mark.parametrize("title", ALL)
def test_it_plays_again(title: str) -> None:
    outcome = replay(ALL[title])
    if outcome.difference is not None:
        pytest.fail(f"{title}: {outcome.difference}", pytrace=False)
    assert outcome.compared > 0


def test_every_file_is_found_and_taken_for_what_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "rars"
    folder.mkdir()
    for name in ("bus.log", "drive.log.gz", "drive.tlog", "pilot.tlog.xz"):
        (folder / name).touch()
    (folder / "bus.toml").write_text(
        'into = ["drives"]\ntolerance_us = 2.5\nuntil = 1.5\nwithout = ["pdo"]\n'
    )
    found = dict(orders(tmp_path))
    assert list(found) == [
        "rars bus into drives",
        "rars drive into drives",
        "rars drive into bridge",
        "rars pilot into bench",
    ]
    bus, _, both, pilot = found.values()
    assert (bus.tolerance, bus.until, bus.without) == (2_500, 1_500_000_000, frozenset({"pdo"}))
    assert (both.recording.name, both.operator) == ("drive.log.gz", folder / "drive.tlog")
    assert pilot.recording.name == "pilot.tlog.xz"


def test_what_is_not_a_recording_is_explained() -> None:
    kinds = {".log", ".tlog", ".toml"}
    assert all(kinds & set(file.suffixes) for file in FOLDER.glob("*/*")), "see the README there"
