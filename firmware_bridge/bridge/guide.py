"""The path follower in the operator's place, whose commands pass through the same gate as a stick's."""

from typing import Any, Final

from firmware_bridge.bridge.permission import Permission
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyPathFollower, AnyRobotType
from firmware_bridge.safety.snapshot import AnySnapshot, Snapshot
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.units import Nanoseconds


class Guide:
    """The path follower that drives, where one does."""

    def __init__(
        self, robot: AnyRobot, robot_type: AnyRobotType, operator: OperatorLink, permission: Permission
    ) -> None:
        self._robot: Final = robot
        self._made: Final = robot_type.path_followers
        self._operator: Final = operator
        self._permission: Final = permission
        self._path_follower: AnyPathFollower | None = None
        """None while the operator commands."""
        self._command: Any | None = None
        """The path follower's newest command."""

    @property
    def command(self) -> Any:
        """The command in force: the path follower's, or the operator's."""
        return self._operator.intent.command if self._command is None else self._command

    def guided(self, known: AnySnapshot, elapsed: Nanoseconds) -> AnySnapshot:
        """Return the snapshot with the path follower's command in it, where there is one.

        A deflected stick takes over; a disarm ends the path follower: armed again, nothing starts.
        """
        if self._path_follower is None:
            return known
        moved = self._permission.rules.kinematics.requested(self._operator.intent.command, known.body)
        if moved or not known.facts.armed:
            self.leave()
        else:
            self._command = self._path_follower.command(known, elapsed)
        return Snapshot(
            facts=known.facts,
            command=self.command,
            commanded=known.commanded,
            body=known.body,
            pose=known.pose,
            located=known.located,
        )

    def unknown(self, name: str) -> str | None:
        """Return why there is no path follower of this name; None where there is, or it is empty."""
        if not name or name in self._made:
            return None
        return f"this robot has no '{name}'; it has {', '.join(self._made) or 'none'}"

    def follow(self, name: str) -> str:
        """Begin with the path follower of this name; without a name the operator commands again."""
        made = self._made.get(name)
        self._path_follower = None if made is None else made(self._robot)
        self._command = None
        return f"path follower: {name or 'the operator'}"

    def leave(self) -> None:
        """Let the operator command again."""
        self._path_follower = self._command = None

    def reset(self) -> None:
        """Let the path follower begin again: the robot was held back."""
        if self._path_follower is not None:
            self._path_follower.reset()
