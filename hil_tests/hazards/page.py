"""Tables of a robot's page on safety: hazards and protective functions, and what `fmea` found unnoticed."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, NamedTuple, TypeAlias

from emulators.testing.inherited.fake_driver import cases_of
from firmware_bridge.canopen_drive.settings import DriveLink
from firmware_bridge.drivers.all_drivers import reports_of
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.robot_types import find, robot_type_named
from firmware_bridge.safety.common import AXIS_INTERLOCKS, EXCLUDED_AXIS, whole_robot_interlocks
from firmware_bridge.safety.interlock import AxisInterlock, Limit
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from hil_tests.failures.causes import LINES
from hil_tests.failures.drive import KEPT as OUTCOMES
from hil_tests.failures.drive import Outcome
from hil_tests.hazards import analysis
from hil_tests.hazards.analysis import Analyzed
from hil_tests.hazards.axes import AXES
from hil_tests.hazards.common import BESIDE, COMMON
from hil_tests.hazards.robots import OWN
from hil_tests.hazards.rows import OWN_CASES, Function
from validation.pages.pages import table
from validation.pages.safety import reached, severity

Cells: TypeAlias = tuple[str, ...]
HEADINGS: Final = (
    *("hazard", "protective function", "severity", "trips at", "reaction"),
    *("stopping distance", "fmea", "residual risk", "test"),
)
UNNOTICED_HEADINGS: Final = ("failure", "cells", "worst case", "reason")
TEXT: Final = """The page of each robot has its hazards (ISO 12100), the function against each, and what it
leaves. **Stopping distance** is the longest that was measured of the causes that the function reacts to, with
its cause, over every link of the robot; its conditions are below. **fmea**: of the failures that
`firmware-bridge fmea` injects in every state of the robot, the number that this function noticed first, the
longest time until then, and the largest motion, with the motion that is commanded in the first second. A
second table has those that were not noticed, or late, each with its reason; there is no other. Values and
times are those of the robot file, and of the boundary case that the named test drives."""
UNNOTICED_TEXT: Final = "Not noticed in time, for a known reason:"
WORST_TEXT: Final = "**Worst case**: {worst}."


class Protection(NamedTuple):
    """One function of one robot."""

    function: Function
    interlock: InterlockBase | None
    """None: it is no interlock."""


def protections(name: str) -> Iterator[Protection]:
    """Yield the functions of a robot, as they are judged; KeyError where one has no row."""
    robot_type, robot = robot_type_named(name), find(name)
    own = {row.name: row for row in OWN[name]}
    known = {row.name: row for row in (*COMMON, *AXES)}
    seen: set[str] = set()
    for interlock in _interlocks(robot_type, robot):
        title = interlock.name.split(":")[0]
        if title not in seen:
            seen.add(title)
            yield Protection(own[title] if title in own else known[title], interlock)
    yield from (Protection(row, None) for row in BESIDE if row.applies(robot))


def _interlocks(robot_type: AnyRobotType, robot: AnyRobot) -> Iterator[InterlockBase]:
    modes = robot_type.rules(robot)
    rules = modes[""]
    yield from whole_robot_interlocks(rules.numbers, robot.links)
    yield from (*rules.interlocks, *rules.after_limits)
    yield from _of_axes(robot)
    if any(mode.without for mode in modes.values()):
        yield EXCLUDED_AXIS
    yield from rules.limits


def _of_axes(robot: AnyRobot) -> Iterator[AxisInterlock]:
    """Yield those that stand on some axis, over any of its links; `reached` has the weaker ones, too."""
    found: dict[str, AxisInterlock] = {}
    for one in reached(robot):
        for row in AXIS_INTERLOCKS:
            for axis in one.axes:
                fitting = row.fitting(reports_of(one, axis))
                if fitting is not None:
                    found.setdefault(fitting.name, fitting)
    yield from found.values()


def rows(name: str) -> Iterator[Cells]:
    """Yield a line for each function of a robot."""
    robot = find(name)
    outcomes = [row for row in OUTCOMES.read() if row.line in LINES[name]]
    results = {row.noticed_by: row for row in analysis.KEPT.read() if row.robot == name and not row.why}
    cases = _cases(name)
    for function, interlock in protections(name):
        yield (
            function.hazard,
            function.name,
            "-" if interlock is None else severity(interlock),
            function.trips(robot) if function.trips else cases[function.name][1],
            function.reaction if interlock is None else function.reaction or reaction(interlock, robot),
            distance(function.causes, outcomes),
            _result(results.get(function.name)),
            function.residual,
            _test(name, function, cases),
        )


def _cases(name: str) -> Mapping[str, tuple[int, str]]:
    """Return the boundary case of each own interlock that reads best: its place in the list, its reason."""
    found: dict[str, tuple[int, str]] = {}
    for place, case in enumerate(cases_of(name)):
        before = found.get(case.interlock)
        if before is None or _awkward(case.reason) < _awkward(before[1]):
            found[case.interlock] = place, case.reason
    return found


def _awkward(reason: str) -> tuple[bool, bool, bool]:
    """Return how little a reason shows of a threshold: not a number, no number at all, a negative one."""
    return "nan" in reason, not any(letter.isdigit() for letter in reason), " -" in reason


def _test(name: str, function: Function, cases: Mapping[str, tuple[int, str]]) -> str:
    if function.test != OWN_CASES:
        return f"`{function.test}`"
    return f"`{function.test}[{name}-{function.name}-{cases[function.name][0]}]`"


def reaction(interlock: InterlockBase, robot: AnyRobot) -> str:
    """Return what follows from an interlock, in words, from its own properties."""
    if isinstance(interlock, Limit):
        ramps = interlock.severity is Severity.INFO
        return "the ramp takes longer; reported" if ramps else "the command is clipped; reported"
    if interlock.name == "emergency stop":
        powered = DriveLink.all_of(robot) or ShieldLink.all_of(robot)
        off = "ramp, then no power where the robot does not roll: comparable to SS1"
        return f"{off if powered else 'no further move; the motors keep their current'}; latched; disarmed"
    who = "everything stops" if interlock.stops is None else f"{' and '.join(sorted(interlock.stops))} stops"
    how = "by the ramp, comparable to SS2"
    if interlock.disables_power:
        how = "by the ramp, the axis itself without power"
    disarms = interlock.disarms or isinstance(interlock, AxisInterlock)
    on = "goes on when the controls have been neutral" if interlock.parts else "goes on when it clears"
    after = "disarmed" if disarms else on
    return f"{who} {how}; {after}"


def distance(causes: Iterable[str], outcomes: Iterable[Outcome]) -> str:
    """Return the longest stopping distance of these causes, and the lift's; which lines keep driving."""
    wanted = frozenset(causes)
    found = [row for row in outcomes if row.cause in wanted]
    stops = [row for row in found if row.rest_ms >= 0]
    shown = []
    for lifts in (False, True):
        ways = [row for row in stops if row.case.motion.lifts is lifts]
        if ways:
            worst = max(ways, key=lambda row: row.way_mm)
            what = "lift " if lifts else ""
            shown.append(f"{what}{worst.way_mm} mm, {worst.rest_ms / 1000:.2f} s ({worst.cause})")
    endless = {row.line.split(":", 1)[1].split(":")[0] for row in found if row.rest_ms < 0}
    if endless:
        shown.append(f"**keeps driving** with {', '.join(sorted(endless))}")
    return "; ".join(shown) or "-"


