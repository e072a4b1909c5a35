"""The tasks of one EPOS2: time limits, restarts, foreign writes, doubts; a drive that never answers."""

from typing import Final

import pytest

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.set_point import PositionSetPoint
from firmware_bridge.canopen_drive.driver.task_runner import WITHIN, TaskRunner
from firmware_bridge.drivers.life_cycle import DriverState, Task, Transition
from firmware_bridge.drivers.script_runner import ScriptRunner
from firmware_bridge.families.epos2.driver.product import product
from firmware_bridge.robot import CommandForm
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND
from hil_tests.unit.drivers.test_script_runner import Client

AXIS: Final = next(axis for axis in find("rars").axes if axis.command is CommandForm.POSITION)
OF: Final = {
    Task.FIND: Transition.RECOVER,
    Task.IDENTIFY: Transition.RECOVER,
    Task.CONFIGURE: Transition.RECOVER,
    Task.START: Transition.RECOVER,
    Task.ENABLE: Transition.RECOVER,
    Task.LEAVE: Transition.DEACTIVATE,
    Task.DISABLE: Transition.POWER_OFF,
    Task.BRAKE: Transition.QUICK_STOP,
    Task.RESET: Transition.RESET,
}
NEED_SET_UP: Final = (Task.IDENTIFY, Task.CONFIGURE, Task.START, Task.ENABLE)


class Tasks:
    """A runner whose drive is not there."""

    def __init__(self) -> None:
        self.client = Client()
        self.feedback = DriveFeedback(AXIS, product(AXIS))
        scripts = ScriptRunner(self.client)
        self.runner = TaskRunner(AXIS, self.feedback, PositionSetPoint(AXIS, self.feedback), scripts, ())

    def begin(self, task: Task, now: int = 0) -> "Tasks":
        self.runner.begin(OF[task], now, task)
        assert self.runner.life.tasks[:1] == (task,)
        return self

    @property
    def problem(self) -> str:
        return self.runner.life.problem or ""


@pytest.mark.parametrize(
    "task", [Task.FIND, Task.IDENTIFY, Task.START, Task.ENABLE, Task.LEAVE, Task.DISABLE]
)
def test_a_task_is_given_up_at_its_time_and_not_before_each_time(task: Task) -> None:
    made = Tasks()
    for begin in (0, 100 * SECOND):
        made.begin(task, begin)
        made.runner.go_on((), begin + WITHIN[task] - 1)
        assert (made.runner.life.tasks, made.problem) == ((task,), "")
        made.runner.go_on((), begin + WITHIN[task])
        assert not made.runner.life.tasks
        assert made.problem == f"'{task.value}' has not ended within {WITHIN[task] // SECOND} s"
        assert not made.client.busy


@pytest.mark.parametrize("task", OF)
def test_a_drive_that_restarts_ends_the_tasks_that_need_its_set_up(task: Task) -> None:
    made = Tasks()
    for _ in range(2):
        made.begin(task)
        made.feedback.restarted = True
        made.runner.proceed(0)
        needs = task in NEED_SET_UP
        assert ("it restarted by itself and lost its set-up" in made.problem) is needs
        assert (made.runner.life.tasks == ()) is needs


@pytest.mark.parametrize("task", OF)
def test_a_foreign_write_ends_the_tasks_that_need_the_set_up_and_is_remembered(task: Task) -> None:
    made = Tasks()
    for _ in range(2):
        made.begin(task)
        made.runner.rewritten("0x6065", 0)
        assert made.feedback.rewritten == "0x6065"
        needs = task in NEED_SET_UP
        assert (made.problem == "someone else has written to it: 0x6065") is needs
        assert not made.runner.configured


def test_a_foreign_write_without_a_task_is_no_failure() -> None:
    made = Tasks()
    made.runner.rewritten("0x6065", 0)
    assert (made.problem, made.feedback.rewritten) == ("", "0x6065")
    made.runner.fail("why", 0)
    assert made.problem == ""


def test_a_failure_from_outside_ends_what_is_under_way_each_time() -> None:
    made = Tasks()
    for why in ("first", "second"):
        made.begin(Task.DISABLE)
        made.runner.fail(why, 0)
        assert (made.runner.life.tasks, made.problem) == ((), why)
        assert not made.client.busy


@pytest.mark.parametrize("doubted", [False, True])
@pytest.mark.parametrize("kept", [False, True])
def test_a_drive_that_was_silent_has_restarted_where_its_set_up_is_gone(*, doubted: bool, kept: bool) -> None:
    made = Tasks()
    for _ in range(2):
        made.feedback.restarted = made.feedback.reference_lost = False
        made.feedback.state = PowerState.OPERATION_ENABLED
        made.runner.doubted = doubted
        made.runner.judge(kept=kept)
        restarted = doubted and not kept
        assert made.feedback.restarted is restarted
        assert made.feedback.reference_lost is restarted
        assert (made.feedback.state is None) is restarted
        assert not made.runner.doubted


@pytest.mark.parametrize("mark", ["zeroing", "seeking"])
def test_a_stop_while_the_counter_is_being_set_leaves_it_unknown(mark: str) -> None:
    made = Tasks()
    for _ in range(2):
        made.feedback.reference_lost = False
        setattr(made.feedback, mark, True)
        made.runner.end()
        assert made.feedback.reference_lost
        assert (made.feedback.zeroing, made.feedback.seeking) == (False, False)
    made.feedback.reference_lost = False
    made.runner.end()
    assert not made.feedback.reference_lost


def test_a_search_takes_the_set_up_and_so_does_a_reset() -> None:
    made = Tasks()
    for task in (Task.FIND, Task.RESET):
        made.runner.set_up = True
        made.begin(task)
        assert not made.runner.set_up
    assert made.runner.life.state is DriverState.STOPPING
