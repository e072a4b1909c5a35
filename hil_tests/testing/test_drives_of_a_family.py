"""`drives` of a family: what is started, and what is refused before anything is."""

import re
from collections.abc import Sequence
from pathlib import Path
from unittest import SkipTest

import pytest

from emulators.testing.buses import Bus
from emulators.testing.emulated import Drives
from emulators.testing.errors import RigError
from emulators.testing.process import Process
from emulators.testing.real import RealDrives


class StartedError(Exception):
    """The words of a program that would be started now."""


def start(words: Sequence[str]) -> Process:
    raise StartedError(*words)


@pytest.mark.parametrize(
    ("family", "stated"),
    [
        ("cia401", "drives of 'cia401': perhaps 'cia402'?"),
        ("motor_shield", "drives of 'motor_shield': there are: cia402, epos2"),
        ("cia402", "drives of cia402 have no serial line: put them on a bus, on=bus()"),
    ],
)
def test_what_is_no_drive_on_a_line_is_refused(tmp_path: Path, family: str, stated: str) -> None:
    with pytest.raises(RigError, match=re.escape(stated)):
        Drives(start, tmp_path)("3", family=family)


@pytest.mark.parametrize(("family", "word"), [(None, "epos2"), ("epos2", "epos2")])
def test_a_drive_with_a_line_is_the_default(tmp_path: Path, family: str | None, word: str) -> None:
    with pytest.raises(StartedError) as started:
        Drives(start, tmp_path)("3", "--load", "2e-5,0.001", family=family)
    assert started.value.args[:6] == ("emulate", word, "--node", "3", "--load", "2e-5,0.001")


def test_real_drives_without_a_line_are_skipped() -> None:
    with pytest.raises(SkipTest, match="real drives are not found here as cia402"):
        RealDrives(start, None, moved=False)("3", on=Bus("socketcan", "can0"), family="cia402")
