"""The life cycle of every driver: its states, the transitions that lead from one to the next, their tasks.

A family gives the tasks; their order, and what they lead to, stand here alone.
"""

from collections.abc import Mapping
from enum import Enum
from typing import Final, NamedTuple


class DriverState(Enum):
    """State of a driver; `TABLE` explains each."""

    UNCONFIGURED = "unconfigured"
    CONFIGURING = "configuring"
    INACTIVE = "inactive"
    ACTIVATING = "activating"
    ACTIVE = "active"
    HOMING = "homing"
    RECOVERING = "recovering"
    RESTORING = "restoring"
    DEACTIVATING = "deactivating"
    STOPPING = "stopping"
    FAILED = "failed"


class Transition(Enum):
    """A request to a driver; what is under way ends first."""

    CONFIGURE = "configure"
    ACTIVATE = "activate"
    """Reset a fault if there is one, and put power on."""
    DEACTIVATE = "deactivate"
    """Take the power off in order, and end the device's watch over the bridge."""
    RECOVER = "recover"
    """Configure from the beginning, then activate: for a device whose set-up may be lost."""
    HOME = "home"
    SET_ZERO = "set zero"
    LISTEN = "listen"
    """Make the device receive set-points again."""
    QUICK_STOP = "quick stop"
    """Quick stop, for a device that receives no set-points."""
    POWER_OFF = "power off"
    """Take the power off in the same way."""
    RESET = "reset"
    END = "end"
    """End what is under way; nothing takes its place."""


class Task(Enum):
    """A step of a transition; at the start all devices take one before any takes the next."""

    FIND = "find"
    """Make the device listen, and wait until it answers."""
    IDENTIFY = "check identity"
    CONFIGURE = "configure"
    """Bring it to standstill without power, write the set-up, and read back what safety hangs on."""
    START = "start"
    """Let process data flow, and wait until the device reports its state and position."""
    ENABLE = "enable"
    """Reset a fault if there is one, and put power on."""
    LEAVE = "leave"
    """Take the power off; once the device has confirmed that, end its watch over the bridge's heartbeat."""
    LISTEN = "listen"
    """Make the device listen to set-points again, as it is; nothing is waited for."""
    BRAKE = "quick stop by object"
    """Quick stop, object by object: for a device that receives no set-points."""
    DISABLE = "power off by object"
    """Take the power off in the same way."""
    RESET = "reset"
    """Make the device start again: it has no torque then, and loses what it has counted."""
    SET_ZERO = "set zero"
    """Have it count from its confirmed position; with power, at standstill, and nothing moves."""
    HOME = "home"
    """Home it: it moves to its reference, and counts from there; by the robot file."""


class Row(NamedTuple):
    """A transition that a driver may begin."""

    state: DriverState
    """Its state meanwhile."""
    tasks: tuple[Task, ...]


class Outcome(NamedTuple):
    """State to which a task leads."""

    done: DriverState
    failed: DriverState
    ended: DriverState
    """Where a stop, or another transition, has ended it."""


AT_REST: Final = (DriverState.ACTIVE, DriverState.INACTIVE, DriverState.UNCONFIGURED, DriverState.FAILED)
"""States with nothing under way."""
NOT_ENDED: Final = (DriverState.STOPPING, DriverState.RESTORING)
"""No set-point that stops ends what is under way, and no stop waits for it."""
FOUND: Final = (Task.FIND, Task.IDENTIFY, Task.CONFIGURE)
_CONFIGURE: Final = Row(DriverState.CONFIGURING, (*FOUND, Task.START))
_ACTIVATE: Final = Row(DriverState.ACTIVATING, (Task.ENABLE,))
_ALWAYS: Final = {
    Transition.RECOVER: Row(DriverState.RECOVERING, (*FOUND, Task.START, Task.ENABLE)),
    Transition.DEACTIVATE: Row(DriverState.DEACTIVATING, (Task.LEAVE,)),
    Transition.LISTEN: Row(DriverState.STOPPING, (Task.LISTEN,)),
    Transition.QUICK_STOP: Row(DriverState.STOPPING, (Task.BRAKE,)),
    Transition.POWER_OFF: Row(DriverState.STOPPING, (Task.DISABLE,)),
    Transition.RESET: Row(DriverState.STOPPING, (Task.RESET,)),
}
TABLE: Final[Mapping[tuple[DriverState, Transition], Row]] = {
    (DriverState.UNCONFIGURED, Transition.CONFIGURE): _CONFIGURE,
    (DriverState.INACTIVE, Transition.CONFIGURE): _CONFIGURE,
    (DriverState.INACTIVE, Transition.ACTIVATE): _ACTIVATE,
    (DriverState.ACTIVE, Transition.ACTIVATE): _ACTIVATE,
    (DriverState.ACTIVE, Transition.HOME): Row(DriverState.HOMING, (Task.HOME,)),
    (DriverState.ACTIVE, Transition.SET_ZERO): Row(DriverState.HOMING, (Task.SET_ZERO,)),
} | {(state, transition): row for state in AT_REST for transition, row in _ALWAYS.items()}
"""The transitions that begin in each state at rest; all others are refused, by name.

* Unconfigured: the set-up of the device is not in force. It was never written, or the device has restarted,
  was written to by someone else, or does not receive set-points. Stops still reach it; one that moves is
  brought to standstill by the bridge's own ramp.
* Configuring: the device is found, its identity checked, its set-up written and read back, its reports begun.
  Without power throughout.
* Inactive: the set-up is in force and the device reports. No power was requested since it was last taken.
* Activating: faults are reset, and power is requested; from here on it may come at any time.
* Active: power was requested, and set-points count. The device's power itself is its report: after a fault or
  a quick stop, both of which leave it active, it has to be activated again.
* Homing: with power, its reference is set, or searched by motion of the device itself; set-points that move
  are not sent. Ended before its end, it leaves the device unconfigured, for it has another mode of operation.
* Recovering: all of configuring once more while the robot runs; then activating.
* Restoring: without a request, a device that was lost is set up again as soon as it answers, up to inactive.
* Deactivating: the power is taken in order, and the device's watch over the bridge is ended, at the end.
* Stopping: one stage of a stop, or a reset; only another transition ends it.
* Failed: a task failed before the set-up was in force; `LifeCycle.problem` is why. Only recover leads on, or
  what takes the power. A failed activation leads back to inactive.

A stop ends what is under way, but for restoring and stopping.
"""
_UNCONFIGURED: Final = DriverState.UNCONFIGURED
OUTCOMES: Final[Mapping[Task, Outcome]] = {
    Task.FIND: Outcome(_UNCONFIGURED, DriverState.FAILED, _UNCONFIGURED),
    Task.IDENTIFY: Outcome(_UNCONFIGURED, DriverState.FAILED, _UNCONFIGURED),
    Task.CONFIGURE: Outcome(DriverState.INACTIVE, DriverState.FAILED, _UNCONFIGURED),
    Task.START: Outcome(DriverState.INACTIVE, DriverState.INACTIVE, DriverState.INACTIVE),
    Task.ENABLE: Outcome(DriverState.ACTIVE, DriverState.INACTIVE, DriverState.ACTIVE),
    Task.RESET: Outcome(_UNCONFIGURED, DriverState.FAILED, _UNCONFIGURED),
    Task.SET_ZERO: Outcome(DriverState.ACTIVE, DriverState.FAILED, _UNCONFIGURED),
    Task.HOME: Outcome(DriverState.ACTIVE, DriverState.FAILED, _UNCONFIGURED),
}
"""The others leave the state as it was before, but inactive where they take the power."""
START_UP: Final = tuple(
    (transition, task)
    for transition, row in ((Transition.CONFIGURE, _CONFIGURE), (Transition.ACTIVATE, _ACTIVATE))
    for task in row.tasks
)
"""The start of a robot: all devices take each task together."""


