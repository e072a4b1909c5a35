"""`--plotjuggler`: the values of a run, sent to a plotter over UDP."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final, TypeAlias

import typer

from firmware_bridge.cli.console import say
from firmware_bridge.node import Node

if TYPE_CHECKING:
    from firmware_bridge.live.state import Json
    from firmware_bridge.runtime.ports import Port
    from firmware_bridge.units import Nanoseconds

LOOPBACK: Final = "127.0.0.1"

PlotOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--plotjuggler",
        metavar="PORT|HOST:PORT",
        help="Send values of drives, pose and operator's link as JSON over UDP, up to 50 times a second: to "
        "a port of this machine, 9870 in PlotJuggler's UDP server, or to another host where one is named.",
        show_default=False,
    ),
]
Openers: TypeAlias = dict[str, Callable[[], "Port"]]


def plotted(node: Node, place: str | None, openers: Openers, values: "Callable[[Nanoseconds], Json]") -> Node:
    """Return a node whose values are sent to a place, and put its port beside the others; itself for None.

    PortError, when the port is opened, for a place that is none.
    """
    if place is None:
        return node
    from firmware_bridge.live.plotted import PLOTS, Plotted

    openers[PLOTS] = partial(_port, place)
    return Plotted(node, values)


def _port(place: str) -> "Port":
    from firmware_bridge.runtime.ports import PortError, UdpPort

    full = f"{LOOPBACK}:{place}" if place.isdecimal() else place
    try:
        port = UdpPort(f"udpout:{full}")
    except PortError as error:
        raise PortError(f"--plotjuggler {place}: {error}; give a port, as 9870, or HOST:PORT") from None
    say(f"values for PlotJuggler go to {full}")
    return port
