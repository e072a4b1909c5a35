"""The tasks of one drive: the one under way, and the failure of one. The link is not known here."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Final

from firmware_bridge.canopen_drive.driver import tasks as scripts
from firmware_bridge.canopen_drive.driver import zero
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.set_point import QUICK_STOP, DriveSetPoint
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.drivers.driver import SetPoint, StartupError, Stop
from firmware_bridge.drivers.life_cycle import NOT_ENDED, DriverState, LifeCycle, Task, Transition
from firmware_bridge.drivers.script_runner import Do, Script, ScriptRunner
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, to_seconds

_LOSES_SET_UP: Final = (Task.FIND, Task.RESET)
_NEEDS_SET_UP: Final = (Task.IDENTIFY, Task.CONFIGURE, Task.START, Task.ENABLE, Task.SET_ZERO, Task.HOME)
WITHIN: Final[Mapping[Task, Nanoseconds]] = {
    Task.FIND: 5 * SECOND,
    Task.IDENTIFY: 5 * SECOND,
    Task.CONFIGURE: 30 * SECOND,
    Task.START: 5 * SECOND,
    Task.ENABLE: 10 * SECOND,
    Task.LEAVE: 10 * SECOND,
    Task.LISTEN: 2 * SECOND,
    Task.BRAKE: 5 * SECOND,
    Task.DISABLE: 5 * SECOND,
    Task.RESET: 5 * SECOND,
    Task.SET_ZERO: 30 * SECOND,
}
"""Time limit of a task in all.

