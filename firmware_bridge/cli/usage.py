"""Mistakes on the command line in the form of all other messages: what, where and what to do, in one line."""

import re
import sys
from collections.abc import Sequence
from functools import partial
from typing import Any, Final, NoReturn

import typer
from typer.core import TyperCommand, TyperGroup

from firmware_bridge.cli.console import WRONG_INPUT, say

# Typer uses click's class or a copy of its own, by version; the name is the same.
_Mistake: Final[Any] = next(one for one in typer.BadParameter.__mro__ if one.__name__ == "ClickException")
PROGRAM: Final = "firmware-bridge"
_VALUE: Final = re.compile(r"^Invalid value(?: for (?P<where>.+?))?: (?P<what>.*)$", re.DOTALL)
_NEAR: Final = re.compile(r" \(Possible \w+: (?P<names>[^)]*)\)$")


def _without_types(options: list[Any]) -> list[Any]:
    """Return the options, of which a flag shows no type: it takes no value."""
    for option in options:
        if getattr(option, "is_flag", False):
            option.metavar = ""
    return options


class PlainCommand(TyperCommand):
    """A command whose flags show no type in its help."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return its options, --help among them."""
        return _without_types(super().get_params(ctx))


class PlainGroup(TyperGroup):
    """A group of commands whose mistakes are shown as one message, and not in a frame."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,  # noqa: FBT001, FBT002 - as in the class above
        windows_expand_args: bool = True,  # noqa: FBT001, FBT002 - as above
        **extra: Any,
    ) -> Any:
        """Run a command line; unless `standalone_mode` is False, end the program with its exit status."""
        run = partial(
            super().main, args, prog_name, complete_var, windows_expand_args=windows_expand_args, **extra
        )
        if not standalone_mode:
            return run(standalone_mode=False)
        try:
            status = run(standalone_mode=False)
        except _Mistake as error:
            _end(error, self._called(sys.argv[1:] if args is None else args))
        except typer.Abort:
            say("firmware-bridge: aborted", err=True)
            sys.exit(1)
        # What a command returns is no status; only what it ends with is.
        sys.exit(status if isinstance(status, int) else 0)

    def get_params(self, ctx: Any) -> list[Any]:
        """Return its options, --help among them."""
        return _without_types(super().get_params(ctx))

    def _called(self, words: Sequence[str]) -> str:
        """Return the command that a line begins with; the parser leaves it out of some mistakes."""
        found: list[str] = []
        group: Any = self
        for word in words:
            group = getattr(group, "commands", {}).get(word)
            if group is None:
                break
            found.append(word)
        return " ".join(found)


def _end(error: Any, called: str) -> NoReturn:
    if type(error).__name__ == "NoArgsIsHelpError":
        # A group that is called alone shows its help; its message is the whole text.
        error.show()
        sys.exit(error.exit_code)
    context = getattr(error, "ctx", None)
    command = called if context is None else str(context.command_path).partition(" ")[2]
    say(text_of(error.format_message(), command), err=True)
    sys.exit(WRONG_INPUT)


def text_of(message: str, command: str) -> str:
    """Return a mistake as one message; `command` is the one that was called, empty for the program itself."""
    text = " ".join(message.split()).rstrip(".")
    near = _NEAR.search(text)
    if near is not None:
        text = f"{text[: near.start()]}; perhaps {near['names']}"
    value = _VALUE.match(text)
    if value is not None:
        where = (value["where"] or "").replace("'", "")
        what = value["what"][:1].lower() + value["what"][1:]
        text = f"{where}: {what}" if where else what
    text = text if text.startswith("-") else text[:1].lower() + text[1:]
    place = f"{command}: " if command else ""
    return f"firmware-bridge: {place}{text}; see '{' '.join(filter(None, (PROGRAM, command)))} -h'"
