"""Boards that no frame of a bridge can reach, and those of them that go on as commanded, by the truth."""

from typing import Final

from emulators.arduino_omni.bench_faults import (
    BoardBrownOut,
    BoardHangs,
    BoardReset,
    BoardSilent,
    BoardUnpowered,
    I2cStuck,
)
from emulators.arduino_omni.board import Board
from emulators.bench.columns import SAMPLE_EVERY
from emulators.rig import BRIDGE, Rig
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import NEVER

STARTS_AGAIN: Final = {it.kind for it in (BoardBrownOut, BoardHangs, BoardReset, BoardUnpowered, I2cStuck)}


class Reached:
    """Looks at the boards of a robot; it remembers nothing, so that a run may be taken back."""

    def __init__(self, robot: AnyRobot) -> None:
        self._axes: Final = {
            name: frozenset(axis.name for axis in robot.axes_on(name)) for name in ShieldLink.all_of(robot)
        }
        self._stop: Final = {name for name, link in ShieldLink.all_of(robot).items() if link.stops_itself}

    def loads(self, rig: Rig) -> frozenset[str]:
        """Return the axes whose board is in its boot loader: no auto-stop of a sketch runs there."""
        boards = rig.devices.nodes(Board)
        loading = [axes for name, axes in self._axes.items() if boards[name].mega.sketch is None]
        return frozenset().union(*loading)

    def look(self, rig: Rig) -> tuple[frozenset[str], frozenset[str]]:
        """Return the axes that no one reaches, and those of them that nothing stops.

        A bridge that has ended reaches no one. That excuses a board that runs on only where it was killed, or
        where it has ended with the word that a stop was not confirmed. A board that restarts, or hangs, is
        waited for again. While the I2C bus is stuck no one reaches the shield, the board's own sketch least.
        """
        records = rig.faults.records
        unreached, runs_on = set[str](), set[str]()
        lately = rig.world.now - SAMPLE_EVERY
        again = any(it.ended is not None and it.ended > lately for it in records if it.kind in STARTS_AGAIN)
        dead = not rig.world.here(BRIDGE)
        standing = {it.kind for it in records if it.ended is None}
        silent, stuck = BoardSilent.kind in standing, I2cStuck.kind in standing
        reported = rig.bridge.finished and bool(rig.bridge.not_acknowledged)
        for name, axes in self._axes.items():
            board, line = rig.devices.nodes(Board)[name], rig.lines[name]
            dark = board.mega.sketch is None and board.mega.due == NEVER
            cut = dark or dead or reported or silent or stuck or not line.adapter.plugged
            if cut or rig.bridge.finished:
                unreached |= axes
            # Wire waits for a stuck bus for ever: until it is reset the sketch hangs, its auto-stop with it.
            hung = board.mega.hung
            if dark or again or stuck or (cut and (hung or name not in self._stop)):
                runs_on |= axes
        return frozenset(unreached), frozenset(runs_on)
