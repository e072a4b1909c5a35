"""One axis as the guard knows it: what was sent to its drive, what that reported, what it may be sent."""

from typing import Final

from firmware_bridge.robot import AnyRobot, Axis, Command
from firmware_bridge.safety.guard.bounds import rpm_per_unit, targets
from firmware_bridge.safety.guard.epos2_words import (
    DISABLE_VOLTAGE,
    ENABLE,
    HALT,
    NEW_SET_POINT,
    POWERED,
    POWERED_STATES,
    QUICK_STOP,
    SetPoint,
)
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State, Status, state_of


class GuardedAxis:
    """The set-point in force at one drive; without power until one is sent, or the drive reports it."""

    __slots__ = (
        "_aimed_at",
        "_arrived",
        "_has_goal",
        "_rpm_per_unit",
        "_word",
        "axis",
        "by_speed",
        "commanded_at",
        "cycle",
        "node",
        "reported",
        "target",
        "targets",
    )

    def __init__(self, axis: Axis, robot: AnyRobot) -> None:
        self.axis: Final = axis
        self.node: Final = axis.settings.node
        self.by_speed: Final = axis.command is Command.SPEED
        """Whether its target is a speed; else it is a position."""
        self.targets: Final = targets(axis)
        """All that it may be sent; rpm or quadcounts."""
        self.cycle: Final = robot.cycle * robot.links[axis.link].every
        """The time from one of its set-points to the next."""
        self.target = 0
        self.commanded_at = -1
        """When the node last had a set-point for it, good or bad."""
        self.reported: State | None = None
        """The drive's state by its newest statusword; None while it has told none."""
        self._word: int | None = None
        """The controlword that was sent last; None where none is in force."""
        self._has_goal = False
        """Whether a position was sent since the power came on: the drive goes there unless it is stopped."""
        self._aimed_at: Nanoseconds = 0
        """When it was sent there, or on its way again after a halt."""
        self._arrived = False
        """Whether the drive has reported since that it is there."""
        self._rpm_per_unit: Final = rpm_per_unit(axis)

    @property
    def powered(self) -> bool:
        """Whether the drive may have power: by the word that was sent last, or by its newest statusword."""
        return self._word in POWERED or self.reported in POWERED_STATES

    @property
    def moving(self) -> bool:
        """Whether the set-point in force asks for motion."""
        if self.by_speed:
            return self._word == ENABLE and self.target != 0
        return self._word in {ENABLE, NEW_SET_POINT} and self._has_goal and not self._arrived

    @property
    def speed(self) -> float:
        """The speed that is in force, in the axis's unit a second; 0 where it is commanded by position."""
        return self.target / self._rpm_per_unit if self.by_speed and self.moving else 0.0

    @property
    def set_point(self) -> SetPoint:
        """What is in force."""
        return SetPoint(DISABLE_VOLTAGE if self._word is None else self._word, self.target)

    @property
    def safe(self) -> SetPoint:
        """What takes motion away, and gives no power to a drive that has none."""
        return SetPoint(self._safe_word(), 0 if self.by_speed else self.target)

    def moves_with(self, set_point: SetPoint) -> bool:
        """Tell whether the axis would move by this set-point.

        A position counts until its drive reports that it is there, until a halt, or until the power is off.
        """
        if self.by_speed:
            return set_point.word == ENABLE and set_point.target != 0
        goes_on = set_point.word == ENABLE and self._has_goal and not self._arrived
        return set_point.word == NEW_SET_POINT or goes_on

    def speed_with(self, set_point: SetPoint) -> float:
        """Return the speed with which the axis would move by this set-point, in its unit a second."""
        if not (self.by_speed and self.moves_with(set_point)):
            return 0.0
        return set_point.target / self._rpm_per_unit

    def sent(self, set_point: SetPoint, now: Nanoseconds) -> None:
        """Note what is in force from now on."""
        before = self._word
        self._word, self.target = set_point
        if self._word == NEW_SET_POINT:
            self._has_goal = True
        elif self._word not in POWERED:
            self._has_goal = False
        if self._word != ENABLE or before not in {ENABLE, NEW_SET_POINT}:
            self._aimed_at = now
            self._arrived = False

    def deaf(self) -> None:
        """Note that nothing is in force any more: the drive does not hear set-points, and keeps none."""
        self._word = None
        self._has_goal = False

    def restarted(self) -> None:
        """Note that the drive starts anew, without power."""
        self.deaf()
        self.reported = None

    def reports(self, statusword: int, now: Nanoseconds) -> None:
        """Note a statusword; one that tells no state changes nothing."""
        state = state_of(statusword)
        if state is None:
            return
        self.reported = state
        # What comes within a cycle may have left the drive before it was sent anywhere.
        fresh = now >= self._aimed_at + self.cycle
        if fresh and state is State.OPERATION_ENABLED and statusword & Status.TARGET_REACHED:
            self._arrived = True

    def _safe_word(self) -> int:
        if self._word in POWERED:
            # In a drive that has stopped by itself, any other word of these would put the power on again.
            if self.reported not in {None, State.OPERATION_ENABLED}:
                return QUICK_STOP
            return ENABLE if self.by_speed else HALT
        if self._word is None:
            return QUICK_STOP if self.powered else DISABLE_VOLTAGE
        return self._word
