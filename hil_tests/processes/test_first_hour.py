"""The first hour with a robot of one's own: written, installed, emulated, driven, stopped, reported."""

import os
import re
import signal
import site
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import pytest
from pymavlink.dialects.v20 import common as mavlink

from hil_tests.processes.pair import awaited, passes
from hil_tests.processes.station import Station

pytestmark = pytest.mark.alone
BUS: Final = ("-i", "loopback_multicast", "-c", "239.74.163.3")
PROGRAM: Final = "from firmware_bridge.cli import main; main()"
THROTTLE: Final = 500
"""Rest position of a gamepad's throttle that springs to its middle."""
AHEAD: Final = 700
WAY_M: Final = 2.0
PICTURES: Final = {"path", "speeds", "currents", "interlocks"}


class Desk:
    """A folder with an environment of its own, and programs that are started in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._python = folder / "venv" / "bin" / "python"
        self._run(sys.executable, "-m", "venv", "--without-pip", "venv")
        (packages,) = folder.glob("venv/lib/python*/site-packages")
        # What is installed here is not installed again; the robot is his environment's alone.
        lines = [f"import site; site.addsitedir({one!r})" for one in site.getsitepackages()]
        (packages / "beside.pth").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def does(self, *words: str) -> str:
        """Run the program, and return its output; it must end well."""
        return self._run(str(self._python), "-c", PROGRAM, *words)

    def installs(self, name: str) -> None:
        offline = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check", "-q")
        self._run(str(self._python), "-m", "pip", "install", *offline, "-e", name)

    @contextmanager
    def runs(self, log: str, *words: str) -> Iterator["subprocess.Popen[bytes]"]:
        """Have the program run beside; it is killed at the end where it has not ended."""
        with (self.folder / log).open("wb") as out:
            process = subprocess.Popen(
                [self._python, "-u", "-c", PROGRAM, *words],
                cwd=self.folder,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                env=os.environ | {"NO_COLOR": "1"},
            )
        try:
            yield process
        finally:
            process.kill()
            process.wait()

    def _run(self, *words: str) -> str:
        done = subprocess.run(
            words,
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | {"NO_COLOR": "1", "COLUMNS": "200"},
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


def test_from_nothing_to_the_page_of_a_driven_robot(tmp_path: Path) -> None:
    desk, station = Desk(tmp_path), Station()
    station.throttle = THROTTLE
    desk.does(
        "new", "rover", "--kind", "differential", "--nodes", "1,2", "--wheel-radius", "0.1", "--track", "0.4"
    )
    desk.installs("./rover")
    assert re.search(r"\brover\b", desk.does("robots")), "started beside the folder of that name"
    where = ("--mavlink", f"udpin:127.0.0.1:{station.port}", "--state", "state.json")
    words = ("drive", "rover", *BUS, *where, "--record", "recordings")
    with desk.runs("emulated.log", "emulate", "rover", *BUS):
        # Its plant is built first.
        awaited(lambda: "ends it" in (tmp_path / "emulated.log").read_text("utf-8"), "it is emulated")
        with desk.runs("driven.log", *words) as bridge:
            station.begin()
            try:
                drives(station, bridge, tmp_path / "driven.log")
            finally:
                station.end()
    (folder,) = (tmp_path / "recordings").iterdir()
    stated = desk.does("report", str(folder.relative_to(tmp_path)), "--animate")
    assert "otherwise than was recorded" not in stated
    page = (folder / "report.html").read_text(encoding="utf-8")
    way = re.search(r'path length</td><td class="number">([\d.]+)<', page)
    assert way is not None
    assert float(way[1]) == pytest.approx(station.x_m, abs=0.05)
    assert {path.stem for path in folder.glob("*.png")} == PICTURES
    assert page.count("data:image/png") == len(PICTURES)
    assert (folder / "animated.html").exists()


def drives(station: Station, bridge: "subprocess.Popen[bytes]", log: Path) -> None:
    """Arm with the throttle at rest in its middle, drive on, stop, disarm, and end the bridge."""

    def armed() -> bool:
        assert bridge.poll() is None, log.read_text(encoding="utf-8")
        station.requests(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        passes(0.5)
        return station.armed

    awaited(armed, "it is armed")
    station.stick = AHEAD
    awaited(lambda: station.x_m > WAY_M, "it has gone two meters")
    station.stick = 0
    passes(2.0)
    station.requests(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0)
    awaited(lambda: not station.armed, "it is disarmed")
    with suppress(ProcessLookupError):
        bridge.send_signal(signal.SIGINT)
    assert bridge.wait(30.0) == 0, log.read_text(encoding="utf-8")
    assert station.x_m > WAY_M
