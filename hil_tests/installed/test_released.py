"""The result of `make wheels`, to be published."""

import json
import re
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from hil_tests.installed.files import ROOT, difference, tracked

pytestmark = pytest.mark.released

DIST = ROOT / "dist"
PAGE = (ROOT / "docs" / "installing.md").read_text(encoding="utf-8")
LICENCES = PAGE.partition("| library |")[2]


@pytest.mark.parametrize("pattern", ["*.whl", "any/*-none-any.whl"])
def test_each_file_of_the_packages_is_in_the_wheel(pattern: str) -> None:
    (wheel,) = DIST.glob(pattern)
    assert difference(wheel) == (set(), set())


def test_the_line_of_the_page_installs_one_wheel(tmp_path: Path) -> None:
    (line,) = re.findall(r"`pip install (dist/[^`]+)`", PAGE)
    install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    (wheel,) = ROOT.glob(line)
    subprocess.run([*install, "--target", tmp_path, wheel], check=True)
    assert (tmp_path / "firmware_bridge" / "py.typed").exists()


def test_the_sources_are_the_checkout() -> None:
    (path,) = DIST.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        held = {it.name.partition("/")[2] for it in archive.getmembers() if it.isfile()}
    assert tracked() - held - {".gitignore"} == set()
    strange = {it for it in held - tracked() if not re.match(r"PKG-INFO|setup\.cfg|[^/]*\.egg-info/", it)}
    assert strange == set()


def test_the_page_reports_each_library_and_its_license() -> None:
    reported = dict(re.findall(r"^\| `([\w.-]+)` \| ([^|]+) \|", LICENCES, re.MULTILINE))
    bill = json.loads((DIST / "sbom.cdx.json").read_text(encoding="utf-8"))
    assert bill["metadata"]["component"]["name"] == "firmware-bridge"
    mine = {"firmware-bridge", "pip", "setuptools", "pytest", "pluggy", "iniconfig"}
    assert {it["name"] for it in bill["components"]} - mine == set(reported)
    assert {name for name, licence in reported.items() if "GPL" in licence} == {"pymavlink", "python-can"}
