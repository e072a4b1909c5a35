"""The tasks of one EPOS2: the one under way, and the failure of one. The link is not known here."""

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final

from firmware_bridge.drivers.driver import STOPPING, SetPoint, StartupError, Stop, Task
from firmware_bridge.drivers.script_runner import Do, Script, ScriptRunner
from firmware_bridge.families.epos2.driver import tasks as scripts
from firmware_bridge.families.epos2.driver import zero
from firmware_bridge.families.epos2.driver.feedback import DriveFeedback
from firmware_bridge.families.epos2.driver.set_point import QUICK_STOP, Epos2SetPoint
from firmware_bridge.families.epos2.driver.setup import SetupObject
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
    Task.SET_ZERO: 10 * SECOND,
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
        set_point: Epos2SetPoint,
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
            Task.IDENTIFY: partial(scripts.identify, axis),
            Task.CONFIGURE: partial(scripts.configure, axis, feedback, configuration),
            Task.START: self._start,
            Task.ENABLE: partial(scripts.enable, axis, feedback, set_point),
            Task.LEAVE: partial(scripts.leave, axis, feedback, set_point),
            Task.LISTEN: partial(scripts.listen, axis),
            Task.BRAKE: partial(scripts.brake, axis),
            Task.DISABLE: partial(scripts.disable, axis, feedback),
            Task.RESET: partial(scripts.reset, axis, feedback),
            Task.SET_ZERO: self._set_zero,
            Task.HOME: self._home,
        }
        self._tasks: deque[Task] = deque()
        self._task: Task | None = None
        self._until: Nanoseconds = NEVER
        """Time when the one under way is given up."""
        self._position = 0.0
        """Confirmed position of the axis, in its unit."""
        self._in_own_mode = True
        """True where its mode of operation is the set-up's; not while homing, nor where that failed."""
        self.set_up = False
        """True where its set-up was written since it was found."""
        self.doubted = False
        """True after a silence, until its reports show whether it has restarted."""
        self.set_ups = 0
        """Number of times that it was written so far."""
        self.failure: StartupError | None = None
        """The failure of the last tasks; None without one."""

    @property
    def busy(self) -> bool:
        """True while tasks are under way."""
        return self._task is not None

    @property
    def stopping(self) -> bool:
        """True where the one under way stops the drive itself."""
        return self._task in STOPPING

    def lets(self, set_point: SetPoint) -> bool:
        """Return whether a set-point may be sent: during tasks one that stops, during homing also rest."""
        # A stop always passes: no task may keep an axis from being stopped.
        if not self.busy or set_point is Stop.QUICK_STOP or set_point is Stop.POWER_OFF:
            return True
        return set_point is Stop.STANDSTILL and self._task is Task.HOME

    def meant(self, set_point: SetPoint) -> SetPoint:
        """Return a set-point as it may reach the drive: in homing mode a new position would start that."""
        # A new position in homing mode would start a homing: bit 4 means both.
        return set_point if self._in_own_mode or isinstance(set_point, Stop) else Stop.STANDSTILL

    @property
    def configured(self) -> bool:
        """True where the set-up is in force and the drive receives set-points."""
        feedback = self._feedback
        kept = self.set_up and self._in_own_mode and not (feedback.rewritten or self.doubted)
        return kept and feedback.operational and not feedback.restarted

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""
        self.end()
        self.failure = None
        self._tasks.extend(tasks)
        return self.go_on((), now)

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Have the drive count from this position, in the axis's unit, where it stands."""
        self._position = position
        return self.begin((Task.SET_ZERO,), now)

    def end(self) -> None:
        """Forget the tasks under way."""
        self._scripts.stop()
        # Whether the counter was set already is not known any more.
        if self._feedback.zeroing or self._feedback.seeking:
            self._feedback.lose_reference()
        self._tasks.clear()
        self._task = None

    def fail(self, problem: str, now: Nanoseconds) -> None:
        """End the tasks under way, if any, with this problem."""
        if self.busy:
            self._scripts.stop(StartupError(self._axis, problem))
            self.go_on((), now)

    def proceed(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Go on where what the drive has sent is what was waited for, or end where it lost its set-up."""
        if not self.busy:
            return ()
        if self._feedback.restarted and self._task in _NEEDS_SET_UP:
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
        if self._task in _NEEDS_SET_UP:
            self.fail(f"someone else has written to it: {what}", now)

    def go_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Add what the next tasks send, where one has ended."""
        if not self.busy and not self._tasks:
            return sent
        # A drive that answers each request just in time could keep a task busy for ever.
        if self._task is not None and now >= self._until and self._scripts.busy:
            problem = f"'{self._task.value}' has not ended within {to_seconds(WITHIN[self._task]):g} s"
            self._scripts.stop(StartupError(self._axis, problem))
        while not self._scripts.busy:
            if self._scripts.failure is not None:
                failure = self._scripts.failure
                self.end()
                self.failure = failure
                break
            if self._task is Task.CONFIGURE:
                self.set_up = self._in_own_mode = True
                self.doubted = False
                self.set_ups += 1
            self._task = self._tasks.popleft() if self._tasks else None
            if self._task is None:
                break
            self._until = now + WITHIN.get(self._task, NEVER - now)
            sent += self._scripts.run(self._script(self._task), now)
        return sent

    def _script(self, task: Task) -> Script:
        if task in _LOSES_SET_UP:
            self.set_up = False
        if task is Task.CONFIGURE:
            self._feedback.rewritten = ""
        return self._made[task]()

    def _set_zero(self) -> Script:
        self._feedback.zeroing, self._in_own_mode = True, False
        return (*zero.set_zero(self._axis, self._feedback, self._position), Do(self._is_referenced))

    def _home(self) -> Script:
        self._feedback.zeroing, self._in_own_mode = True, False
        # From the first command on: a homing that is interrupted leaves an unknown count.
        self._feedback.reference_lost = True
        return (*zero.home(self._axis, self._feedback), Do(self._is_referenced))

    def _is_referenced(self) -> Script:
        self._in_own_mode = True
        # A target in the counts of the old reference is no target any more.
        self._set_point.word(QUICK_STOP)
        return ()

    def _start(self) -> Script:
        return (*scripts.start(self._axis, self._feedback), Do(self._started))
