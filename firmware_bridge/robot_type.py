"""A robot type: the definition in a folder of `firmware_bridge/robots`, or in a third party's package.

Three types of its own: G, its geometry and limits, a table of the robot file; M, its motion in its own terms,
in which command, interlock decision and set-point behind the ramp are expressed; S, the state of its body by
axes and sensors.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from firmware_bridge import renamed
from firmware_bridge.drivers.driver import Level, SeenPose
from firmware_bridge.motion.model import MotionModel
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Axis, CommandForm, Problem, Robot, RobotFileError
from firmware_bridge.robot.table import Table
from firmware_bridge.robot_drawing import Drawing
from firmware_bridge.safety.delay_limit import Slow, delay_limit
from firmware_bridge.safety.interlock import Interlock, Limit
from firmware_bridge.safety.kinematic_model import KinematicModel
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import Group, Snapshot
from firmware_bridge.teleop.station import StationRows
from firmware_bridge.units import Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")
S_contra = TypeVar("S_contra", contravariant=True)


class PathFollower(Protocol[M, S_contra]):
    """Commands along a path; it passes through the same gate as a stick."""

    def command(self, seen: Snapshot[M, S_contra], elapsed: Nanoseconds) -> M:
        """Return the next command."""

    def reset(self) -> None:
        """Forget what has been added up: the robot was held back."""


@renamed.arguments(body="kinematics")
@dataclass(frozen=True, kw_only=True)
class RobotMode(Generic[G, M, S]):
    """Operation after an actuator failure: without its axis, by another kinematic model, other interlocks."""

    without: frozenset[str]
    """The axes, by their roles, that are not used in it: without power, or held."""
    kinematics: Callable[[Robot[G]], KinematicModel[M, S]]
    interlocks: tuple[Interlock[G, M, S], ...]
    limits: tuple[Limit[G, M, S], ...]
    curvatures: Callable[[Robot[G], Mapping[str, float]], tuple[float, float]] | None = None
    """The lowest and the highest curvature that it drives, 1/m, left positive, by its named values.

    None: as the whole robot.
    """

    def __post_init__(self) -> None:
        # The class is frozen, so that this is the way to change a field while it is made.
        made = renamed.kinematics(self.kinematics)
        object.__setattr__(self, "kinematics", made)


@renamed.arguments(guides="path_followers", body="kinematics", rest="standstill")
@dataclass(frozen=True, kw_only=True)
class RobotType(Generic[G, M, S]):
    """One robot type, whole."""

    name: str
    file: Path
    """The robot file that comes with the kind."""
    more: Mapping[str, Path] = field(default_factory=dict)
    """Files with further tables, by what they add: KIND+MORE is the robot of `file` with those of one."""
    geometry: type[G]
    standstill: M
    """A motion in which everything rests."""
    numbers: Mapping[str, Callable[[M], float | None]]
    """The values of a motion that must be finite numbers, by their titles for people."""
    kinematics: Callable[[Robot[G]], KinematicModel[M, S]]
    groups: Mapping[Group, frozenset[str]]
    """The axes, by their roles, that stop together; every axis is in one group."""
    led: Mapping[str, frozenset[str]] = field(default_factory=dict)
    """The axes, by their roles, whose set-points follow the position of another one, by its role.

    Where that one's device sends its position between the cycles, they are commanded again then.
    """
    travelling: frozenset[Group]
    """The groups that take the robot from its place; they stand before it is armed or disarmed."""
    interlocks: tuple[Interlock[G, M, S], ...]
    """The robot's own rows; the common ones come beside them."""
    limits: tuple[Limit[G, M, S], ...]
    slowed: Slow[G, M, S] | None = None
    """The limit of a motion to a share of its top speeds, where commands may be older than usual.

    Without it such a session is refused.
    """
    reach: Callable[[Robot[G]], Iterable[tuple[M, S]]]
    """The motions at the corners of what the limits allow, with the state in which they ask the most."""
    station: StationRows[G, M, S]
    drawing: Drawing[G, S] | None = None
    """Its picture on the live page; None: an arrow."""
    unrolled: Callable[[Robot[G]], Callable[[SeenPose, Pose], Pose]] | None = None
    """Map from a robot's pose seen in the room to the pose on its ground, near the second, its assumed pose.

    None for robots on the room's floor.
    """
    model: Callable[[Robot[G]], MotionModel] | None = None
    """Response to a commanded speed and yaw rate, for a predictor; None: at once."""
    path_followers: Mapping[str, Callable[[Robot[G]], PathFollower[M, S]]] = field(default_factory=dict)
    modes: Mapping[str, RobotMode[G, M, S]] = field(default_factory=dict)
    switched: Callable[[M], Mapping[str, Level]] | None = None
    """The levels of the robot's outputs by a motion, by their names; None for a type without."""
    on_stop: Mapping[str, Level] = field(default_factory=dict)
    """The outputs that a stop of all groups sets, whatever the motion."""

    def __post_init__(self) -> None:
        followers = {name: renamed.makes(it, "wished", "command") for name, it in self.path_followers.items()}
        object.__setattr__(self, "path_followers", followers)
        made = renamed.kinematics(self.kinematics)
        object.__setattr__(self, "kinematics", made)

    @property
    def body(self) -> Callable[[Robot[G]], KinematicModel[M, S]]:
        """The old name of `kinematics`."""
        renamed.warn("body", "kinematics", "RobotType")
        return self.kinematics

    @property
    def rest(self) -> M:
        """The old name of `standstill`."""
        renamed.warn("rest", "standstill", "RobotType")
        return self.standstill

    def rules(self, robot: Robot[G]) -> dict[str, Rules]:
        """Return what the gate judges by in each mode; the whole robot's is the empty name's."""
        whole = RobotMode(
            without=frozenset(), kinematics=self.kinematics, interlocks=self.interlocks, limits=self.limits
        )
        return {name: self._rules(robot, mode) for name, mode in {"": whole, **self.modes}.items()}

    def _rules(self, robot: Robot[G], mode: RobotMode[G, M, S]) -> Rules:
        return Rules(
            kinematics=mode.kinematics(robot),
            without=frozenset(robot.axis(role).name for role in mode.without),
            groups=frozenset(self.groups),
            travelling=self.travelling,
            standstill_below={axis.name: axis.standstill_below for axis in self._travellers(robot)},
            silent_after=robot.silent_after,
            numbers=self.numbers,
            interlocks=mode.interlocks,
            limits=self._delayed(robot, mode.limits),
        )

    def _delayed(self, robot: Robot[G], limits: tuple[Limit[G, M, S], ...]) -> tuple[Limit[G, M, S], ...]:
        """Return the limits with the one that an agreed delay brings."""
        if self.slowed is not None:
            return (delay_limit(self.slowed), *limits)
        if robot.operator.agreed_ms is not None:
            # Without a limit that follows the delay an old command would go further than the operator has
            # learned.
            problem = f"robots of the kind '{self.name}' cannot be slowed, so no delay may be agreed on"
            raise RobotFileError(robot.name, Problem("operator.agreed_ms", problem))
        return limits

    def _travellers(self, robot: Robot[G]) -> Iterator[Axis]:
        """Yield the axes that take the robot from its place: what only steers may go on."""
        rolling = self.kinematics(robot).rolling
        roles = frozenset[str]().union(*(self.groups[group] for group in self.travelling))
        for axis in robot.axes:
            # An axis that is commanded by position, as a steering, may go on while the base is at standstill.
            if axis.name in rolling or (axis.role in roles and axis.command is CommandForm.SPEED):
                yield axis


AnyRobotType: TypeAlias = RobotType[Any, Any, Any]
AnyPathFollower: TypeAlias = PathFollower[Any, Any]
