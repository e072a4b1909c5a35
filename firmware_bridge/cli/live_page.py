"""The live page at the command line: its port, and its address for the user."""

import signal
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from firmware_bridge.cli.console import one_message, say

if TYPE_CHECKING:
    from firmware_bridge.runtime.ports import Port

LiveOption: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--live",
        help="Show it on a page for a browser on this machine, whose address is printed; of a real robot the "
        "page can only stop it.",
    ),
]


def page_port() -> "Port":
    """Open the page's port, and print its address; a missing extra ends the program. PortError."""
    from firmware_bridge.extras import ExtraMissingError, from_extras

    with one_message(ExtraMissingError), from_extras():
        from firmware_bridge.live.socket import LiveSocket

    port = LiveSocket()
    say(f"live page: {port.name}")
    return port


def end_in_order() -> None:
    """End the run as Ctrl-C does: the runner stops the node first."""
    signal.raise_signal(signal.SIGINT)
