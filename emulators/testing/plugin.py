"""The pytest plugin: fixtures, options and marks, and the report of a failing test.

It is loaded in every run of pytest where the package is installed, so nothing of the bench is imported before
a test requests it.
"""

import os
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeGuard

import pytest

from emulators.testing.errors import RigError

if TYPE_CHECKING:
    from emulators.testing.buses import Bus
    from emulators.testing.emulated import Boards, Drives
    from emulators.testing.host_watch import HostWatch  # noqa: F401 - a key's type below
    from emulators.testing.kept import Kept
    from emulators.testing.page import CaseOutcome
    from emulators.testing.plant import VirtualPlant
    from emulators.testing.process import Process
    from emulators.testing.real import RealDrives
    from emulators.testing.recording import Recording
    from emulators.testing.rig import VirtualRig

MARKS: Final = (
    "robot(name, ...): which robots the test is run with",
    "seeds(number): run the test with so many seeds, --seed the first",
    "needs(what, ...): skip the test where this machine has not got it: vcan, cc",
    "destructive: it moves drives; with --rig=hardware it runs with --yes-move-it only",
)
VIRTUAL: Final = "virtual"
HARDWARE: Final = "hardware"
"""Values of --rig."""
PROCESSES: Final = pytest.StashKey[list["Process"]]()
WATCH: Final = pytest.StashKey["HostWatch"]()
"""Processes that a test has started, in the order of starting."""
PROGRAM: Final = (sys.executable, "-P", "-c", "from firmware_bridge.cli import main; main()")
"""`firmware-bridge`, wherever it is installed."""
NEEDS: Final[dict[str, tuple[Callable[[], bool], str]]] = {
    "vcan": (
        Path("/sys/class/net/vcan0").exists,
        "a SocketCAN bus vcan0: sudo ip link add dev vcan0 type vcan && sudo ip link set up vcan0",
    ),
    "cc": (lambda: shutil.which("cc") is not None, "a C compiler called cc"),
}
"""Needs of a test: a check for each, and the name of the missing thing."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, and `rig_robot` for a project's own file."""
    group = parser.getgroup("firmware-bridge", "robots and drives emulated by firmware-bridge")
    group.addoption("--robot", metavar="NAME", help="the robot of the tests that name none, or a robot file")
    group.addoption("--seed", type=int, default=0, metavar="N", help="all that is random comes from it")
    group.addoption(
        "--bus",
        metavar="vcan|loopback_multicast|INTERFACE:CHANNEL",
        help="the CAN bus of tests in real time; without it SocketCAN's virtual one, or datagrams",
    )
    group.addoption(
        "--rig",
        choices=(VIRTUAL, HARDWARE),
        default=VIRTUAL,
        help="hardware: drives are real ones, on --bus or --serial-line, and nothing else is tested",
    )
    group.addoption(
        "--serial-line", metavar="PROTOCOL:DEVICE", help="the line to real drives: v1:/dev/ttyUSB0"
    )
    group.addoption(
        "--yes-move-it", action="store_true", help="with --rig=hardware: run what is marked destructive, too"
    )
    group.addoption(
        "--kept", type=Path, default=Path("out/tests"), metavar="DIR", help="where failing tests leave theirs"
    )
    group.addoption(
        "--report-page", type=Path, metavar="FILE.html", help="write one page about this session's tests"
    )
    group.addoption(
        "--late-after",
        type=float,
        default=0.1,
        metavar="SECONDS",
        help="a test in real time that fails is INVALID where the machine was late by so much; 0: never",
    )
    group.addoption("--no-pictures", action="store_true", help="failing tests leave their recordings only")
    parser.addini("rig_robot", "the robot of the tests that name none, where --robot is not given")


def pytest_configure(config: pytest.Config) -> None:
    """Make the marks known; write a page where one is wanted, once where several processes test."""
    for mark in MARKS:
        config.addinivalue_line("markers", mark)
    if config.getoption("--report-page") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Pages(config.getoption("--report-page")))


