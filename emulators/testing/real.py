"""Real drives in a test, in the place of emulated ones: found before it, and stopped after it."""

import json
from collections.abc import Callable, Iterator
from typing import Final
from unittest import SkipTest

from emulators.testing.buses import Bus
from emulators.testing.emulated import READY_WITHIN_S, Start, family_named
from emulators.testing.errors import RigError
from emulators.testing.process import Process
from firmware_bridge.cli.node_numbers import numbers

LINE: Final = "v1:/dev/ttyUSB0"
"""Example of a line's name."""
VELOCITY: Final = "0x2028"
"""Averaged; the plain one, 0x606C, trembles by a count a millisecond."""
AT_REST_RPM: Final = 5
"""Assumed: slower than that a motor behind its gear is as good as at standstill."""
LOOKS: Final = 20
"""Each takes half a second, the time of a process."""


class RealDrives:
    """The drives that are on a bus or behind a line; SkipTest for what can be done to emulated ones only."""

    def __init__(self, start: Start, line: str | None, *, moved: bool) -> None:
        """Take the line, as --serial-line has it, and the permission to move; RigError for no line."""
        self._start: Final = start
        self._moved: Final = moved
        self._taken: Final[list[tuple[str, ...]]] = []
        spoken, _, self._device = (line or LINE).partition(":")
        if not self._device or spoken not in {"v1", "v2"}:
            raise RigError(f"--serial-line {line}: give PROTOCOL:DEVICE, as {LINE} or v2:/dev/ttyUSB0")
        self._line: Final = None if line is None else ("--serial", self._device, "--protocol", spoken)

    def __call__(self, nodes: str = "1", *more: str, on: Bus | None = None, family: str | None = None) -> str:
        """See that they answer, and return where they are, as for emulated ones; nothing is written.

        AssertionError, with what was printed, for one that does not answer.
        """
        if family_named(family) != family_named(None):
            raise SkipTest(f"real drives are not found here as {family}: only those with a serial line are")
        if more:
            raise SkipTest(f"real drives are what they are, and take no {more[0]}")
        place = self._line if on is None else on.words
        if place is None:
            raise SkipTest(f"needs a line to real drives: --serial-line {LINE}")
        for node in numbers(nodes):
            self._requested("state", "--node", str(node), *place)
            self._taken.append(("--node", str(node), *place))
        return self._device if on is None else on.channel

    def lose_power(self, nodes: str) -> None:
        """Skip the test."""
        raise SkipTest(f"no one here can disable the power of the real drives {nodes}")

    def fault(self, kind: str, **keys: object) -> int:
        """Skip the test."""
        del keys
        raise SkipTest(f"real drives get no fault from here: {kind}")

    def clear(self, number: int | None = None, *, nodes: str = "") -> None:
        """Do nothing: no fault was injected."""

    def input(self, axis: str, name: str, value: float, *, nodes: str = "") -> None:
        """Skip the test."""
        del value, nodes
        raise SkipTest(f"no one here can set {name} of the real drive {axis}")

    def finish(self) -> None:
        """Stop those that may have been commanded, and then switch their power off."""
        # All are stopped before the first one is waited for: a quick stop is one command.
        failures = [*self._each(self._stop), *self._each(self._let_go)] if self._moved else []
        self._taken.clear()
        if failures:
            raise failures[0]

    def _each(self, does: Callable[[tuple[str, ...]], None]) -> Iterator[AssertionError]:
        for one in self._taken:
            try:
                # A drive that fails must not keep the others from being stopped.
                does(one)
            except AssertionError as failure:
                yield failure

    def _stop(self, one: tuple[str, ...]) -> None:
        self._requested("state", "quick-stop", *one)

    def _let_go(self, one: tuple[str, ...]) -> None:
        for _ in range(LOOKS):
            program = self._requested("read", VELOCITY, "--json", *one)
            # Stop category 1 (EN 60204-1): power off at standstill; a shaft that turns keeps its power.
            if abs(json.loads(program.printed)["objects"][0]["value"]) <= AT_REST_RPM:
                self._requested("state", "disable", *one)
                return
        raise program.failed(f"it still turns after {LOOKS} looks, and keeps its power")

    def _requested(self, *words: str) -> Process:
        program = self._start(("epos2", *words))
        if program.ends(READY_WITHIN_S) != 0:
            raise program.failed(f"ended with {program.status}")
        return program
