"""A bridge in a process of its own, however it ends and whatever takes nothing from it: the robot stands."""

import fcntl
import os
import pty
import resource
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Final

import pytest
from pymavlink.dialects.v20 import common as mavlink

from hil_tests.processes.pair import Pair, Row, passes, zeros
from hil_tests.processes.station import Station

pytestmark = pytest.mark.alone
AT_A_TIME: Final = 4
"""Pairs of processes: mostly they wait."""
ONE_BUS: Final = Lock()
JOINT_6: Final = 9
"""The number by which the robot's file knows it: its place is written when it is confirmed again."""
JOINTS: Final = zeros(j1=0, j2=-90, j3=90, j4=0, j5=60, j6=0)
UNWATCHED: Final = ("--accept-no-watchdog",)
MW: Final = Row("rome", ("--protocol", "mw", "--encoders", "3"), UNWATCHED, ("board",))
ROBOTS: Final = {
    "rars": Row("rars", bridge=zeros(lift=0, steer=0)),
    "rars, v2": Row("rars", ("--protocol", "v2"), zeros(lift=0, steer=0), ("drives",)),
    "climber": Row("climber", stick=400),
    "rome, ros-arduino-bridge": Row("rome", lines=("board",)),
    "rome, arduinoio": Row("rome", ("--protocol", "arduinoio", "--encoders", "3"), UNWATCHED, ("board",)),
    "rome, mw": MW,
    "rome, firmata": Row("rome+cameras", ("--protocol", "firmata"), UNWATCHED, ("board",)),
    "ar2": Row(
        "ar2",
        bridge=zeros(j1=0, j2=-90, j3=1, j4=0, j5=0, j6=0),
        lines=("arm",),
        turns_rad_s=0.01,
        stick=-600,
    ),
    "rome_arm": Row("rome_arm", (*MW.words,), (*JOINTS, *UNWATCHED), ("board", "arm")),
}


@dataclass
class Reported:
    """Result of a story."""

    moved_s: float
    """Time from the begin up to which a motor turned."""
    status: int | None
    """The bridge's exit status; None where it goes on."""
    stated: str


Story = Callable[[Row, Path], Reported]


def story(
    attack: Callable[[Pair], float], *, goes_on: bool = False, settles_s: float = 3.0, **given: object
) -> Story:
    """Let a robot drive, attack its bridge, and look what comes of it."""

    def reported(row: Row, folder: Path) -> Reported:
        # A member of a group receives all groups of its port: one robot at a time is on a bus.
        with nullcontext() if row.lines else ONE_BUS:
            return carried(row, folder)

    def carried(row: Row, folder: Path) -> Reported:
        pair = Pair(row, folder, **given)  # type: ignore[arg-type]
        try:
            pair.drives()
            begun = attack(pair)
            status = None if goes_on else pair.ended()
            passes(settles_s)
            if goes_on:
                assert pair.bridge.poll() is None, pair.stated
            return Reported(pair.moved_until(begun), status, pair.stated)
        finally:
            pair.close()

    return reported


def sent(*numbers: signal.Signals, apart_s: float = 0.1) -> Callable[[Pair], float]:
    def attack(pair: Pair) -> float:
        begun = pair.sends(numbers[0])
        for number in numbers[1:]:
            passes(apart_s)
            pair.sends(number)
        return begun

    return attack


def suspended(pair: Pair) -> float:
    """Suspend it for three seconds; from its continuation on it has time to stop the robot."""
    pair.sends(signal.SIGSTOP)
    passes(3.0)
    return pair.sends(signal.SIGCONT)


def full_log(pair: Pair) -> float:
    """Nothing can be added to its log any more, as on a full disk; then the stick is let go."""
    size = pair.log.stat().st_size
    resource.prlimit(pair.bridge.pid, resource.RLIMIT_FSIZE, (size, size))
    pair.station.stick = 0
    passes(1.0)
    pair.station.stops()
    return time.monotonic()


def stopped(pair: Pair) -> float:
    """Order an emergency stop."""
    pair.station.stops()
    return time.monotonic()


def chattering(pair: Pair) -> float:
    """The board falls silent once, prints without end then, and a stop is ordered."""
    pair.chatters()
    passes(3.0)
    return stopped(pair)


def fight(pair: Pair) -> float:
    """Two take the control from one another, both at full stick; the one stops the robot."""
    other = Station(pair.station.port, system=77)
    other.begin()
    try:
        other.stick = pair.row.stick
        for _ in range(30):
            for station in (other, pair.station):
                station.lets_anybody_drive()
                passes(0.06)
        other.stops()
        begun = time.monotonic()
        passes(1.0)
        return begun
    finally:
        other.end()


def crowd(pair: Pair) -> float:
    """Two hundred third parties show that they live, two thousand times a second; then a stop is ordered."""
    new_stations = [Station(pair.station.port, system=number) for number in range(2, 202)]
    ends = Event()

    def speak() -> None:
        while not ends.wait(0.005):
            for foreign_node in new_stations[:10]:
                foreign_node.lives()
            new_stations[:] = new_stations[10:] + new_stations[:10]

    thread = Thread(target=speak)
    thread.start()
    try:
        passes(2.0)
        begun = stopped(pair)
        passes(1.0)
        return begun
    finally:
        ends.set()
        thread.join()
        for foreign_node in new_stations:
            foreign_node.closes()


