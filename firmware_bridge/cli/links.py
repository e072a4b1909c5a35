"""Opening of the links of emulated devices."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TypeAlias

from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.outside import Outside
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.runtime.ports import Port, PortError, PseudoTerminal, SeenOpening, SerialLine, open_can
from firmware_bridge.runtime.ports.pseudo_terminal import WORD

Openers: TypeAlias = dict[str, Callable[[], Port]]


def open_serial(
    device: str, baud: int, link: Path | None = None, *, reports_dtr: bool = False, any_rate: bool = False
) -> Port:
    """Open a serial device, or make a pseudo-terminal with a link to it; PortError.

    One that reports DTR reports a client's opening and closing. With `any_rate` any bit rate will do.
    """
    if device == WORD:
        rate = None if any_rate else baud
        if reports_dtr:
            return SeenOpening(link, rate, say)
        # Seen opening, a client that takes the line for itself can open it again; on other systems it cannot.
        with suppress(PortError):
            return SeenOpening(link, rate, say, reports_dtr=False)
        return PseudoTerminal(link, rate, say)
    if link is not None:
        raise PortError(f"--serial-link {link}: only a pseudo-terminal wants a link; use --serial {WORD}")
    return SerialLine(device, baud)


def on_the_line(outside: Outside, nodes: Sequence[int]) -> int:
    """Return which of these nodes is on the serial line; one that is not there ends the program."""
    node = outside.serial_node
    if node is not None and outside.serial is None:
        raise refusal(f"--serial-node {node}: there is no serial line; use --serial {WORD}, too")
    if node is not None and node not in nodes:
        raise refusal(f"--serial-node {node}: there is no such node; there are {', '.join(map(str, nodes))}")
    return nodes[0] if node is None else node


def opened(
    outside: Outside, spoken: str, baud: int, default_bit_rate: int, *, any_rate: bool
) -> tuple[Openers, str]:
    """Return what opens each link, and how they are called; a line that cannot be ends the program.

    The line comes at once, because its name is found out only then. The CAN bus is left out where there is a
    line and no bus was named.
    """
    found: Openers = {}
    where = []
    if outside.serial is not None:
        with one_message(PortError):
            line = open_serial(outside.serial, baud, outside.serial_link, any_rate=any_rate)
        found[SERIAL] = lambda: line
        where.append(f"{line.name} ({spoken})")
    if outside.serial is None or outside.interface or outside.channel:
        found[CAN] = lambda: open_can(
            outside.interface, outside.channel, outside.bit_rate, default_bit_rate=default_bit_rate, say=say
        )
        where.append("the bus")
    return found, " and ".join(where)
