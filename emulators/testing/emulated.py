"""Devices in real time, as a test starts them: drives on a serial line or a bus, a board on a line."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from emulators.family import Trait, families, family_of
from emulators.testing.answering import BoardCall, LineCall, RollCall
from emulators.testing.buses import Bus
from emulators.testing.errors import RigError
from emulators.testing.process import Process
from firmware_bridge.robot.problems import near
from firmware_bridge.robot_types import find
from firmware_bridge.testing.control import Control, of_process

READY_WITHIN_S: Final = 60.0
"""Time for a device to be there, on a machine that has much to do."""
GREETING: Final = "Ctrl-C ends it"
"""The end of the line by which an emulator reports that its links are open."""
Start = Callable[[Sequence[str]], Process]
"""Function that runs `firmware-bridge` with these words."""


def family_named(name: str | None) -> str:
    """Return the family of drives of this name; None: that whose drives have a serial line, too. RigError."""
    known = {name: one for name, one in families().items() if Trait.DRIVE in one.traits}
    if name is None:
        return next(name for name, one in known.items() if one.presence is not None)
    if name not in known:
        raise RigError(f"drives of '{name}': {near(name, known)}")
    return name


class Drives:
    """Emulated drives of a family on a serial line, or on a CAN bus."""

    def __init__(self, start: Start, folder: Path) -> None:
        self._start: Final = start
        self._folder: Final = folder
        self._programs: Final[dict[str, Process]] = {}

    def __call__(self, nodes: str = "1", *more: str, on: Bus | None = None, family: str | None = None) -> str:
        """Start them, wait until they are there, and return where: the line's path, or the bus's channel.

        Without `on` the first is on a line, and the others are behind it. `more` are words of
        `firmware-bridge emulate FAMILY`. RigError where the family has no such drives; AssertionError, with
        what was printed, where they do not come.
        """
        family = family_named(family)
        words = ("emulate", family, "--node", nodes, *more)
        return self._on_a_line(nodes, words, family) if on is None else self._on_a_bus(nodes, words, on)

    def lose_power(self, nodes: str) -> None:
        """Take the power from drives that were started by this name; they say nothing any more."""
        self._named(nodes).kill()

    def fault(self, kind: str, *, nodes: str = "", for_s: float | None = None, **keys: Any) -> int:
        """Let a fault begin now, by its name and keys in missions; return its number, for `clear`.

        `nodes` are the drives as they were started, where there are several programs. ControlError for a
        fault that is not possible.
        """
        with self._control(nodes) as control:
            return control.inject(kind, for_s=for_s, **keys)

    def clear(self, number: int | None = None, *, nodes: str = "") -> None:
        """End a fault that is on, or all. They end with the test in any case: their program does."""
        with self._control(nodes) as control:
            control.clear(number)

    def input(self, axis: str, name: str, value: float, *, nodes: str = "") -> None:
        """Set an input of an axis: `drives.input("motor1", "input4", 1)`; ControlError."""
        with self._control(nodes) as control:
            control.set({f"{axis}.{name}": value})

    def _control(self, nodes: str) -> Control:
        if not nodes and len(self._programs) != 1:
            raise RigError(
                f"which drives? nodes= names them; started were: {', '.join(self._programs) or 'none'}"
            )
        return of_process(self._named(nodes or next(iter(self._programs))).pid)

    def _named(self, nodes: str) -> Process:
        if nodes not in self._programs:
            known = ", ".join(self._programs) or "none yet"
            raise RigError(f"no drives '{nodes}' were started; those that were: {known}")
        return self._programs[nodes]

    def _on_a_line(self, nodes: str, words: Sequence[str], family: str) -> str:
        presence = families()[family].presence
        if presence is None:
            raise RigError(f"drives of {family} have no serial line: put them on a bus, on=bus()")
        port = self._folder / f"drives-{nodes}.tty"
        program = self._started(nodes, *words, "--serial", "pty", "--serial-link", str(port))
        # The line does not exist before that.
        program.prints(GREETING, READY_WITHIN_S)
        with LineCall(str(port), nodes, partial(presence, "v2" if "v2" in words else "v1")) as call:
            program.waits(call.complete, f"all of {nodes} answering", READY_WITHIN_S)
        return str(port)

    def _on_a_bus(self, nodes: str, words: Sequence[str], bus: Bus) -> str:
        with RollCall(bus, nodes) as call:
            # A drive that is there already would answer in the place of the one that is started here.
            there = call.answering()
        if there:
            who = ", ".join(f"node {node}" for node in there)
            raise RigError(
                f"{who} on {bus.channel} answers already, before it was started: a drive of another run, or "
                "a real one? End it (ps -e | grep firmware-bridge), or take other nodes or another bus"
            )
        program = self._started(nodes, *words, *bus.words)
        program.prints(GREETING, READY_WITHIN_S)
        with RollCall(bus, nodes) as call:
            program.waits(call.complete, f"all of {nodes} answering on {bus.channel}", READY_WITHIN_S)
        return bus.channel

    def _started(self, nodes: str, *words: str) -> Process:
        self._programs[nodes] = self._start(words)
        return self._programs[nodes]


class Boards:
    """Emulated Arduinos, each with what it drives, on serial lines."""

    def __init__(self, start: Start, folder: Path) -> None:
        self._start: Final = start
        self._folder: Final = folder
        self._newest: Process | None = None

    def __call__(self, what: str, *more: str, protocol: str | None = None) -> str:
        """Put one on a line, wait until it answers, and return the line's path.

        `what` is a firmware of `firmware-bridge emulate board`, or a robot with one board; `more` are further
        words of the command that emulates it. RigError for what is neither.
        """
        words, spoken = _command(what, protocol)
        port = self._folder / f"{Path(what).stem}.tty"
        program = self._start(("emulate", *words, "--serial", "pty", "--serial-link", str(port), *more))
        program.prints(GREETING, READY_WITHIN_S)
        with BoardCall(str(port), spoken) as call:
            program.waits(call.complete, f"answering in {spoken}", READY_WITHIN_S)
        self._newest = program
        return str(port)

    def fault(self, kind: str, *, for_s: float | None = None, **keys: Any) -> int:
        """Let a fault of the newest board begin now; return its number, for `clear`. ControlError."""
        with self._control() as control:
            return control.inject(kind, for_s=for_s, **keys)

    def clear(self, number: int | None = None) -> None:
        """End a fault that is on, or all. They end with the test in any case: their program does."""
        with self._control() as control:
            control.clear(number)

    def _control(self) -> Control:
        if self._newest is None:
            raise RigError("no board was started: board(...) puts one on a line")
        return of_process(self._newest.pid)


def _firmwares() -> list[str]:
    """Return the protocols of boards of which more than one may be on a link: they have a command alone."""
    own = (family.questions for family in families().values() if len(family.questions) > 1)
    return [name for questions in own for name in questions]


def _command(what: str, protocol: str | None) -> tuple[tuple[str, ...], str]:
    """Return the words that emulate this, and what is spoken to it."""
    if what in _firmwares():
        _speaks_one(what, protocol, what)
        return ("board", "--firmware", what), what
    robot = find(what)
    boards = [
        protocols(robot, link) for link in robot.links if (protocols := family_of(robot, link).protocols)
    ]
    # One serial line, one board.
    if len(boards) != 1:
        known = ", ".join(_firmwares())
        raise RigError(f"{what} has not one board; give a robot that has, or a firmware: {known}")
    ((own, *others),) = boards
    if not others:
        _speaks_one(what, protocol, None)
        return (what,), own
    spoken = protocol or own
    if spoken not in {own, *others}:
        raise RigError(f"{what}: there is no protocol '{spoken}'; there are {', '.join(_firmwares())}")
    return (what, "--protocol", spoken), spoken


def _speaks_one(what: str, protocol: str | None, own: str | None) -> None:
    if protocol not in {None, own}:
        raise RigError(f"{what} speaks one protocol, and no other: leave out protocol='{protocol}'")
