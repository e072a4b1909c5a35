"""Command lines that click alone reads wrongly: values below zero, an option with or without a value."""

import re
from typing import Any, Final

from typer.core import TyperCommand

_NEGATIVE: Final = re.compile(r"-\d.*")
_NUMBER: Final = re.compile(r"\d+(\.\d+)?")
_REST: Final = "--"
WATCH: Final = ("--watch", "-w")
PERIOD: Final = "0.2"
"""Seconds between two looks where none are given."""


class NegativeValue(TyperCommand):
    """Takes `-500qc` for a value, which is the last argument, and not for a row of short options."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put values below zero behind everything else."""
        if _REST in args:
            return super().parse_args(ctx, args)
        below = [word for word in args if _NEGATIVE.fullmatch(word)]
        others = [word for word in args if not _NEGATIVE.fullmatch(word)]
        return super().parse_args(ctx, [*others, _REST, *below] if below else others)


class OptionalPeriod(TyperCommand):
    """Takes `--watch` or `-w` alone, too: what follows it is its value only where that is a number."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Give a lonely option its value."""
        full: list[str] = []
        for word, following in zip(args, [*args, ""][1:], strict=True):
            lonely = word in WATCH and not _NUMBER.fullmatch(following)
            full += [word, PERIOD] if lonely else [word]
        return super().parse_args(ctx, full)