class LifeCycle:
    """The state of one device's driver, or of all at one board, and the tasks that are left."""

    __slots__ = ("_refused", "_rest", "problem", "state", "tasks")

    def __init__(self, refused: frozenset[Transition] = frozenset()) -> None:
        """Take the transitions that the device cannot do."""
        self._refused: Final = refused
        self._rest = DriverState.UNCONFIGURED
        """State to which the task under way leads where it changes none."""
        self.state = DriverState.UNCONFIGURED
        """As its tasks have left it; see `seen`."""
        self.tasks: tuple[Task, ...] = ()
        """The first one is under way."""
        self.problem: str | None = None
        """The reason why the last transition failed or was refused; None where it was not."""

    def seen(self, *, configured: bool) -> DriverState:
        """Return the state, given whether the device shows that its set-up is in force."""
        state = self.state
        if configured or (state is not DriverState.ACTIVE and state is not DriverState.INACTIVE):
            return state
        return DriverState.UNCONFIGURED

    def begin(self, transition: Transition, task: Task | None = None, *, configured: bool) -> None:
        """End what is under way and begin a transition, or only that one of its tasks.

        `configured`: the device shows that its set-up is in force.
        """
        self.end()
        self.problem = None
        # Where the set-up is lost, what needs it is refused, whatever was true before.
        state = self.seen(configured=configured)
        row = TABLE.get((state, transition))
        if transition is Transition.END:
            return
        if row is None or transition in self._refused:
            why = "no such device can" if transition in self._refused else f"it is {state.value}"
            self.problem = f"'{transition.value}' is refused: {why}"
            return
        if transition in (Transition.DEACTIVATE, Transition.POWER_OFF):
            self.power_off()
        self.state, self.tasks = row.state, row.tasks if task is None else (task,)

    def restore(self, tasks: tuple[Task, ...]) -> None:
        """Begin to set the device up again without a request."""
        self.state, self.tasks = DriverState.RESTORING, tasks

    def done(self) -> None:
        """End the first task: what it was for has come."""
        task, self.tasks = self.tasks[0], self.tasks[1:]
        outcome = OUTCOMES.get(task)
        if outcome is not None:
            self._rest = outcome.done
        if not self.tasks:
            self.state = self._rest
        elif self.tasks[0] is Task.ENABLE:
            self.state = DriverState.ACTIVATING

    def fail(self, problem: str) -> None:
        """End the tasks, if any, with this problem."""
        self.problem = problem
        if self.tasks:
            outcome = OUTCOMES.get(self.tasks[0])
            self._settle(self._rest if outcome is None else outcome.failed)

    def end(self) -> None:
        """End the tasks, if any: something else takes their place."""
        if self.tasks:
            outcome = OUTCOMES.get(self.tasks[0])
            self._settle(self._rest if outcome is None else outcome.ended)

    def power_off(self) -> None:
        """Note that the power is taken, by a set-point or a task."""
        if self._rest is DriverState.ACTIVE:
            self._rest = DriverState.INACTIVE
            if not self.tasks:
                self.state = DriverState.INACTIVE

    def _settle(self, state: DriverState) -> None:
        self.tasks = ()
        self.state = self._rest = state
