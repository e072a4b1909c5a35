"""What one EPOS2 shows of itself, and what it is made of, whichever way it is reached."""

from collections.abc import Callable
from typing import Final, Generic, TypeVar

from firmware_bridge.drivers.driver import Feedback, Reports, StartupError
from firmware_bridge.drivers.epos2.feedback import REPORTS, DriveFeedback
from firmware_bridge.drivers.epos2.set_point import set_point
from firmware_bridge.drivers.epos2.setup import Row
from firmware_bridge.drivers.epos2.task_runner import TaskRunner
from firmware_bridge.drivers.script_runner import Client, Script, ScriptRunner
from firmware_bridge.robot import Axis
from firmware_bridge.units import Nanoseconds

F = TypeVar("F", bound=DriveFeedback)


class Epos2Drive(Generic[F]):
    """What a `firmware_bridge.drivers.driver.Driver` tells; what it does is its link's own."""

    __slots__ = ("_axis", "_feedback", "_scripts", "_set_point", "_tasks")

    def __init__(
        self,
        axis: Axis,
        feedback: F,
        client: Client,
        rows: tuple[Row, ...],
        *,
        started: Callable[[], Script] = tuple,
    ) -> None:
        """Take the axis, its record, the way to its objects, its set-up; the scripts as in `TaskRunner`."""
        self._axis: Final = axis
        self._feedback: Final = feedback
        self._set_point: Final = set_point(axis, feedback)
        self._scripts: Final = ScriptRunner(client)
        self._tasks: Final = TaskRunner(axis, feedback, self._set_point, self._scripts, rows, started=started)

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

    @property
    def reports(self) -> frozenset[Reports]:
        """What it can tell."""
        return REPORTS

    @property
    def feedback(self) -> Feedback:
        """What it has reported."""
        return self._feedback.published()

    @property
    def sampled_at(self) -> Nanoseconds:
        """When its newest sample was taken."""
        return self._feedback.sampled_at

    @property
    def busy(self) -> bool:
        """Whether tasks are under way."""
        return self._tasks.busy

    @property
    def stopping(self) -> bool:
        """Whether the tasks under way stop the device, or were requested by no one."""
        return self._tasks.stopping

    @property
    def failure(self) -> StartupError | None:
        """Why the last tasks failed; None where they did not."""
        return self._tasks.failure

    @property
    def unpowered(self) -> bool:
        """Whether its newest statusword tells a state without torque; not once power was asked for."""
        return self._feedback.unpowered

    @property
    def configured(self) -> bool:
        """Whether its set-up is in force and it listens to set-points."""
        return self._tasks.configured

    @property
    def set_ups(self) -> int:
        """How often its set-up was written so far."""
        return self._tasks.set_ups
