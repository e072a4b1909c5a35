"""The state and parts of one drive, whatever its link is."""

from collections.abc import Callable
from typing import Final, Generic, TypeVar

from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.set_point import set_point
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.driver.task_runner import TaskRunner
from firmware_bridge.drivers.driver import Between, Feedback, Reports, StartupError
from firmware_bridge.drivers.life_cycle import DriverState, LifeCycle
from firmware_bridge.drivers.script_runner import ObjectClient, Script, ScriptRunner
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds

F = TypeVar("F", bound=DriveFeedback)


class Drive(Generic[F]):
    """The reports of a `firmware_bridge.drivers.driver.Driver`; its commands are its link's own."""

    __slots__ = ("_axis", "_feedback", "_life", "_scripts", "_set_point", "_tasks")

    def __init__(
        self,
        axis: Axis,
        feedback: F,
        client: ObjectClient,
        rows: tuple[SetupObject, ...],
        *,
        started: Callable[[], Script] = tuple,
    ) -> None:
        """Take the axis, its record, the way to its objects, its set-up; the scripts as in `TaskRunner`."""
        self._axis: Final = axis
        self._feedback: Final = feedback
        self._set_point: Final = set_point(axis, feedback)
        self._scripts: Final = ScriptRunner(client)
        self._tasks: Final = TaskRunner(axis, feedback, self._set_point, self._scripts, rows, started=started)
        self._life: Final[LifeCycle] = self._tasks.life

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

    @property
    def reports(self) -> frozenset[Reports]:
        """Reports of its device."""
        return self._feedback.product.reports

    @property
    def feedback(self) -> Feedback:
        """The state that it has reported."""
        return self._feedback.published()

    @property
    def sampled_at(self) -> Nanoseconds:
        """Time of its newest sample."""
        return self._feedback.sampled_at

    @property
    def between(self) -> Between | None:
        """Its newest position where it sends some between samples."""
        return self._feedback.between

    @property
    def busy(self) -> bool:
        """True while tasks are under way."""
        return bool(self._life.tasks)

    @property
    def state(self) -> DriverState:
        """Its place in the life cycle."""
        return self._life.seen(configured=self._tasks.configured)

    @property
    def failure(self) -> StartupError | None:
        """The failure of the last transition; None without one."""
        problem = self._life.problem
        return None if problem is None else StartupError(self._axis, problem)

    @property
    def unpowered(self) -> bool:
        """True where its newest Statusword has a state without torque; not once power was requested."""
        return self._feedback.unpowered

    @property
    def set_ups(self) -> int:
        """Number of times that its set-up was written so far."""
        return self._tasks.set_ups
