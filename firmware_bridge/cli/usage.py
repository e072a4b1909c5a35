"""Mistakes on the command line in the form of all other messages: what, where and what to do, in one line."""

import re
import sys
from collections.abc import Sequence
from functools import partial
from typing import Any, Final, NoReturn

import typer
from typer.core import TyperGroup

from firmware_bridge.cli.console import WRONG_INPUT, say

# Typer uses click's class or a copy of its own, by version; the name is the same.
_Mistake: Final[Any] = next(one for one in typer.BadParameter.__mro__ if one.__name__ == "ClickException")
_VALUE: Final = re.compile(r"^Invalid value(?: for (?P<where>.+?))?: (?P<what>.*)$", re.DOTALL)
_NEAR: Final = re.compile(r" \(Possible \w+: (?P<names>[^)]*)\)$")


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
        run = partial(super().main, args, prog_name, complete_var, False, windows_expand_args, **extra)  # noqa: FBT003 - as above
        if not standalone_mode:
            return run()
        try:
            status = run()
        except _Mistake as error:
            _end(error)
        except typer.Abort:
            say("firmware-bridge: aborted", err=True)
            sys.exit(1)
        # What a command returns is no status; only what it ends with is.
        sys.exit(status if isinstance(status, int) else 0)


def _end(error: Any) -> NoReturn:
    if type(error).__name__ == "NoArgsIsHelpError":
        # A group that is called alone shows its help; its message is the whole text.
        error.show()
        sys.exit(error.exit_code)
    say(text_of(error.format_message(), _path(error)), err=True)
    sys.exit(WRONG_INPUT)


def _path(error: Any) -> str:
    context = getattr(error, "ctx", None)
    return "firmware-bridge" if context is None else str(context.command_path)


def text_of(message: str, path: str) -> str:
    """Return a mistake as one message; `path` is the command that was called, with the program's name."""
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
    command = path.partition(" ")[2]
    place = f"{command}: " if command else ""
    return f"firmware-bridge: {place}{text}; see '{path} -h'"