def _result(row: Analyzed | None) -> str:
    if row is None:
        return "-"
    return f"{row.cells} cells, {row.latest_ms} ms at most; {_moved(row)}"


def _moved(row: Analyzed) -> str:
    still = "keeps moving" if row.standstill_ms is None else f"{row.standstill_ms / 1000:.2f} s"
    at = f" at {row.place}" if row.place else ""
    return f"{row.goes_mm} mm, {row.turns_deg}°, {still} ({row.failure}{at}; {row.state})"


def unnoticed(name: str) -> Iterator[Cells]:
    """Yield a line for each kind of failure that no interlock noticed in time."""
    for row in analysis.KEPT.read():
        if row.robot == name and row.why:
            yield row.kind, str(row.cells), _moved(row), row.why


def worst(name: str) -> str:
    """Return the longest measured stop of a robot, in one line."""
    outcomes = [row for row in OUTCOMES.read() if row.line in LINES[name] and not row.case.cause.only]
    return distance({row.cause for row in outcomes}, outcomes)


def general() -> tuple[str, ...]:
    """Return what the tables of all robots have in common."""
    return ("### Hazards and protective functions", TEXT)


def sections(name: str) -> tuple[str, ...]:
    """Return the part of the page on one robot, in Markdown."""
    if name not in LINES:
        return ()
    lacking = tuple(unnoticed(name))
    return (
        WORST_TEXT.format(worst=worst(name)),
        "## Hazards and protective functions",
        table(HEADINGS, rows(name)),
        *((UNNOTICED_TEXT, table(UNNOTICED_HEADINGS, lacking)) if lacking else ()),
    )