def closed_terminal(row: Row, folder: Path) -> Reported:
    """The window is closed, or ssh drops: the kernel hangs up."""
    with terminal() as (master, slave):

        def close(pair: Pair) -> float:
            del pair
            os.close(master)
            return time.monotonic()

        return story(close, stdout=slave)(row, folder)


def gone_terminal(row: Row, folder: Path) -> Reported:
    """Its terminal is gone, and it ignores the hang-up; then a stop is ordered."""
    with terminal() as (master, slave):

        def close(pair: Pair) -> float:
            os.close(master)
            passes(1.0)
            return stopped(pair)

        return story(close, goes_on=True, stdout=slave, ignores_hang_ups=True)(row, folder)


@contextmanager
def terminal() -> Iterator[tuple[int, int]]:
    """Make a terminal whose other end the story closes."""
    master, slave = pty.openpty()
    try:
        yield master, slave
    finally:
        os.close(slave)


def unread(row: Row, folder: Path) -> Reported:
    """Its output is not read, as by a pager or Ctrl-S; then the stick is let go, and a stop is ordered."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)

    def stall(pair: Pair) -> float:
        full = os.open(f"/proc/self/fd/{writer}", os.O_WRONLY | os.O_NONBLOCK)
        try:
            while True:
                os.write(full, b"x")
        except BlockingIOError:
            os.close(full)
        begun = time.monotonic()
        for _ in range(3):
            pair.station.stops()
            passes(0.2)
        pair.sends(signal.SIGINT)
        return begun

    try:
        return story(stall, stdout=writer)(row, folder)
    finally:
        os.close(reader)
        os.close(writer)


def stalled_disk(row: Row, folder: Path) -> Reported:
    """The disk under the file where the axes stand takes nothing: a pipe that no one reads stands for it."""

    def stall(pair: Pair) -> float:
        pair.station.stick = 0
        pair.station.requests(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0)
        passes(1.0)
        pair.station.requests(mavlink.MAV_CMD_USER_1, JOINT_6, 1.0)
        passes(0.5)
        os.mkfifo(folder / f"state.json.{pair.bridge.pid}")
        pair.station.requests(mavlink.MAV_CMD_USER_1, JOINT_6, 0.0)
        pair.drives()
        passes(2.0)
        pair.station.stops()
        return time.monotonic()

    return story(stall, goes_on=True)(row, folder)


SIGHUP = story(sent(signal.SIGHUP))
STORIES: Final[dict[str, tuple[Row, Story]]] = {
    **{f"{name}: hang-up": (row, SIGHUP) for name, row in ROBOTS.items()},
    "quit": (MW, story(sent(signal.SIGQUIT))),
    "ctrl-z": (MW, story(sent(signal.SIGTSTP))),
    "ctrl-c twice": (MW, story(sent(signal.SIGINT, signal.SIGINT))),
    "ctrl-c and terminated": (MW, story(sent(signal.SIGINT, signal.SIGTERM, apart_s=0.02))),
    "ctrl-c three times": (MW, story(sent(signal.SIGINT, signal.SIGINT, signal.SIGINT), settles_s=0.0)),
    "closed terminal": (MW, closed_terminal),
    "gone terminal": (MW, gone_terminal),
    "no one reads": (MW, unread),
    "full log": (MW, story(full_log, goes_on=True)),
    "stalled disk": (ROBOTS["rome_arm"], stalled_disk),
    **{
        f"{name}: chatters": (ROBOTS[name], story(chattering, goes_on=True, settles_s=7.0))
        for name in ("rome, ros-arduino-bridge", "rome, arduinoio", "rome, mw", "rome, firmata")
    },
    "rars, v2: stopped on the level": (ROBOTS["rars, v2"], story(stopped, goes_on=True, settles_s=5.0)),
    "fight": (MW, story(fight, goes_on=True)),
    "crowd": (MW, story(crowd, goes_on=True)),
    "suspended": (MW, story(suspended, goes_on=True)),
}
STOPS_WITHIN_S: Final = 4.0
"""Each of them ramps down in less than a second; a busy machine takes its time, too."""


@pytest.fixture(scope="module")
def reported(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[str, Future[Reported]]]:
    """Let the stories that were chosen run, some at a time: most of their time they wait."""
    chosen = [
        str(item.callspec.params["name"])
        for item in request.session.items
        if isinstance(item, pytest.Function) and item.module is request.module and hasattr(item, "callspec")
    ]
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        yield {
            name: pool.submit(STORIES[name][1], STORIES[name][0], tmp_path_factory.mktemp("story"))
            for name in dict.fromkeys(chosen)
        }


@pytest.mark.parametrize("name", STORIES)
def test_the_robot_stands(name: str, reported: dict[str, Future[Reported]]) -> None:
    came = reported[name].result()
    if name == "ctrl-c three times":
        assert came.status == 1
        assert "nothing stops it" in came.stated.splitlines()[-1]
        return
    assert came.moved_s <= STOPS_WITHIN_S, came
    assert came.status in (None, 0), came
    assert "on a slope" not in came.stated
    if name == "suspended":
        assert "bridge stalled" in came.stated
