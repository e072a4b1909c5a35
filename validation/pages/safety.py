"""Interlocks of each shipped robot, and the frames that its guard lets pass: the rows of the code."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final, TypeAlias

import firmware_bridge
from firmware_bridge import robot_types
from firmware_bridge.drivers.all_drivers import reports_of, stop_stages_of
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.drivers.stop_stages import StopStage, sequence, sums
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.settings import ShieldLink, ShieldProtocol
from firmware_bridge.family import family_of
from firmware_bridge.mavlink.age import ROWS as AGES
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.safety.common import AXIS_INTERLOCKS, EXCLUDED_AXIS, whole_robot_interlocks
from firmware_bridge.safety.interlock import AxisInterlock
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.tracking import bounds_of, within
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

Cells: TypeAlias = tuple[str, ...]
HEADINGS: Final = ("interlock", "blocks arming", "release delay", "remedy")
LIMIT_HEADINGS: Final = ("limit", "release delay", "remedy")
AXIS_HEADINGS: Final = (
    "interlock", "needs", "without it", "severity", "disables power", "release delay", "remedy"
)  # fmt: skip
PLAUSIBILITY_HEADINGS: Final = (
    "axis",
    "standstill below",
    "speed",
    "position",
    "ramp",
    "cruise",
    "lag",
    "repeats",
    "holding current",
    "within",
)  # fmt: skip
AGE_HEADINGS: Final = ("from", "timestamped", "notes")
UNPOWERED_HEADINGS: Final = ("axis", "without power", "friction")
BOUND_HEADINGS: Final = (
    "axis", "link", "timeout", "top speed", "travel", "reference", "on the wire", "interlocks"
)  # fmt: skip
SUM_HEADINGS: Final = ("sum", "of", "bound, both signs")
EXCLUSIVE_HEADINGS: Final = ("never together", "one side", "other side")
STOP_HEADINGS: Final = (
    "stage",
    "of",
    "sent",
    "confirmed by",
    "within",
    "from top speed",
    "notes",
)


WORST_HEADINGS: Final = (
    "robot",
    "link",
    "longest stop",
    "all stages over",
    "silence of an axis",
    "silence of the operator",
)


def worst() -> Iterator[Cells]:
    """Yield each robot's longest stop from top speed, a line a link, and how long silence may last before."""
    for _, robot in shipped():
        for link in robot.links:
            if not robot.axes_on(link):
                continue
            taken, whole = _longest(robot, link)
            yield (
                f"[{robot.title}](safety/{robot.name}.md)",
                f"`{link}`",
                f"{taken / SECOND:.1f} s: {_ended(robot, link).removesuffix(',')}",
                f"{whole / SECOND:.1f} s",
                f"{robot.links[link].silent_ms} ms",
                f"{robot.operator.silent_ms} ms",
            )


def shipped() -> Iterator[tuple[AnyRobotType, AnyRobot]]:
    """Yield the robots that come with this package; those of other packages have their own pages."""
    here = Path(firmware_bridge.__file__).parent
    for name in robot_types.names():
        robot_type = robot_types.robot_type_named(name)
        if here in robot_type.file.parents:
            yield robot_type, robot_types.find(name)


def interlocks(robot_type: AnyRobotType, robot: AnyRobot) -> Iterator[Cells]:
    """Yield the rows of the whole robot in the order in which they are judged."""
    rules = robot_type.rules(robot)[""]
    rows: tuple[InterlockBase, ...] = (
        *whole_robot_interlocks(rules.numbers, robot.links),
        *rules.interlocks,
        *rules.after_limits,
    )
    for row in rows:
        yield (row.name, _yes(row.blocks_arming), _clear(row), row.remedy)


def limits(robot_type: AnyRobotType, robot: AnyRobot) -> Iterator[Cells]:
    """Yield what clips a command, in its order."""
    for row in robot_type.rules(robot)[""].limits:
        yield (row.name, _clear(row), row.remedy)


def axis_interlocks() -> Iterator[Cells]:
    """Yield what is judged of each axis, every weaker row behind the first one that it stands in for."""
    named: set[AxisInterlock] = set()
    for row in (*AXIS_INTERLOCKS, EXCLUDED_AXIS):
        standing: AxisInterlock | None = row
        while standing is not None and standing not in named:
            named.add(standing)
            needs = ", ".join(sorted(one.value for one in standing.needs)) or "-"
            weaker = "-" if not standing.needs else _instead(standing)
            disables_power = _yes(standing.disables_power)
            yield (
                *(standing.name, needs, weaker, severity(standing), disables_power),
                *(_clear(standing), standing.remedy),
            )
            standing = standing.replacement


def ages() -> Iterator[Cells]:
    """Yield the methods to determine the age of a command, the best first."""
    for row in AGES:
        yield (row.name, _yes(row.timestamped), "its age" if row.timestamped else "its least age")


def bounds(robot: AnyRobot) -> Iterator[Cells]:
    """Yield what each axis may be sent, in its unit and on the wire, and the rows that its driver allows."""
    for axis in robot.axes:
        link = robot.links[axis.link]
        yield (
            f"`{axis.name}`",
            f"`{axis.link}`, {link.driver.value}",
            f"{link.silent_ms} ms",
            f"{axis.top_speed:g} {axis.unit.value}/s",
            "-" if axis.travel is None else f"{axis.travel[0]:g} to {axis.travel[1]:g} {axis.unit.value}",
            axis.zero.how or ("confirm" if axis.needs_confirmation else "at power-on"),
            _on_the_wire(robot, axis),
            ", ".join(_fitting(robot, axis)),
        )


