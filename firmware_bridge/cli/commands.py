"""The program's commands: rows with one line of help each; a command is imported when it is called.

So `--help` lists everything that is installed and imports none of it.
"""

import importlib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import wraps
from inspect import cleandoc
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import typer
from typer.core import TyperCommand

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.cli.usage import PlainCommand, PlainGroup

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

DISTRIBUTION: Final = "firmware-bridge"
COMMAND_GROUP: Final = "firmware_bridge.commands"
"""Entry points of this group are tuples of rows."""
MARKUP: Final = "markdown"
STATUSES: Final = """Exit status 0 after an orderly end; 1 after a failure, or if it could not start; 2 for
a wrong argument, option or file."""
"""Exit statuses of a command whose own help names none."""
_NAMES_STATUSES: Final = re.compile(r"\bstatus\s+[012]\b")


@dataclass(frozen=True, slots=True)
class CliCommand:
    """One command."""

    words: str
    """Name on the command line: "drive", or, in a group, "epos2 read"."""
    made_in: str
    """"module:name" of what `command` has made there."""
    line: str
    """Summary in the list of commands, and the begin of the command's own help."""

    def load(self) -> TyperCommand:
        """Import the command; see `imported`."""
        found = imported(self.made_in)
        if not isinstance(found, TyperCommand):
            raise TypeError(f"{self.made_in} is no command, but {found!r}; make it with @command")
        return found


@dataclass(frozen=True, slots=True)
class Group:
    """A group: a name with commands behind it."""

    words: str
    line: str
    epilog: str
    kind: "type[Rows] | None" = None
    context_settings: Mapping[str, Any] = field(default_factory=dict)


Row: TypeAlias = CliCommand | Group


class Promised(TyperCommand):
    """Placeholder in a group for a command that is imported only when it is called."""

    def __init__(self, row: CliCommand) -> None:
        super().__init__(row.words.split()[-1], help=row.line, rich_markup_mode=None)
        self._row = row

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        """Let the command itself parse its arguments."""
        return self._row.load().make_context(info_name, args, parent, **extra)


def command(
    examples: str, *, kind: type[PlainCommand] = PlainCommand, work: Callable[[Any], None] | None = None
) -> Callable[[Callable[..., Any]], TyperCommand]:
    """Make a command of a function: its parameters are the options, its docstring is the help.

    In the place of a function may stand a dataclass, which defines the options once: `work` takes one, when
    all options are parsed. Modules not needed for help and errors are imported by the command where they are
    used. A help that names no exit status ends with `STATUSES`.
    """

    def made(function: Callable[..., Any]) -> TyperCommand:
        alone = typer.Typer(add_completion=False, rich_markup_mode=MARKUP, pretty_exceptions_enable=False)
        text = cleandoc(function.__doc__ or "")
        if _NAMES_STATUSES.search(text) is None:
            text = f"{text}\n\n{STATUSES}"
        # What a reader looks for first: the sentence, and what to type.
        sentence, _, more = text.partition("\n\n")
        text = "\n\n".join(filter(None, (sentence, examples, more)))
        called = function if work is None else _worked(function, work)
        alone.command(cls=kind, help=text)(called)
        found = typer.main.get_command(alone)
        assert isinstance(found, TyperCommand)  # noqa: S101 - one function alone makes no group
        return found

    return made


def imported(place: str) -> Any:
    """Return what "module:name" names; one that cannot be imported ends the program with a message."""
    module, _, name = place.partition(":")
    try:
        return getattr(importlib.import_module(module), name)
    except ImportError as error:
        raise refusal(f"this command cannot be loaded: {error}; is all of it installed?") from None


def completing(place: str) -> Callable[[], list[str]]:
    """Return a completion that imports "module:function" on the shell's request."""

    def words() -> list[str]:
        return list(imported(place)())

    return words


def _worked(signature: Callable[..., Any], work: Callable[[Any], None]) -> Callable[..., None]:
    # `updated` is empty, as the attributes of a class are none of a function's.
    @wraps(signature, updated=())
    def called(**given: Any) -> None:
        work(signature(**given))

    return called


