"""One motor at a shield as the bridge sees it: a `firmware_bridge.drivers.driver.Driver`.

Commands to all motors of a board are the board's: a set-point is noted here, and the board sends it when the
line is free, at the same instant where it is.
"""

from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reports, Speed, Stop
from firmware_bridge.drivers.line_driver import LineDriver, LineLink
from firmware_bridge.families.motor_shield.driver.regulator import Pwm, Ticks
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import Nanoseconds, to_seconds

COUNTED: Final = frozenset({Reports.POSITION, Reports.VELOCITY, Reports.STOP})
"""Reports of an encoder; a shield reports no power and no current."""


def reports(robot: AnyRobot, axis: Axis) -> frozenset[Reports]:
    """Return the reports of a motor: none, where the firmware does not read its encoder."""
    counted = ShieldAxis.of(axis).port <= ShieldLink.of_link(robot, axis.link).counted
    return COUNTED if counted else frozenset()


class ShieldMotor(LineDriver):
    """One motor."""

    def __init__(self, axis: Axis, robot: AnyRobot, board: LineLink) -> None:
        super().__init__(axis, board, reports(robot, axis))
        link = ShieldLink.of_link(robot, axis.link)
        self.number: Final = ShieldAxis.of(axis).port
        self.measured: Final = bool(self.reports)
        cycle = robot.cycle * link.every
        self.regulator: Final = Ticks(axis, cycle) if link.stops_itself else Pwm(axis, cycle)
        self._per_count: Final = axis.direction / ShieldAxis.of(axis).counts_per_unit(axis.ratio)
        self.direction = 0
        """Direction of its half bridge: 1 or -1; 0 where it was released."""
        self._regulated_at: Nanoseconds = NEVER_RECEIVED
        self._count: int | None = None
        self._counted_at: Nanoseconds = 0
        self._estimated_at: Nanoseconds = NEVER_RECEIVED

    @property
    def feedback(self) -> Feedback:
        """Its known state; the power is the one commanded to the board, and acknowledged."""
        return self.as_commanded("driven", "released", reference_lost=False)

    @property
    def turns(self) -> bool:
        """True where its encoder shows motion."""
        return self.measured and abs(self._velocity) > self.axis.standstill_below

    def output(self, now: Nanoseconds) -> int:
        """Return its next command: ticks or PWM; one step of its regulator."""
        elapsed = 0 if self._regulated_at == NEVER_RECEIVED else now - self._regulated_at
        self._regulated_at = now
        wanted = self.set_point.value if isinstance(self.set_point, Speed) and self.enabled else 0.0
        if not self.enabled or self.set_point is Stop.QUICK_STOP:
            self.regulator.reset()
            return 0
        return self.regulator.next(wanted, self._velocity if self.measured else None, elapsed)

    def on_output(self, output: int) -> None:
        """Note the command sent; 0 keeps the direction, until it is released."""
        self.direction = (output > 0) - (output < 0) or self.direction or 1
        self.released = False

    def begin_again(self) -> None:
        """Count from the next sample on, released and not to be driven: the board was set up."""
        self.regulator.reset()
        self._count = None
        self._velocity = 0.0
        self._estimated_at = self._sampled_at = NEVER_RECEIVED
        self.set_point, self.direction, self.enabled = Stop.STANDSTILL, 0, False

    def counted(self, count: int, bits: int, requested_at: Nanoseconds, cycle_at: Nanoseconds) -> None:
        """Take its encoder's count, which wraps at so many bits."""
        before, self._count = self._count, count
        elapsed = requested_at - self._counted_at
        self._counted_at = requested_at
        if before is None or elapsed <= 0:
            self._velocity = 0.0
        else:
            # The counter wraps: of all ways between two counts the shortest is meant.
            half = 1 << bits - 1
            moved = self._per_count * ((count - before + half) % (2 * half) - half)
            # Read a little after the others, it is shifted to the instant that all samples share.
            shift = moved * (requested_at - cycle_at) / elapsed
            self._position += moved - shift + self._shifted
            self._shifted = shift
            self._velocity = moved / to_seconds(elapsed)

    _shifted = 0.0
    """Offset of the position behind the newest count."""

    def sampled(self, cycle_at: Nanoseconds, now: Nanoseconds) -> None:
        """Learn that the board has answered all questions of a cycle; where nothing is counted, believe."""
        if not self.measured:
            commanded = self.set_point.value if isinstance(self.set_point, Speed) and self.enabled else 0.0
            # Nothing counts here: the position follows from the speed commanded since the last sample.
            if self._estimated_at != NEVER_RECEIVED:
                self._position += self._velocity * to_seconds(cycle_at - self._estimated_at)
            self._velocity, self._estimated_at = commanded, cycle_at
        self._sampled_at, self._received_at = cycle_at, now
