"""A group of commands, one of which takes the names that the others do not: `emulate ROBOT`."""

from typing import Any, Final

from typer.core import TyperGroup

DEFAULT: Final = "robot"


class ByName(TyperGroup):
    """Runs `robot` for words that are no command of the group, options in front included."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Put the default command in front of words that name none."""
        known = args[0] in self.commands
        return super().resolve_command(ctx, args if known else [DEFAULT, *args])