class Pages:
    """Collector of the tests' results, which writes a page at the end."""

    def __init__(self, path: Path) -> None:
        self._path: Final = path
        self._reports: Final[list[pytest.TestReport]] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep a report of a test itself, and any that is bad."""
        if report.when == "call" or not report.passed:
            self._reports.append(report)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Write the page, and say where."""
        from emulators.testing.page import page  # noqa: PLC0415 - for who wants one

        count = len({report.nodeid for report in self._reports})
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._path.write_text(page(f"{count} tests", map(_outcome, self._reports)), encoding="utf-8")
        except OSError as error:
            terminalreporter.write_line(f"no page: {self._path} cannot be written: {error}", red=True)
        else:
            terminalreporter.write_line(f"page: {self._path}")


def pytest_report_header(config: pytest.Config) -> str | None:
    """Report the real drives, and the permission to move them."""
    if not _is_real(config):
        return None
    places = [place for word in ("--bus", "--serial-line") if (place := config.getoption(word))]
    moved = "run, too" if config.getoption("--yes-move-it") else "left out"
    return f"firmware-bridge: real drives on {' and '.join(places)}; what is marked destructive is {moved}"


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make a test for each robot and each seed of its marks."""
    robots = metafunc.definition.get_closest_marker("robot")
    if robots is not None and "rig_robot" in metafunc.fixturenames:
        metafunc.parametrize("rig_robot", robots.args)
    seeds = metafunc.definition.get_closest_marker("seeds")
    if seeds is not None and "rig_seed" in metafunc.fixturenames:
        # A failing seed is run alone by --seed and seeds(1).
        first = metafunc.config.getoption("--seed")
        metafunc.parametrize("rig_seed", range(first, first + seeds.args[0]), ids="seed{}".format)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test that needs something missing here, or moves real hardware without --yes-move-it."""
    real = _is_real(item.config)
    if real and item.get_closest_marker("destructive") and not item.config.getoption("--yes-move-it"):
        pytest.skip("it moves what is real: use --yes-move-it")
    for mark in item.iter_markers("needs"):
        for what in mark.args:
            if what not in NEEDS:
                pytest.fail(f"needs({what!r}): there are {', '.join(NEEDS)}", pytrace=False)
            there, missing = NEEDS[what]
            if not there() and not (what == "vcan" and _on_socketcan(item.config)):
                pytest.skip(f"needs {missing}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Report what a failing test's robot did, and where its recording is."""
    report = yield
    if report.failed:
        _notes(item, report, "again", _again(item))
    rig = getattr(item, "funcargs", {}).get("rig")
    wrong_story = call.excinfo is not None and isinstance(call.excinfo.value, RigError)
    if call.when == "call" and report.failed and _is_virtual(rig) and not wrong_story:
        from emulators.testing.failure import failure_text  # noqa: PLC0415 - the bench is there: a test has used it

        name = item.nodeid.rpartition("/")[2]
        folder = item.config.getoption("--kept") / re.sub(r"[^\w.-]+", "-", name).strip("-")
        pictures = not item.config.getoption("--no-pictures")
        text = failure_text(rig, name, folder, _again(item), pictures=pictures)
        report.sections.append(("firmware-bridge", text))
        _notes(item, report, "kept", str(folder.resolve()))
    if call.when == "call" and report.failed:
        for process in item.stash.get(PROCESSES, []):
            text = f"{process.command}\nexit status: {process.status}\n{process.printed}"
            report.sections.append(("firmware-bridge, a program", text))
        _invalid_where_late(item, report)
    return report


def _invalid_where_late(item: pytest.Item, report: pytest.TestReport) -> None:
    """Report a failure in real time as INVALID where the machine was late: it shows nothing."""
    if WATCH not in item.stash:
        return
    from emulators.testing.host_watch import lateness  # noqa: PLC0415 - for tests in real time alone

    processes: list[Process] = item.stash.get(PROCESSES, [])
    late = lateness(item.stash[WATCH], processes, item.config.getoption("--late-after"))
    if late:
        path, line, _ = item.reportinfo()
        failure = report.longreprtext.strip().splitlines()[-1:]
        report.outcome = "skipped"
        report.longrepr = (str(path), line or 0, f"INVALID: {late}; it failed: {''.join(failure)}")


@pytest.fixture(scope="session")
def _kept_rigs() -> Iterator["Kept"]:
    from emulators.testing.kept import Kept  # noqa: PLC0415 - two seconds, for tests that use it alone

    kept = Kept()
    yield kept
    kept.finish()


@pytest.fixture
def rig_robot(pytestconfig: pytest.Config) -> str:
    """Return the robot of a test, by name or file: of its mark `robot`, --robot, or rig_robot in the ini."""
    name = pytestconfig.getoption("--robot") or pytestconfig.getini("rig_robot")
    if not name:
        pytest.fail(
            "which robot? Give --robot NAME, @pytest.mark.robot(NAME), or rig_robot = NAME in pytest's"
            " configuration; `firmware-bridge robots` lists them",
            pytrace=False,
        )
    return str(name)


@pytest.fixture
def rig_seed(pytestconfig: pytest.Config) -> int:
    """Return the seed of a test: of its mark `seeds`, or of --seed."""
    return int(pytestconfig.getoption("--seed"))


@pytest.fixture
def rig(_kept_rigs: "Kept", rig_robot: str, rig_seed: int, request: pytest.FixtureRequest) -> "VirtualRig":
    """Return a robot in virtual time, armed and at standstill, with its operator."""
    _virtual_only(request.config, "the robot of a rig")
    request.node.user_properties += [("robot", rig_robot), ("seed", rig_seed)]
    return _kept_rigs.armed(rig_robot, rig_seed)


@pytest.fixture
def fault(rig: "VirtualRig") -> Callable[..., None]:
    """Return what makes something go wrong: `fault("supply_sag", to_v=9, for_s=0.5)`."""
    return rig.fault


@pytest.fixture
def recording(rig: "VirtualRig") -> "Recording":
    """Return what the rig's wires have carried since the robot was switched on."""
    return rig.recording


@pytest.fixture
def plant(rig_robot: str, pytestconfig: pytest.Config) -> Iterator["VirtualPlant"]:
    """Return the robot's plant alone, in virtual time, as it is when nothing has moved yet."""
    from emulators.testing.plant import VirtualPlant  # noqa: PLC0415 - for tests that use it alone
    from firmware_bridge.robot_types import find  # noqa: PLC0415 - as above

    _virtual_only(pytestconfig, "a plant")
    made = VirtualPlant(find(rig_robot, plant_too=True))
    yield made
    made.finish()


@pytest.fixture
def bus(request: pytest.FixtureRequest) -> Iterator[Callable[[], "Bus"]]:
    """Return what names the test's CAN bus: one that is the test's alone, and the same at each call."""
    from emulators.testing.buses import VCAN, Turns, buses  # noqa: PLC0415 - for tests that use it alone

    turns = Turns()
    taken: list[Bus] = []
    config = request.config
    kernel = any(VCAN in mark.args for mark in request.node.iter_markers("needs"))
    kind = VCAN if kernel and not _on_socketcan(config) else config.getoption("--bus")

    def take() -> "Bus":
        if not kind and _is_real(config):
            pytest.skip("needs the bus of real drives: --bus INTERFACE:CHANNEL")
        if not taken:
            taken.append(turns.takes(buses(kind)))
        return taken[0]

    yield take
    turns.finish()


@pytest.fixture
def under_test(
    request: pytest.FixtureRequest,
    tmp_path: Path,
    bus: Callable[[], "Bus"],  # so that it is given back when no one is on it any more
) -> Iterator[Callable[[str | Sequence[str]], "Process"]]:
    """Return what starts a program, `under_test("./my_master vcan0")`; it is ended with the test."""
    from emulators.testing import host_watch  # noqa: PLC0415 - as above
    from emulators.testing.process import Process  # noqa: PLC0415 - for tests that use it alone

    del bus
    watch = request.node.stash[WATCH] = host_watch.HostWatch()
    started: list[Process] = request.node.stash.setdefault(PROCESSES, [])

    def start(command: str | Sequence[str]) -> Process:
        started.append(Process(command, tmp_path / f"program-{len(started)}.txt"))
        return started[-1]

    yield start
    # In reverse order: a master ends before the devices that it speaks to.
    for process in reversed(started):
        process.stop()
    watch.end()


@pytest.fixture
def drives(
    under_test: Callable[[Sequence[str]], "Process"], tmp_path: Path, request: pytest.FixtureRequest
) -> Iterator["Drives | RealDrives"]:
    """Return what puts drives on a serial line, or on a bus, `drives("1-4", on=bus())`: emulated, or real."""
    # For tests that use them alone.
    from emulators.testing.emulated import Drives  # noqa: PLC0415 - see above
    from emulators.testing.real import RealDrives  # noqa: PLC0415 - see above

    def start(words: Sequence[str]) -> "Process":
        return under_test((*PROGRAM, *words))

    option = request.config.getoption
    if not _is_real(request.config):
        yield Drives(start, tmp_path)
        return
    real = RealDrives(start, option("--serial-line"), moved=option("--yes-move-it"))
    yield real
    for master in request.node.stash[PROCESSES]:
        master.stop()  # or it would command them on while they are stopped
    real.finish()


@pytest.fixture
def board(
    under_test: Callable[[Sequence[str]], "Process"], tmp_path: Path, pytestconfig: pytest.Config
) -> "Boards":
    """Return what puts an emulated Arduino on a serial line: a robot's, a firmware's, or the arm's."""
    from emulators.testing.emulated import Boards  # noqa: PLC0415 - for tests that use it alone

    _virtual_only(pytestconfig, "a board")
    return Boards(lambda words: under_test((*PROGRAM, *words)), tmp_path)


def _notes(item: pytest.Item, report: pytest.TestReport, name: str, value: str) -> None:
    """Put a property into this report, and into those of the test to come, from which JUnit takes it."""
    item.user_properties.append((name, value))
    report.user_properties.append((name, value))


def _outcome(report: pytest.TestReport) -> "CaseOutcome":
    """Return a report as the page has it."""
    from emulators.testing.page import CaseOutcome  # noqa: PLC0415 - see above

    known = {str(name): str(value) for name, value in report.user_properties}
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longreprtext
    return CaseOutcome(
        name=report.nodeid,
        outcome="error" if report.failed and report.when != "call" else report.outcome,
        seconds=report.duration,
        of=", ".join(f"{name} {known[name]}" for name in ("robot", "seed") if name in known),
        error=reason,
        sections=tuple(report.sections),
        kept=known.get("kept", ""),
        again=known.get("again", ""),
    )


def _is_real(config: pytest.Config) -> bool:
    return bool(config.getoption("--rig") == HARDWARE)


def _virtual_only(config: pytest.Config, what: str) -> None:
    if _is_real(config):
        pytest.skip(f"{what} is virtual: not with --rig={HARDWARE}")


def _on_socketcan(config: pytest.Config) -> bool:
    """Return True if real drives are on a bus of the kernel's."""
    return _is_real(config) and str(config.getoption("--bus")).startswith("socketcan:")


def _is_virtual(rig: object) -> "TypeGuard[VirtualRig]":
    """Return True if this is a rig of ours: a project may have a fixture of that name."""
    return type(rig).__module__ == "emulators.testing.rig"


def _again(item: pytest.Item) -> str:
    """Return the line that runs a test again from where pytest was called."""
    config = item.config
    path = os.path.relpath(item.path, config.invocation_params.dir)
    words = ["pytest", "::".join([path, *item.nodeid.split("::")[1:]])]
    for option in ("--robot", "--seed", "--bus", "--serial-line"):
        if config.getoption(option):
            words += [option, str(config.getoption(option))]
    if _is_real(config):
        words += [f"--rig={HARDWARE}", *(["--yes-move-it"] if config.getoption("--yes-move-it") else [])]
    return shlex.join(words)
