"""A mission that is driven from a ground station: its driver, and the mission's steps at their time."""

from collections.abc import Callable
from typing import Final, TypeAlias

from emulators.bench import orders
from emulators.bench.step import Step
from firmware_bridge.motion.model import Unicycle
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.driver import Driver
from firmware_bridge.pilot.goals import Curvatures
from firmware_bridge.pilot.paths import PathError
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.pilot.video import Video
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds

Reach: TypeAlias = Callable[[], Curvatures]


class StationMission:
    """A `Node`: the station, and a mission's steps, whose commands it sends at their time."""

    def __init__(
        self,
        robot: AnyRobot,
        steps: tuple[Step, ...],
        driver: Driver,
        *,
        begins_s: float = 0.0,
        video: Video | None = None,
    ) -> None:
        """Take the steps from `begins_s` on, and of the earlier ones their mode."""
        modes = [step.mode for step in steps if step.mode is not None]
        self._mode: Final = modes[-1] if modes else ""
        self._robot: Final = robot
        self._steps: Final = tuple(step for step in steps if step.at_s >= begins_s)
        self._taken = 0
        operator = robot.operator
        self.station: Final = PilotStation(driver, (operator.system_id, operator.component_id), video=video)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Deliver the link's packets."""
        return self._in_time(self.station.receive(packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Order what the steps that are due say, and go on."""
        while self._due <= now:
            for one in orders.of_step(self._steps[self._taken], self._robot, now):
                self.station.order(one.title, one.number, one.params, now)
            self._taken += 1
        return self._in_time(self.station.wake(now))

    def reach(self) -> Curvatures:
        """Return what the robot drives in the mission's mode, by the values that it has sent."""
        robot_type = robot_type_of(self._robot)
        of_mode = robot_type.modes[self._mode].curvatures if self._mode in robot_type.modes else None
        if of_mode is not None:
            try:
                return Curvatures(*of_mode(self._robot, self.station.shown.values))
            except KeyError as missing:
                # The next command tries again: the value comes within a second.
                raise PathError(f"the robot has not reported {missing.args[0]} yet") from missing
        made = robot_type.model
        most = (Unicycle() if made is None else made(self._robot)).tightest_per_m
        return Curvatures(-most, most)

    @property
    def _due(self) -> Nanoseconds:
        return from_seconds(self._steps[self._taken].at_s) if self._taken < len(self._steps) else NEVER

    def _in_time(self, reaction: Reaction) -> Reaction:
        return Reaction(reaction.sent, min(reaction.wake_at, self._due))
