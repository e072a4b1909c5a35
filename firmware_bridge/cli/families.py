"""`families`: the installed families of devices: links, axes, reports, and their own stop."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Annotated, Final

import typer

from firmware_bridge import robot_types
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import refusal
from firmware_bridge.cli.tables import print_grid, terminal
from firmware_bridge.family import Family, families, family_of, unloadable
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.family_tables import words_of
from firmware_bridge.robot.problems import near

EXAMPLES: Final = """Examples:

`firmware-bridge families` lists them.

`firmware-bridge families epos2` shows one."""


@command(EXAMPLES)
def shown(
    wanted: Annotated[
        list[str] | None,
        typer.Argument(metavar="FAMILY", help="Only these.", show_default=False),
    ] = None,
) -> None:
    """List the families of devices: links, axes, reports, watchdog and robots.

    A package adds a family by an entry point in the group `firmware_bridge.families`.
    """
    known = {family.name: family for family in families()}
    for name in wanted or ():
        if name not in known and name not in unloadable():
            raise refusal(f"no family '{name}' is installed; {near(name, known)}")
    console = terminal()
    for name, family in known.items():
        if not wanted or name in wanted:
            console.print(f"[bold]{name}[/]  {family.title}")
            print_grid(_rows(family))
    broken = [f"{name}: {why}" for name, why in unloadable().items() if not wanted or name in wanted]
    if broken:
        raise refusal("\n".join(broken))


def _rows(family: Family) -> Iterator[tuple[str, str]]:
    """Yield what is shown of one family: a heading, and its lines."""
    yield "driver", ", ".join(words_of(family.link, "driver"))
    for kind, table in (("axis", family.axis), ("sensor", family.sensor), ("output", family.output)):
        if table is not None:
            devices = ", ".join(words_of(table, "device"))
            yield kind, devices or ", ".join(table.model_fields)
    reports, alone, robots = set[str](), set[str](), []
    for named, robot in _robots():
        own = [name for name, link in robot.links.items() if family_of(link) is family]
        if own:
            robots.append(named)
        alone |= {family.alone(robot, name) for name in own} - {""}
        for axis in robot.axes:
            if axis.link in own:
                reports |= {report.value for report in family.reports(robot, axis)}
    if family.axis is not None:
        yield "reports", ", ".join(sorted(reports)) or "by the robot file"
        yield "watchdog", "\n".join(sorted(alone)) or "none: it keeps its last command"
    yield "robots", ", ".join(robots) or "none that is installed"


def _robots() -> Iterator[tuple[str, AnyRobot]]:
    for name in robot_types.robots():
        # What is wrong with a robot file is the matter of `robots`.
        with suppress(RobotFileError):
            yield name, robot_types.find(name)
