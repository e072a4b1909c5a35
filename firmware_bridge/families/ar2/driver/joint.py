"""One joint of the arm as the bridge sees it: a `firmware_bridge.drivers.driver.Driver`.

It has no encoder, and the board reports no power. Its position is counted: from a confirmed one, by the steps
of moves whose end the board has proved. A motor that has lost steps is not noticed. Commands to all joints
are the board's: a set-point is noted here.
"""

from abc import abstractmethod
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Position, Reports, Stop
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.drivers.line_driver import LineDriver, LineLink
from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Link
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import Nanoseconds, to_seconds

REPORTS: Final = frozenset({Reports.STOP})
"""The board's answer to a line behind a move proves that its steps are done; it reports nothing more."""
MOVES_AT_ONCE: Final = 1
"""Steps beside those of its top speed, for the rounding of the command."""


class JointBoard(LineLink):
    """The carrier of the joint's commands: its board."""

    @abstractmethod
    def placed(self, joint: "Ar2Joint", steps: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send on the line where a joint stands."""


class Ar2Joint(LineDriver):
    """One joint."""

    def __init__(self, axis: Axis, robot: AnyRobot, board: JointBoard) -> None:
        super().__init__(axis, board, REPORTS)
        self._board: Final = board
        self.number: Final = Ar2Axis.of(axis).joint
        self._per_unit: Final = Ar2Axis.of(axis).steps_per_unit(axis.ratio)
        link = Ar2Link.of_link(robot, axis.link)
        # Half steps, hence twice the motor's full steps; the smaller of both bounds a move.
        by_axis = axis.top_speed * to_seconds(robot.cycle * link.every) * self._per_unit
        by_motor = 2.0 * Ar2Axis.of(axis).full_steps_s * to_seconds(link.move)
        self.most: Final = int(min(by_axis, by_motor)) + MOVES_AT_ONCE
        """Steps of one move."""
        self.count: int | None = None
        """Steps from the end of its way; None while no one knows."""
        self.commanded: int | None = None
        """The count that was sent to the board, which has not answered."""

    @property
    def feedback(self) -> Feedback:
        """Its known state; the power is as commanded here, and its motors keep their current."""
        return self.as_commanded("counted", "counted, not moved", reference_lost=self.count is None)

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle: the board's, but inactive where it alone is not moved."""
        life = self._board.life
        if self.commanded is not None and not life.tasks:
            return DriverState.HOMING
        state = life.seen(configured=self._board.configured)
        return DriverState.INACTIVE if state is DriverState.ACTIVE and not self.enabled else state

    @property
    def unpowered(self) -> bool:
        """True where the board has proved that nothing moves, and nothing was sent since.

        A weaker proof than a power report, which the device lacks: the motors keep their current, and hold.
        """
        return self.released

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Count from a confirmed position, in rad; it is sent on the line, and counts once echoed."""
        return self._board.placed(self, self.steps_at(position), now)

    def steps_at(self, position: float) -> int:
        """Return the count at a position in rad."""
        # Counted from one end of the travel, as the GUI does, in the motor's direction.
        return round(self.axis.direction * (position - Ar2Axis.of(self.axis).origin) * self._per_unit)

    @property
    def wanted(self) -> int:
        """Steps from where it is counted to where it shall be."""
        if self.count is None or not self.enabled or not isinstance(self.set_point, Position):
            return 0
        return self.steps_at(self.set_point.value) - self.count

    def moved(self, steps: int) -> None:
        """Learn that so many steps are done."""
        if self.count is not None:
            self.count += steps

    def lost(self) -> None:
        """Learn that no one knows any more where it stands, and that it may not be moved."""
        self.count = self.commanded = None
        self.enabled = self.released = False
        self.set_point = Stop.STANDSTILL

    def sampled(self, cycle_at: Nanoseconds, now: Nanoseconds, *, placed: bool) -> None:
        """Take the board's answer to a cycle's request; `placed`: its position was sent since."""
        before, count = self._position, self.count
        if count is not None:
            self._position = Ar2Axis.of(self.axis).origin + self.axis.direction * count / self._per_unit
        # A position that was confirmed in between is no motion.
        known = self._sampled_at != NEVER_RECEIVED and count is not None and not placed
        elapsed = to_seconds(cycle_at - self._sampled_at)
        self._velocity = (self._position - before) / elapsed if known and elapsed > 0.0 else 0.0
        self._sampled_at, self._received_at = cycle_at, now
