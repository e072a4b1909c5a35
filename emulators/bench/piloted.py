"""A path follower in the operator's place: a mission's table `pilot`, and the node that drives by it."""

import math
from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Final, Self

from pydantic import AfterValidator, Field, model_validator

from emulators.bench.station_mission import Reach, StationMission
from emulators.bench.step import Finite, NonNegative, Positive, Sends, Step, inputs
from firmware_bridge.motion.model import MotionModel, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.node import Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot import path_file
from firmware_bridge.pilot.follower import PathDriver
from firmware_bridge.pilot.goals import path_to
from firmware_bridge.pilot.paths import PATHS, Path, Point, placed
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.pilot.video import Video
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near
from firmware_bridge.robot.table import Table
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.units import Nanoseconds, from_seconds

if TYPE_CHECKING:
    from collections.abc import Callable


def _is_a_path(name: str) -> str:
    if name not in PATHS and name != GOAL and not name.endswith(".csv"):
        raise ValueError(
            f"there is no path '{name}'; {near(name, [*PATHS, GOAL])} (or a file that ends in .csv)"
        )
    return name


GOAL: Final = "goal"
"""The path to `goal_m`, which is made by what the robot can drive when it begins."""


class Filmed(Table):
    """A camera's pictures in place of each pose as it comes."""

    rate_hz: Positive = Video().rate_hz
    age_s: NonNegative = Video().age_s
    """Age of a picture when it is shown."""

    @property
    def video(self) -> Video:
        """What the station sees by."""
        return Video(self.rate_hz, self.age_s)


class Pilot(Table):
    """Pure pursuit along a path from the station, with what the link brings."""

    path: Annotated[str, AfterValidator(_is_a_path)]
    goal_m: Annotated[tuple[Finite, Finite] | None, Field(strict=False)] = None
    """Where path = "goal" leads: ahead and to the left of the robot when it begins."""
    loop: bool = False
    """Permits a loop where no arc leads to the goal: it needs space."""
    size_m: Positive = 5.0
    """The radius of a circle and of each half of an eight, the length of a line."""
    speed_mps: Positive = 0.5
    look_ahead_m: Positive = 0.5
    offset_m: Finite = 0.0
    """Initial offset of the robot to the left of the path."""
    turned_deg: Finite = 0.0
    """Initial heading of the robot to the left of the path's direction."""
    begins_s: NonNegative = 0.0
    """Time at which it takes over; until then the mission's steps drive by hand."""
    predictor: bool = False
    video: Filmed | None = None
    """See the robot by these pictures only; without it by each pose as the link brings it."""
    reaction_s: NonNegative = 0.0
    """Delay of the hand after the computation; the predictor does not know it."""

    @model_validator(mode="after")
    def _a_goal_is_somewhere(self) -> Self:
        if (self.path == GOAL) != (self.goal_m is not None):
            raise ValueError("goal_m and path = 'goal' belong together")
        return self

    def shape(self) -> Path:
        """Return the path, where it begins at the origin; PathError where its file is none."""
        if self.path in PATHS:
            return PATHS[self.path](self.size_m)
        return path_file.load(FilePath(self.path))

    def placed(self, at: Pose) -> Path:
        """Return the path for a robot that stands there; PathError where its file is none."""
        turned = math.radians(self.turned_deg)
        return placed(self.shape(), at, offset_m=self.offset_m, turned_rad=turned)

    def _to_goal(self, goal: Point, reach: Reach, at: Pose) -> Path:
        return placed(path_to(goal, reach(), loop=self.loop), at)

    def follower(self, robot: AnyRobot, reach: Reach) -> PathDriver:
        """Return the driver along it, no faster than the session's agreed delay lets the robot go.

        PathError where its file is none.
        """
        place: Callable[[Pose], Path] = self.placed
        goal = self.goal_m
        if goal is None:
            self.shape()  # a missing or wrong path file is reported before anything moves
        else:
            place = partial(self._to_goal, goal, reach)
        robot_type = robot_type_of(robot)
        made = robot_type.model
        model: MotionModel = Unicycle() if made is None else made(robot)
        # An agreed delay reduces the top speed, and the follower's with it.
        fastest = robot.operator.speed_share * robot_type.station.largest(robot).forward_mps
        return PathDriver(
            place,
            speed_mps=min(self.speed_mps, fastest),
            look_ahead_m=self.look_ahead_m,
            tightest_per_m=model.tightest_per_m,
            predictor=Predictor(model) if self.predictor else None,
            reaction=from_seconds(self.reaction_s),
        )


def by_hand(given: Step) -> list[str]:
    """Return the keys of a step that a path follower does not do: it has no stick to move."""
    commands = {key for key, row in inputs(type(given)).items() if isinstance(row, Sends)}
    return sorted(given.model_fields_set - commands - {"at_s", "title", "zero", "home"})


class PilotedMission(StationMission):
    """A `Node`: the station, a mission's steps, and the pilot that follows its path."""

    def __init__(self, robot: AnyRobot, steps: tuple[Step, ...], pilot: Pilot) -> None:
        self.follower: Final = pilot.follower(robot, self.reach)
        super().__init__(
            robot,
            steps,
            self.follower,
            begins_s=pilot.begins_s,
            video=None if pilot.video is None else pilot.video.video,
        )


class HandedOver:
    """A `Node`: a hand that drives first, and a pilot that takes over from it."""

    def __init__(self, hand: Node, pilot: PilotedMission, at: Nanoseconds) -> None:
        self._hand: Final = hand
        self.pilot: Final = pilot
        self._at: Final = at

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Deliver the link's packets to the one that drives."""
        return self._in_time(self._driver(now).receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Let the one that drives go on."""
        return self._in_time(self._driver(now).wake(now), now)

    def _driver(self, now: Nanoseconds) -> Node:
        return self.pilot if now >= self._at else self._hand

    def _in_time(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        if now >= self._at:
            return reaction
        return Reaction(reaction.sent, min(reaction.wake_at, self._at))
