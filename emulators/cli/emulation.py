"""The common part of all `emulate`: devices as one node, their ports, recording, and the run in real time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from typer.core import TyperCommand

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import until
from firmware_bridge.cli.recorded import recording
from firmware_bridge.node import Node

if TYPE_CHECKING:
    from emulators.control.live import Live
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.runtime.clock import LivedClock
    from firmware_bridge.runtime.ports.control_socket import ControlSocket

UNIX: Final = "unix"
NONE: Final = "none"
Options = TypeVar("Options", bound="RunOptions")


class RunOptions(Protocol):
    """The options of every `emulate`."""

    @property
    def duration(self) -> float | None:
        """Time in s after which it ends; None: on Ctrl-C."""


def _itself(node: Node) -> Node:
    return node


@dataclass(frozen=True, slots=True, kw_only=True)
class Emulation:
    """Emulated devices, ready to run."""

    node: Node
    """All of them; what is recorded is what it receives and sends."""
    opened: "Callable[[], tuple[Openers, str]]"
    """Open what is named at once; return the links' openers, and how these are called. PortError."""
    text: Callable[[str], str]
    """Describe them, with what `opened` has called its links."""
    errors: tuple[type[Exception], ...] = ()
    """Errors of the run that end the program with one message."""
    files: Mapping[str, str] = field(default_factory=dict)
    """Files of a recording, by the links."""
    called: Mapping[str, str] = field(default_factory=dict)
    """Names of links in a recording, where they are not the links' own."""
    around: Callable[[Node], Node] = _itself
    """Put what is not recorded around the recorded node."""
    ended: Callable[[], str] | None = None
    """Describe what is left at the end; None for nothing."""
    live: "Callable[[], Live] | None" = None
    """Return its parts, for the control port; None where it has none."""


class _Reports:
    """What reports a text to all who want it."""

    def __init__(self, first: Callable[[str], None]) -> None:
        self.to: Final = [first]

    def __call__(self, text: str) -> None:
        """Report it."""
        for one in self.to:
            one(text)


def run(given: RunOptions, emulation: Emulation) -> None:
    """Run emulated devices in real time; an error ends the program with a message."""
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.runtime.clock import LivedClock
    from firmware_bridge.runtime.ports import PortError

    box = recording(getattr(given, "record", None), emulation.files, called=emulation.called)
    place, faults = getattr(given, "control", NONE), getattr(given, "fault", None) or ()
    plots, page = getattr(given, "plotjuggler", None), getattr(given, "live", False)
    needed = faults or plots or page or place != NONE
    with box as (around, report):
        reports, clock = _Reports(report), LivedClock()
        # Before the ports: a host that has opened one must not wait for it.
        live = None if emulation.live is None or not needed else emulation.live()
        if live is not None:
            _loaded(page=page, plots=plots is not None)
            _planned(live, faults, reports)
        with one_message(PortError):
            openers, where = emulation.opened()
        node = emulation.around(around(emulation.node))
        node, openers = _plotted(node, openers, live, plots)
        if live is not None and (page or place != NONE):
            node, openers = _controlled(node, openers, live, given, (reports, clock))
        carry(
            node,
            openers,
            until(given.duration),
            emulation.text(where),
            *emulation.errors,
            clock=clock,
        )
    if emulation.ended is not None:
        say(emulation.ended())


def _loaded(*, page: bool, plots: bool) -> None:
    """Load what will stand around the devices before their ports are opened: no host waits for it then."""
    modules = ["emulators.control.desk"]
    modules += ["emulators.live.devices", "firmware_bridge.cli.live_page"] if page else []
    modules += ["emulators.live.plot_values"] if plots else []
    for name in modules:
        import_module(name)


def _planned(live: "Live", faults: Sequence[str], report: Callable[[str], None]) -> None:
    """Plan the faults of the command line; one that cannot be ends the program with a message."""
    from emulators.control.keys import WordError
    from emulators.control.words import beginning, fault_of, plan, planned

    for text in faults:
        try:
            fault = fault_of(live, planned(text))
            plan(live, [fault])
        except WordError as error:
            raise refusal(f"--fault {text}: {error}") from None
        live.carrier.call_at(fault.begin, report, beginning(live, fault))


def _plotted(
    node: Node, openers: "Openers", live: "Live | None", place: str | None
) -> "tuple[Node, Openers]":
    """Put what sends the devices' values around a node, and its port beside the others."""
    if live is None or place is None:
        return node, openers
    from emulators.live.plot_values import of_devices
    from firmware_bridge.cli.plot_option import plotted

    found = dict(openers)
    return plotted(node, place, found, of_devices(live)), found


def _controlled(
    node: Node, openers: "Openers", live: "Live", given: RunOptions, run: "tuple[_Reports, LivedClock]"
) -> "tuple[Node, Openers]":
    """Put the control desk around a node, and the page where that is wanted, with their ports."""
    from emulators.control.desk import CONTROL, Desk

    found, where, title = dict(openers), getattr(given, "control", NONE), live.robot.name
    node = desk = Desk(node, live, *run)
    if where != NONE:
        found[CONTROL] = lambda: control_port(where, title)
    if getattr(given, "live", False):
        from emulators.live.devices import LiveDevices
        from firmware_bridge.cli.live_page import page_port
        from firmware_bridge.live.messages import LIVE

        node = page = LiveDevices(desk, live, getattr(given, "bit_rate", None))
        run[0].to.append(page.report)
        found[LIVE] = page_port
    return node, found


def control_port(where: str, title: str) -> "ControlSocket":
    """Open the control port; by default devices run without it where that is not possible. PortError."""
    from firmware_bridge.runtime.ports import PortError
    from firmware_bridge.runtime.ports.control_socket import ControlSocket

    try:
        port = ControlSocket(where, title)
    except PortError as error:
        if where != UNIX:
            raise
        # As on a machine without a folder for it.
        say(f"without a control port: {error}", err=True)
        return ControlSocket(NONE, title)
    if port.token:
        say(f"control port {port.name}, token {port.token}")
    return port


def emulating(options: type[Options], examples: str, start: Callable[[Options], Emulation]) -> TyperCommand:
    """Make `emulate FAMILY` of the family's options, and of what makes its devices from them."""
    return command(examples, work=lambda given: run(given, start(given)))(options)