def plausibility_rows(robot: AnyRobot) -> Iterator[Cells]:
    """Yield how far each axis is believed, in its unit."""
    for axis in robot.axes:
        bounds, unit = bounds_of(robot, axis), axis.unit.value
        yield (
            f"`{axis.name}`",
            f"{axis.standstill_below:.3g} {unit}/s",
            f"{bounds.speed:.3g} {unit}/s",
            f"{bounds.position:.3g} {unit}",
            f"{bounds.ramp:.3g} {unit}/s2",
            f"{bounds.cruise:.3g} {unit}/s",
            f"{bounds.lag_s * 1000:g} ms",
            f"{bounds.creep:.2g} {unit}",
            f"{axis.holds_with:g} A",
            f"{within(axis, robot.links[axis.link].silent_ms * MILLISECOND) // MILLISECOND} ms",
        )


def unpowered(robot: AnyRobot) -> Iterator[Cells]:
    """Yield what becomes of each axis without power, and what friction explains where it stands with it."""
    for axis in robot.axes:
        # No command takes a stepper's current: the robot file's answer is that of a motor that keeps it.
        steps = axis.link in Ar2Link.all_of(robot)
        without = "keeps its current; without it, it falls" if steps else axis.unpowered.value
        yield (f"`{axis.name}`", without, f"{axis.friction:.2g} A")


def guarded_sums(robot: AnyRobot) -> Iterator[Cells]:
    """Yield the sums of speeds that the guard bounds."""
    for row in robot.guard.sums:
        terms = " + ".join(f"{factor:g} `{axis}`" for axis, factor in row.of.items())
        yield (row.name, terms.replace("+ -", "- "), f"{row.bound:g}")


def exclusive(robot: AnyRobot) -> Iterator[Cells]:
    """Yield the sides that never move together."""
    for row in robot.guard.exclusive:
        yield (row.name, _quoted(row.one), _quoted(row.other))


def stops(robot: AnyRobot, link: str) -> Iterator[Cells]:
    """Yield the stop stages of the axes on a link, each with its time."""
    axes = robot.axes_on(link)
    sequences = [stop_stages_of(robot, axis) for axis in axes]
    for stages in zip(*sequences, strict=True):
        stage = stages[0]
        longest = max(one.lasts(axis.top_speed) for one, axis in zip(stages, axes, strict=True))
        whom = "a power-off" if stage.ordered_off else "both" if stage.ends_power else "a stop"
        yield (
            stage.name,
            whom,
            stage.sent,
            "no torque" if stage.ends_power else "standstill, or no torque",
            _within(stage),
            f"{longest // MILLISECOND} ms",
            stage.note or "-",
        )


def sums_of_stops(robot: AnyRobot, link: str) -> str:
    """Return the longest time of a stop: until the power is off, and in all."""
    taken, whole = (f"{seconds / SECOND:.1f} s" for seconds in _longest(robot, link))
    return f"From top speed {_ended(robot, link)} after {taken} at most; all stages after {whole}."


def _ended(robot: AnyRobot, link: str) -> str:
    """Return what the stage that ends a stop brings about."""
    steppers = isinstance(robot.links[link], Ar2Link)
    return "no motor moves, with its current on," if steppers else "the power stage is disabled"


def _longest(robot: AnyRobot, link: str) -> list[Nanoseconds]:
    axes = robot.axes_on(link)
    sequences = [(sequence(stop_stages_of(robot, axis), off=False), axis.top_speed) for axis in axes]
    return [max(seconds) for seconds in zip(*(sums(*one) for one in sequences), strict=True)]


def _within(stage: StopStage) -> str:
    slows = "" if stage.slows_within is None else f"{stage.slows_within // MILLISECOND} ms, "
    return f"{slows}{stage.within // MILLISECOND} ms"


def reached(robot: AnyRobot) -> tuple[AnyRobot, ...]:
    """Return a robot in the ways to reach it: over CAN or serially, with a loop on its board or not."""
    if Ar2Link.all_of(robot):
        return (robot,)
    if ShieldLink.all_of(robot):
        shown = (ShieldProtocol.ROS_ARDUINO_BRIDGE, ShieldProtocol.MW)
        return tuple(over_protocol(robot, spoken.value) for spoken in shown)
    return (robot, over_serial(robot)) if Epos2Link.all_of(robot) else (robot,)


def spoken(robot: AnyRobot, name: str) -> str:
    """Return how the devices on a link are reached, in words."""
    link = robot.links[name]
    return ", ".join((link.driver.value, *((link.protocol.value,) if isinstance(link, ShieldLink) else ())))


def _fitting(robot: AnyRobot, axis: Axis) -> Iterator[str]:
    for row in AXIS_INTERLOCKS:
        if Reports.ZERO in row.needs and not axis.needs_confirmation:
            continue
        fitting = row.fitting(reports_of(robot, axis))
        yield "none: refused" if fitting is None else fitting.name


def _on_the_wire(robot: AnyRobot, axis: Axis) -> str:
    return family_of(robot.links[axis.link]).wire_rules(robot, axis.link).permitted(axis)


def _instead(row: AxisInterlock) -> str:
    return "the driver is refused" if row.replacement is None else row.replacement.name


def severity(row: InterlockBase) -> str:
    """Return how serious it is: a warning that stops the whole robot is a stop."""
    stops_all = row.stops is None and row.severity is Severity.WARNING
    return "stop" if stops_all else row.severity.name.lower()


def _clear(row: InterlockBase) -> str:
    return f"{row.clear_after // MILLISECOND} ms" if row.clear_after else "at once"


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _yes(answer: object) -> str:
    return "yes" if answer else "-"
