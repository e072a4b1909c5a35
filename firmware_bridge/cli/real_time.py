"""Runs a node on real ports until the user, the clock or a failure ends it."""

from collections.abc import Callable, Mapping

from firmware_bridge.cli.console import FAILED, one_message, refusal, say
from firmware_bridge.node import Node
from firmware_bridge.shell.clock import Clock, LivedClock
from firmware_bridge.shell.ports import LostPort, Port, PortError
from firmware_bridge.shell.runner import run
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds


def carry(
    node: Node,
    openers: Mapping[str, Callable[[], Port]],
    end: Nanoseconds,
    greeting: str,
    *failures: type[Exception],
    clock: Clock | None = None,
) -> None:
    """Open the ports, run a node on them in real time, and say how it ended.

    A port that cannot be opened ends the program with exit status 2; one that is lost under way, one of the
    node's own `failures`, and a node that could not be stopped in good order, with 1. An emulated device
    takes a `LivedClock`.
    """
    ports: dict[str, Port] = {}
    with one_message(PortError):
        try:
            for link, opener in openers.items():
                ports[link] = opener()
        except PortError:
            for port in ports.values():
                port.close()
            raise
    say(f"{greeting}; Ctrl-C ends it")
    with one_message(LostPort, *failures, status=FAILED):
        ending = run(node, ports, clock or Clock(), until=end)
    say(f"ended: {ending.reason}; never later than {ending.latest_wake / MILLISECOND:.1f} ms")
    if isinstance(clock, LivedClock) and clock.stalls:
        total = to_seconds(clock.stalled)
        say(f"stopped by the machine {clock.stalls} times, {total:.1f} s in all; its time stood still")
    if not ending.in_order:
        raise refusal(
            "it did not stop in good order; the drives' own watch over the bridge must do it", FAILED
        )
