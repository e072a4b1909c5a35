"""The run of a node on real ports until the user, the clock or a failure ends it."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Final

import typer

from firmware_bridge.cli.console import FAILED, UNCONFIRMED, held_up_by_nothing, one_message, refusal, say
from firmware_bridge.node import Node
from firmware_bridge.runtime.clock import Clock, LivedClock
from firmware_bridge.runtime.ports import LostPort, Port, PortError
from firmware_bridge.runtime.runner import IN_ORDER, Ending, run
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

UNREAD: Final = "SIGPIPE"
"""The output has lost its reader, who sees the exit status."""


def carry(
    node: Node,
    openers: Mapping[str, Callable[[], Port]],
    end: Nanoseconds,
    greeting: str,
    *failures: type[Exception],
    clock: Clock | None = None,
    unfinished: Callable[[], str] = str,
) -> None:
    """Open the ports, run a node on them in real time, and print how it ended.

    A port that cannot be opened ends the program with exit status 2; one that is lost under way, one of the
    node's own `failures`, and a node that could not be stopped in good order, with 1; its `unfinished` work,
    with 3. No output holds it up while it runs. An emulated device takes a `LivedClock`.
    """
    ports = _opened(openers)
    say(f"{greeting}; Ctrl-C ends it")
    with held_up_by_nothing():
        problems, unread = list[str](), False
        # From here on only the runner decides when it ends: a signal stops the robot first.
        try:
            ending = run(node, ports, clock or Clock(), until=end)
        except (LostPort, *failures) as failure:  # type: ignore[misc] # mypy does not see what is in them
            notes = [note for note in getattr(failure, "__notes__", ()) if note != IN_ORDER]
            problems.append("; ".join((str(failure), *notes)))
        # What was left undone is reported whatever ended the run; then the cause goes on.
        except BaseException:
            with suppress(typer.Exit):
                _complain([], unfinished())
            raise
        else:
            for line in _texts(ending, clock):
                say(line)
            problems += [] if ending.in_order else [ending.verdict]
            unread = ending.reason == UNREAD
        _complain(problems, unfinished())
        if unread:
            raise typer.Exit(FAILED)


def _opened(openers: Mapping[str, Callable[[], Port]]) -> dict[str, Port]:
    ports: dict[str, Port] = {}
    with one_message(PortError):
        try:
            for link, opener in openers.items():
                ports[link] = opener()
        # A port that is left open would keep the next run from it.
        except PortError:
            for port in ports.values():
                port.close()
            raise
    return ports


def _complain(problems: list[str], unfinished: str) -> None:
    """Say what is wrong, and end the program where something is."""
    left = [refusal(unfinished, UNCONFIRMED)] if unfinished else []
    # The cause is printed last.
    texts = left + [refusal(problem, FAILED) for problem in problems]
    if texts:
        raise texts[0]


def _texts(ending: Ending, clock: Clock | None) -> Iterator[str]:
    yield f"ended: {ending.reason}; never later than {ending.latest_wake / MILLISECOND:.1f} ms"
    if isinstance(clock, LivedClock) and clock.stalls:
        total = to_seconds(clock.stalled)
        yield f"stopped by the machine {clock.stalls} times, {total:.1f} s in all; its time stood still"