A drive that answers each request late, or changes its state again and again, does not keep the bridge
waiting. A homing is bounded by `firmware_bridge.bridge.homing`.
"""


class TaskRunner:
    """Tasks in their order; what a method returns is to be sent."""

    def __init__(
        self,
        axis: Axis,
        feedback: DriveFeedback,
        set_point: DriveSetPoint,
        runner: ScriptRunner,
        configuration: tuple[SetupObject, ...],
        *,
        started: Callable[[], Script] = tuple,
    ) -> None:
        """Take the drive's parts, its set-up, and the link's tasks after start-up."""
        self._axis = axis
        self._feedback = feedback
        self._set_point = set_point
        self._scripts = runner
        self._started = started
        self._made: Final[Mapping[Task, Callable[[], Script]]] = {
            Task.FIND: partial(scripts.find, axis, feedback),
            Task.IDENTIFY: partial(scripts.identify, axis, feedback.product.identity),
            Task.CONFIGURE: partial(scripts.configure, axis, feedback, configuration),
            Task.START: self._start,
            Task.ENABLE: partial(scripts.enable, axis, feedback, set_point),
            Task.LEAVE: partial(scripts.leave, axis, feedback, set_point),
            Task.LISTEN: partial(scripts.listen, axis),
            Task.BRAKE: partial(scripts.brake, axis, feedback),
            Task.DISABLE: partial(scripts.disable, axis, feedback),
            Task.RESET: partial(scripts.reset, axis, feedback),
            Task.SET_ZERO: self._set_zero,
            Task.HOME: self._home,
        }
        without = [Transition.SET_ZERO] if axis.travel is None else []
        without += [Transition.HOME] if axis.zero.homing is None else []
        self.life: Final = LifeCycle(frozenset(without))
        self._until: Nanoseconds = NEVER
        """Time when the task under way is given up."""
        self._position = 0.0
        """Confirmed position of the axis, in its unit."""
        self.set_up = False
        """True where its set-up was written since it was found."""
        self.doubted = False
        """True after a silence, until its reports show whether it has restarted."""
        self.set_ups = 0
        """Number of times that it was written so far."""

    def lets(self, set_point: SetPoint) -> SetPoint | None:
        """Return a set-point as it may reach the drive, None where it may not; one that stops ends tasks."""
        life = self.life
        if life.tasks:
            # A stop always passes: no task may keep an axis from being stopped.
            stops = set_point is Stop.QUICK_STOP or set_point is Stop.POWER_OFF
            if not stops and (set_point is not Stop.STANDSTILL or life.tasks[0] is not Task.HOME):
                return None
            if life.state not in NOT_ENDED:
                self.end()
        if set_point is Stop.POWER_OFF:
            life.power_off()
        # After a homing that ended early a new position would start another: bit 4 means both.
        return (
            set_point if life.state is DriverState.ACTIVE or isinstance(set_point, Stop) else Stop.STANDSTILL
        )

    @property
    def configured(self) -> bool:
        """True where the set-up is in force and the drive receives set-points."""
        feedback = self._feedback
        kept = self.set_up and not (feedback.rewritten or self.doubted)
        return kept and feedback.operational and not feedback.restarted

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or that one of its tasks, in place of what is under way."""
        self.end()
        self.life.begin(transition, task, configured=self.configured)
        return self._open((), now)

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Have the drive count from this position, in the axis's unit, where it stands."""
        self._position = position
        return self.begin(Transition.SET_ZERO, now)

    def end(self) -> None:
        """Forget the tasks under way."""
        self._stop()
        self.life.end()

    def _stop(self) -> None:
        self._scripts.stop()
        # Whether the counter was set already is not known any more.
        if self._feedback.zeroing or self._feedback.seeking:
            self._feedback.lose_reference()

    def fail(self, problem: str, now: Nanoseconds) -> None:
        """End the tasks under way, if any, with this problem."""
        if self.life.tasks:
            self._scripts.stop(StartupError(self._axis, problem))
            self.go_on((), now)

    def proceed(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Go on where what the drive has sent is what was waited for, or end where it lost its set-up."""
        if not self.life.tasks:
            return ()
        if self._feedback.restarted and self.life.tasks[0] in _NEEDS_SET_UP:
            self._scripts.stop(StartupError(self._axis, "it restarted by itself and lost its set-up"))
            return self.go_on((), now)
        return self.go_on(self._scripts.go_on(now), now)

    def judge(self, *, kept: bool) -> None:
        """Learn whether a drive that was silent has kept its set-up."""
        # Its heartbeat consumer is off, so it has restarted: the set-up was in memory only.
        if self.doubted and not kept:
            self._feedback.restart()
            self._feedback.state = None
        self.doubted = False

    def rewritten(self, what: str, now: Nanoseconds) -> None:
        """Note a foreign write to the drive: its set-up may no longer be in force."""
        self._feedback.rewritten = what
        if any(task in _NEEDS_SET_UP for task in self.life.tasks[:1]):
            self.fail(f"someone else has written to it: {what}", now)

    def go_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Add what the next tasks send, where one has ended."""
        life = self.life
        if not life.tasks:
            return sent
        if self._scripts.busy:
            # A drive that answers each request just in time could keep a task busy for ever.
            if now < self._until:
                return sent
            task = life.tasks[0]
            problem = f"'{task.value}' has not ended within {to_seconds(WITHIN[task]):g} s"
            self._scripts.stop(StartupError(self._axis, problem))
        return self._open(sent, now) if self._ended() else sent

    def _open(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Add what the tasks that are left send, until one waits."""
        while self.life.tasks:
            task = self.life.tasks[0]
            self._until = now + WITHIN.get(task, NEVER - now)
            sent += self._scripts.run(self._script(task), now)
            if self._scripts.busy or not self._ended():
                break
        return sent

    def _ended(self) -> bool:
        """Note that the first task has ended; return whether the next one may begin."""
        failure = self._scripts.failure
        if failure is not None:
            self._stop()
            self.life.fail(failure.problem)
            return False
        if self.life.tasks[0] is Task.CONFIGURE:
            self.set_up, self.doubted = True, False
            self.set_ups += 1
        self.life.done()
        return True

    def _script(self, task: Task) -> Script:
        if task in _LOSES_SET_UP:
            self.set_up = False
        if task is Task.CONFIGURE:
            self._feedback.rewritten = ""
        return self._made[task]()

    def _set_zero(self) -> Script:
        self._feedback.zeroing = True
        return (*zero.set_zero(self._axis, self._feedback, self._position), Do(self._is_referenced))

    def _home(self) -> Script:
        self._feedback.zeroing = True
        # From the first command on: a homing that is interrupted leaves an unknown count.
        self._feedback.reference_lost = True
        return (*zero.home(self._axis, self._feedback), Do(self._is_referenced))

    def _is_referenced(self) -> Script:
        # A target in the counts of the old reference is no target any more.
        self._set_point.word(QUICK_STOP)
        return ()

    def _start(self) -> Script:
        return (*scripts.start(self._axis, self._feedback), Do(self._started))
