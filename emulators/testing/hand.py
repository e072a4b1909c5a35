"""The operator in a test: executes inputs of a mission's step, and keeps them until the next ones."""

from collections.abc import Callable
from typing import Final

from pydantic import ValidationError

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.log import LogEntry
from emulators.bench.mission import Mission, cannot_say
from emulators.bench.operator import ScriptedOperator
from emulators.bench.step import Holds, Step, inputs
from emulators.testing.errors import RigError
from firmware_bridge import renamed
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import problems_of
from firmware_bridge.units import Nanoseconds, to_seconds

FOR_GOOD_S: Final = 1e6
"""Longer than any story."""
AT_ONCE_S: Final = 1e-6
FORWARD: Final = "speed_mps"
"""The key of a step by which every robot on the ground is driven ahead."""


class TestOperator:
    """A human at the ground station; his words take effect with the station's next message, within 50 ms."""

    __test__ = False

    def __init__(
        self,
        robot: AnyRobot,
        bench_setup: BenchSetup,
        station: ScriptedOperator,
        story: Mission,
        clock: Callable[[], Nanoseconds],
    ) -> None:
        self._robot: Final = robot
        self._bench_setup: Final = bench_setup
        self._step: Final = bench_setup.step
        self._station: Final = station
        self._clock: Final = clock
        self.story = story
        """The operator's actions so far, as a mission."""

    @property
    def diary(self) -> tuple[LogEntry, ...]:
        """The operator's actions, the received texts, and the results of the orders, the oldest first."""
        return tuple(self._station.diary.entries)

    @property
    def texts(self) -> tuple[str, ...]:
        """The diary's texts."""
        return tuple(entry.text for entry in self.diary)

    @property
    def told(self) -> tuple[str, ...]:
        """The old name of `texts`."""
        renamed.warn("told", "texts", "rig.operator")
        return self.texts

    @property
    def armed(self) -> bool:
        """True if the robot reports that it is armed."""
        return bool(self._station.diary.armed)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys for `does` and `drives`, as in a mission."""
        return tuple(key for key in self._step.model_fields if key not in {"at_s", "title"})

    def does(self, title: str = "", **values: object) -> None:
        """Do one step of a mission now; RigError, with a near name, where the robot has no such key."""
        table = {
            "at_s": to_seconds(self._clock()),
            "title": title or ", ".join(values) or "nothing",
            **values,
        }
        try:
            # The mission's own model: a test can do no more than a mission file.
            step = self._step.model_validate(table)
        except ValidationError as error:
            problems = "; ".join(f"{key}: {what}" for key, what in problems_of(error, self._step))
            raise RigError(f"{self._robot.name}: its operator cannot do that: {problems}") from error
        self._goes_on(step)

    def drives(self, forward: float | None = None, **values: object) -> None:
        """Drive ahead with so many m/s, and whatever else the robot's missions can say, from now on."""
        if forward is not None and FORWARD not in self._step.model_fields:
            known = ", ".join(self.keys)
            raise RigError(f"{self._robot.name} has no forward; its operator knows {known}")
        self.does("drives", **({} if forward is None else {FORWARD: forward}), **values)

    def returns_to_neutral(self) -> None:
        """Put each stick and velocity to neutral."""
        rows = reversed(inputs(self._step).items())
        # Of two keys for one channel the first: a later one may have no word for it, as a turn's radius.
        keys = {row.channel: key for key, row in rows if isinstance(row, Holds)}
        self.does("returns to neutral", **dict.fromkeys(keys.values(), 0.0))

    def lets_go(self) -> None:
        """Do `returns_to_neutral`, by its name of the release before."""
        renamed.warn("lets_go", "returns_to_neutral", "operator")
        self.returns_to_neutral()

    def falls_silent(self, seconds: float = FOR_GOOD_S) -> None:
        """Send nothing any more, or for so long: the station is dead, or the link is."""
        self.does("falls silent", silent_s=seconds)

    def comes_back(self) -> None:
        """Speak again; what he held he holds still."""
        self.does("comes back", silent_s=AT_ONCE_S)

    def arms(self) -> None:
        """Request the robot to be armed, and repeat it until it is answered."""
        self.does("arms", arm=True)

    def disarms(self) -> None:
        """Request the robot to be disarmed."""
        self.does("disarms", disarm=True)

    def stops(self) -> None:
        """Give the emergency stop."""
        self.does("emergency stop", emergency_stop=True)

    def clears(self) -> None:
        """Clear the emergency stop."""
        self.does("clears the stop", clear=True)

    def takes_over(self, story: Mission) -> None:
        """Continue from an instant that was kept, as the operator with this story by then."""
        self.story = story
        self._station.take_over(story)

    def _goes_on(self, step: Step) -> None:
        story = self.story.model_copy(update={"step": (*self.story.step, step)})
        problems = "; ".join(one.problem for one in cannot_say(story, self._robot, self._bench_setup))
        if problems:
            raise RigError(f"{self._robot.name}: its operator cannot do that: {problems}")
        self.takes_over(story)


__getattr__ = renamed.module(__name__, __name__, Hand="TestOperator")
