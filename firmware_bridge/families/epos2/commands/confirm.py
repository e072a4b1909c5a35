"""Confirmation before a motion may start: on a terminal by a question, elsewhere by refusing."""

import sys

import typer

from firmware_bridge.cli.console import FAILED, refusal


def confirm(what: str, why: str, *, yes: bool) -> None:
    """Return when the user agrees; end the program where not, or where there is no one to ask."""
    if yes:
        return
    if not sys.stdin.isatty():
        raise refusal(f"{what}: {why}; use --yes where that is safe")
    if not typer.confirm(f"{what}: {why}. Is everyone clear of the machine?", default=False, err=True):
        raise refusal("nothing was done", FAILED)
