"""`robots`: the installed robots and their files, each one checked; and the schema of a kind's robot file."""

import json
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge import robot_types
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.tables import print_grid, print_lines, terminal
from firmware_bridge.family import family_of
from firmware_bridge.robot import AnyRobot, RobotFileError

EXAMPLES: Final = """Examples:

`firmware-bridge robots` lists them, a line each.

`firmware-bridge robots rover` shows one in full, `robots my_robot.toml` a file of your own.

`firmware-bridge robots --schema rars > rars.schema.json` gives an editor all keys of such a file."""


@command(EXAMPLES)
def robots(
    wanted: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT|FILE",
            help="Only these: installed robots, or robot files.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None,
    *,
    schema: Annotated[
        str | None,
        typer.Option(
            metavar="KIND",
            help="Print the JSON schema of this kind's robot files instead.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None,
) -> None:
    """List the robots that are installed, each file checked, with all its mistakes at once.

    A line each; those that are named are shown in full.
    """
    if schema is not None:
        with one_message(RobotFileError):
            say(json.dumps(robot_types.schema_of(schema), indent=2))
        return
    wrong = _shown(wanted) if wanted else _listed()
    if wrong:
        raise refusal("\n".join(map(str, wrong)))


def _listed() -> list[Exception]:
    """Print a line for each installed robot; return what is wrong with the others."""
    rows, wrong = [("robot", "axes", "check", "devices", "")], list[Exception]()
    for name in robot_types.robots():
        try:
            # With the plant, so that a wrong parameter is reported here and not at the bench's start.
            robot = robot_types.find(name, plant_too=True)
        except RobotFileError as error:
            wrong.append(error)
            rows.append((name, "", "wrong", "", ""))
            continue
        devices = ", ".join(dict.fromkeys(link.driver.value for link in robot.links.values()))
        rows.append((name, str(len(robot.axes)), "good", devices, robot.title))
    for name, why in robot_types.unloadable().items():
        wrong.append(why)
        rows.append((name, "", "cannot be loaded", "", ""))
    styles = [{"good": "", "check": "bold"}.get(row[2], "red") for row in rows]
    print_lines(rows, styles=styles)
    terminal().print("\nfirmware-bridge robots ROBOT: its axes, links, file and checks", style="dim")
    return wrong


def _shown(wanted: Iterable[str]) -> list[Exception]:
    """Print each robot that is named in full; return what is wrong with the others."""
    console, wrong = terminal(), list[Exception]()
    for name, path in _named(wanted):
        # A file of one's own has the name given in it.
        read = partial(robot_types.find, name) if name else partial(robot_types.load, path)
        try:
            robot = read(plant_too=True)
        except RobotFileError as error:
            wrong.append(error)
            console.print(f"{name or path}: [red]wrong[/]")
            continue
        console.print(f"[bold]{name or robot.name}[/]  {robot.title}")
        print_grid(_rows(robot, path))
    return wrong


def _named(wanted: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """Yield each robot's name and file; the name is empty where it is a path."""
    installed = robot_types.robots()
    for word in wanted:
        path = Path(word)
        # A name wins over a folder of the same name; a path has a suffix or is a file.
        named = word in installed or (path.name == word and path.suffix != ".toml" and not path.is_file())
        yield (word, installed.get(word, Path())) if named else ("", path)


def _rows(robot: AnyRobot, path: Path) -> Iterator[tuple[str, str]]:
    """Yield what is shown of one robot: a heading, and its lines."""
    yield "axes", "\n".join(f"{axis.settings.number} {axis.title}" for axis in robot.axes)
    yield "links", "\n".join(family_of(link).shown(robot, name) for name, link in robot.links.items())
    yield "file", str(path)
    yield "check", "[green]good[/]"
    weaker: dict[str, list[str]] = {}
    for axis, strong, row in robot_types.weaker_rows(robot):
        weaker.setdefault(f"{row.name} in place of {strong.name}", []).append(axis)
    # Checks with the same axes name them once.
    alike: dict[tuple[str, ...], list[str]] = {}
    for what, axes in weaker.items():
        alike.setdefault(tuple(axes), []).append(what)
    for those, checks in alike.items():
        whom = "all axes" if len(those) == len(robot.axes) else ", ".join(those)
        yield "weaker checks", "\n".join((f"{whom}, which lack a report:", *checks))
