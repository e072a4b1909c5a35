"""A robot package and a recording of the release before: they install, drive and play again."""

import os
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import Final

import pytest

FOLDER: Final = Path(__file__).parent
PACKAGE: Final = FOLDER / "carrier-0.1.0.tar.gz"
RECORDING: Final = FOLDER / "carrier-interlocks"
PROGRAM: Final = ("-c", "from firmware_bridge.cli import main; main()")
OFFLINE: Final = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check", "--quiet")


class Site:
    """A folder with the package installed in it, before what this checkout has under the same name."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with tarfile.open(PACKAGE) as package:
            package.extractall(folder, filter="data")
        self._site = folder / "site"
        self.run("-m", "pip", "install", *OFFLINE, "--target", str(self._site), "./carrier")

    def run(self, *words: str) -> str:
        done = subprocess.run(
            [sys.executable, "-P", *words],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self._site), "NO_COLOR": "1"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    return Site(tmp_path_factory.mktemp("before"))


def test_its_recording_plays_again(site: Site) -> None:
    shown = site.run(*PROGRAM, "replay", str(RECORDING), "carrier")
    assert "no difference" in shown
    assert "all is compared but STATUSTEXT" in shown


@pytest.mark.long(beside="test_its_recording_plays_again")
def test_it_passes_its_own_tests(site: Site) -> None:
    where = site.run("-c", "import carrier; print(carrier.__file__)")
    assert str(site.folder) in where
    assert " passed" in site.run("-m", "pytest", "-q", "-p", "no:cacheprovider", "carrier/tests")


@pytest.mark.long(beside="test_its_recording_plays_again")
def test_it_passes_the_tests_of_every_robot(site: Site) -> None:
    inherited = ("--robot", "carrier", "--pyargs", "emulators.testing.inherited")
    assert " passed" in site.run("-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", *inherited)
