"""The motors at the shield of one board as actuators of a robot's physics."""

from typing import Final

from emulators.arduino_omni.board import Board
from emulators.arduino_omni.shield.motor_shield import PORTS
from firmware_bridge.units import Nanoseconds


class ShieldMotor:
    """One motor at its terminals."""

    def __init__(self, name: str, board: Board, port: int) -> None:
        self.name: Final = name
        self._board: Final = board
        self._terminal: Final = port
        self._port: Final = PORTS[port - 1]

    @property
    def powered(self) -> bool:
        """True if its half bridge drives or brakes; an open one is unpowered."""
        output = self._board.mega.shield.output(self._port, self._board.motors.now)
        return bool(output.cw or output.ccw or output.brake)

    def swap_channels(self, *, swapped: bool) -> None:
        """Exchange the channels of its encoder, or put them back."""
        self._board.motors.has_encoder(self._terminal - 1)
        wires = self._board.motors.faults.swapped
        (wires.add if swapped else wires.discard)(self._terminal - 1)


class ShieldMotors:
    """Physics between two events: a board with its motors."""

    def __init__(self, board: Board, motors: tuple[ShieldMotor, ...]) -> None:
        self.axes: Final = motors
        self._board: Final = board

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Advance to `until`; a board requests its own wake when it may have something to send."""
        self._board.advance(until)
        return until, ()
