"""Gives a command the options that say which drive it speaks to, over which link, and hands it the line."""

from collections.abc import Callable
from functools import wraps
from inspect import Signature, signature
from typing import Any

from firmware_bridge.cli.epos2.line import line_to
from firmware_bridge.cli.epos2.options import NodeOption

Command = Callable[..., None]
"""A command whose first argument is the `Line` to its drive."""


def one_drive(node: Any = NodeOption) -> Callable[[Command], Command]:
    """Put the parameters of `line_to` in the place of a command's first; `node` is how the drive is named."""
    line = [
        each.replace(annotation=node) if each.name == "node" else each
        for each in signature(line_to).parameters.values()
    ]

    def with_options(command: Command) -> Command:
        _, *own = signature(command).parameters.values()

        @wraps(command)
        def called(**given: Any) -> None:
            drive = line_to(**{each.name: given.pop(each.name) for each in line})
            command(drive, **given)

        arguments = [each for each in own if each.kind is not each.KEYWORD_ONLY]
        options = [each for each in own if each.kind is each.KEYWORD_ONLY]
        # What typer reads to learn a command's options.
        setattr(called, "__signature__", Signature([*arguments, *line, *options]))  # noqa: B010 - no such attribute in its type
        return called

    return with_options
