"""One motor at a shield as the bridge sees it: a `firmware_bridge.drivers.driver.Driver`.

Commands to all motors of a board are the board's: a set-point is noted here, and the board sends it when the
line is free, at the same instant where it is.
"""

from typing import Final, Protocol

from firmware_bridge.drivers.driver import (
    Feedback,
    Power,
    Reports,
    SetPoint,
    Speed,
    StartupError,
    Stop,
)
from firmware_bridge.drivers.life_cycle import NOT_ENDED, DriverState, LifeCycle, Task, Transition
from firmware_bridge.families.motor_shield.driver.regulator import Pwm, Ticks
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import NEVER, Nanoseconds, to_seconds

COUNTED: Final = frozenset({Reports.POSITION, Reports.VELOCITY, Reports.STOP})
"""Reports of an encoder; a shield reports no power and no current."""


def reports(robot: AnyRobot, axis: Axis) -> frozenset[Reports]:
    """Return the reports of a motor: none, where the firmware does not read its encoder."""
    counted = ShieldAxis.of(axis).port <= ShieldLink.of_link(robot, axis.link).counted
    return COUNTED if counted else frozenset()


class MotorBoard(Protocol):
    """The carrier of the motor's commands: its board."""

    clock: Nanoseconds

    @property
    def life(self) -> LifeCycle:
        """The life cycle of all its motors."""

    @property
    def configured(self) -> bool:
        """True where the set-up is in force."""

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, for all motors of the board."""

    def end_tasks(self) -> None:
        """Do those under way no more."""

    def note_set_point(self) -> None:
        """Say what the motors want, soon."""


class ShieldMotor:
    """One motor."""

    def __init__(self, axis: Axis, robot: AnyRobot, board: MotorBoard) -> None:
        link = ShieldLink.of_link(robot, axis.link)
        self._axis: Final = axis
        self._board: Final = board
        self._reports: Final = reports(robot, axis)
        self.number: Final = ShieldAxis.of(axis).port
        self.measured: Final = bool(self._reports)
        cycle = robot.cycle * link.every
        self.regulator: Final = Ticks(axis, cycle) if link.stops_itself else Pwm(axis, cycle)
        self._per_count: Final = axis.direction / ShieldAxis.of(axis).counts_per_unit(axis.ratio)
        self.set_point: SetPoint = Stop.STANDSTILL
        self.direction = 0
        """Direction of its half bridge: 1 or -1; 0 where it was released."""
        self.enabled = False
        """True where it may be driven."""
        self.released = False
        """True where the board has confirmed that it is released."""
        self._regulated_at: Nanoseconds = NEVER_RECEIVED
        self._count: int | None = None
        self._counted_at: Nanoseconds = 0
        self._position = 0.0
        self._velocity = 0.0
        self._received_at: Nanoseconds = NEVER_RECEIVED
        self._sampled_at: Nanoseconds = NEVER_RECEIVED
        self._estimated_at: Nanoseconds = NEVER_RECEIVED

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

    @property
    def reports(self) -> frozenset[Reports]:
        """Reports of its device."""
        return self._reports

    @property
    def feedback(self) -> Feedback:
        """Its known state; the power is the one commanded to the board, and acknowledged."""
        power = Power.UNKNOWN
        if self._board.configured and self._received_at != NEVER_RECEIVED:
            power = Power.ON if self.enabled else Power.OFF
        return Feedback(
            axis=self._axis.name,
            power=power,
            received_at=self._received_at,
            sampled_at=self._sampled_at,
            position=self._position,
            velocity=self._velocity,
            text="" if power is Power.UNKNOWN else "driven" if self.enabled else "released",
            reference_lost=False,
        )

    @property
    def sampled_at(self) -> Nanoseconds:
        """Time of its newest sample."""
        return self._sampled_at

    @property
    def between(self) -> None:
        """None: its device sends no position between samples."""

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle: the board's, but inactive where it alone was released."""
        state = self._board.life.seen(configured=self._board.configured)
        return DriverState.INACTIVE if state is DriverState.ACTIVE and not self.enabled else state

    @property
    def failure(self) -> StartupError | None:
        """The failure of the board's last transition."""
        problem = self._board.life.problem
        return None if problem is None else StartupError(self._axis, problem)

    @property
    def unpowered(self) -> bool:
        """True where the board has confirmed that the motor is released, and it was not driven since."""
        return self.released

    @property
    def turns(self) -> bool:
        """True where its encoder shows motion."""
        return self.measured and abs(self._velocity) > self._axis.standstill_below

    @property
    def wake_at(self) -> Nanoseconds:
        """Never: the board is woken."""
        return NEVER

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, with all motors of the board."""
        return self._board.begin(transition, now, task)

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Refuse: a motor at a shield has no travel, and no one may say where it stands."""
        del position
        return self.begin(Transition.SET_ZERO, now)

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Note a set-point; while tasks are under way only one that stops, unless they do so themselves."""
        life = self._board.life
        if life.tasks:
            if set_point not in {Stop.QUICK_STOP, Stop.POWER_OFF} or life.state in NOT_ENDED:
                return ()
            self._board.end_tasks()
        self.set_point = set_point
        if set_point is Stop.POWER_OFF:
            self.enabled = False
        self._board.note_set_point()
        return ()

    def release(self) -> tuple[Packet, ...]:
        """Do nothing: no command of a board has a handshake."""
        return ()

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing: the board is woken."""
        del now
        return ()

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