class Rows(PlainGroup):
    """A group that has the program's own commands at hand, and looks for others only when they are wanted.

    So nothing that is installed beside the program delays a stop, or takes a command's place. Its help is
    plain text: to import what prints Markdown takes longer than all the rest.
    """

    tree: "Tree | None" = None

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command of this name: of this distribution, or else of any that is installed."""
        if cmd_name not in self.commands and self.tree is not None:
            self.tree.add_own()
        if cmd_name not in self.commands:
            self.complete()
        return super().get_command(ctx, cmd_name)

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands."""
        self.complete()
        return super().list_commands(ctx)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, each with the whole of its first paragraph."""
        helps = {name: str(self.get_command(ctx, name).help) for name in self.list_commands(ctx)}
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, text.partition("\n\n")[0].replace("`", "")) for name, text in helps.items()]
            )

    def complete(self) -> None:
        """Add the commands of the installed packages, once."""
        if self.tree is not None:
            self.tree.complete()


class Tree:
    """Groups by their names, filled with rows."""

    def __init__(self, root: Rows, own: Iterable[Row]) -> None:
        self._groups = {"": root}
        self._own = False
        self._complete = False
        root.tree = self
        self._put(own)

    def add_own(self) -> None:
        """Add the rows of this distribution's entry points, once: a single file names them."""
        if not self._own:
            self._own = True
            self._add(own())

    def complete(self) -> None:
        """Add the rows of the other installed packages, once."""
        self.add_own()
        if not self._complete:
            self._complete = True
            self._add(installed())

    def _add(self, rows: Iterable[Row]) -> None:
        # Groups first: a package may add a command to another one's group.
        self._put(sorted(rows, key=lambda row: isinstance(row, CliCommand)))

    def _put(self, rows: Iterable[Row]) -> None:
        for row in rows:
            place, _, name = row.words.rpartition(" ")
            group = self._groups.get(place)
            if group is None:
                _left_out(row.words, f"there is no group '{place}'")
            # A package adds commands and never replaces one: `drive` must stay this program's own.
            elif name in group.commands:
                _left_out(row.words, "there is one of this name")
            elif isinstance(row, CliCommand):
                group.commands[name] = Promised(row)
            else:
                self._groups[row.words] = group.commands[name] = self._group(row, name)

    def _group(self, row: Group, name: str) -> Rows:
        made = (row.kind or Rows)(
            name=name,
            help=row.line,
            epilog=row.epilog,
            no_args_is_help=True,
            rich_markup_mode=None,
            context_settings=dict(row.context_settings),
        )
        made.tree = self
        return made


def own() -> Iterable[Row]:
    """Return the rows of this distribution's own entry points; none where it is not installed."""
    from importlib import metadata

    try:
        entries = metadata.distribution(DISTRIBUTION).entry_points
    except metadata.PackageNotFoundError:
        return ()
    return _rows_of(entries.select(group=COMMAND_GROUP))


def installed() -> Iterable[Row]:
    """Return the rows of every other installed package that has some, in the order of the packages' names."""
    # To read what is installed takes as long as a stop may.
    from importlib import metadata

    entries = metadata.entry_points(group=COMMAND_GROUP)
    return _rows_of(entry for entry in entries if entry.dist is None or entry.dist.name != DISTRIBUTION)


def _rows_of(entries: "Iterable[EntryPoint]") -> Iterator[Row]:
    """Yield the rows of entry points.

    A package that cannot be imported must not keep the bridge from running: it is named and left out.
    """
    for entry in sorted(entries, key=lambda entry: entry.name):
        try:
            yield from entry.load()
        except (ImportError, AttributeError) as error:
            say(f"firmware-bridge: the commands of '{entry.name}' are left out: {error}", err=True)


def _left_out(words: str, why: str) -> None:
    say(f"firmware-bridge: the command '{words}' is left out: {why}", err=True)
