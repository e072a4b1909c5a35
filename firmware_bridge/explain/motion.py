"""Whether a drive moves while it is commanded: spans of time, each from one command to the next.

Movement is what the drive reports: its position, or its velocity where no position is in the frames.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, ControlwordCommand, Mode, Status
from firmware_bridge.explain.drive_state import POSITIONS, TARGETS, DriveState
from firmware_bridge.units import SECOND, Nanoseconds

PATIENCE: Final[Nanoseconds] = SECOND
"""A commanded drive that has not moved for so long does not move."""
JITTER: Final = 2
"""Counts, or units of velocity, that are no movement."""
WINDOW: Final = 20
"""A position so near to its target, in counts, has reached it."""
_TOWARDS: Final = frozenset({ControlwordCommand.SHUTDOWN, ControlwordCommand.DISABLE_OPERATION})


@dataclass(frozen=True, slots=True)
class Standstill:
    """A commanded drive at standstill: since when, and whether it had moved before."""

    since: Nanoseconds
    until: Nanoseconds
    had_moved: bool
    observed: bool
    """Whether the frames show its position or velocity at all."""


class MotionWatch:
    """One drive's movement."""

    def __init__(self, drive: DriveState) -> None:
        self._drive = drive
        self._since: Nanoseconds | None = None
        self._reference: int | None = None
        self.ever_moved = False
        self._moved = False
        self._moved_at: Nanoseconds = 0

    def report(self, at: Nanoseconds, position: int | None, velocity: int | None) -> None:
        """Take a position or a velocity."""
        if position is not None:
            if self._reference is None:
                self._reference = position
            elif abs(position - self._reference) > JITTER:
                self._reference = position
                self._note(at)
        elif velocity is not None and self._reference is None and abs(velocity) > JITTER:
            self._note(at)

    def before_command(self, at: Nanoseconds) -> Standstill | None:
        """Judge the span that a command ends, before the drive's state changes."""
        if self._since is None:
            return None
        since = max(self._since, self._moved_at) if self._moved else self._since
        if at - since < PATIENCE or not wants_motion(self._drive) or (self._moved and self._reached):
            return None
        return Standstill(since, at, self._moved, self._observed)

    def after_command(self, at: Nanoseconds) -> None:
        """Begin or end a span, when the drive's state has changed."""
        if not wants_motion(self._drive):
            self._since, self._moved = None, False
        elif self._since is None:
            self._since, self._moved = at, False

    def restart(self) -> None:
        """Take a restart."""
        self._since = self._reference = None

    @property
    def _observed(self) -> bool:
        values = self._drive.values
        return od.POSITION_ACTUAL in values or (od.VELOCITY_ACTUAL in values and not self._reached)

    @property
    def _reached(self) -> bool:
        """Whether the drive itself reports a target as reached whose position is not in the frames."""
        drive = self._drive
        unknown = drive.target in POSITIONS and od.POSITION_ACTUAL not in drive.values
        return unknown and drive.shows(Status.TARGET_REACHED)

    def _note(self, at: Nanoseconds) -> None:
        self._moved_at = at
        self._moved = self.ever_moved = True


def wants_motion(drive: DriveState) -> bool:
    """Return whether the commands to a drive want movement that is not reached."""
    command = drive.command
    if command is ControlwordCommand.ENABLE_OPERATION:
        if drive.state is not None and not drive.enabled:
            return True
        return _pending(drive)
    # Targets for a drive that was never enabled: the enabling is what is missing.
    never = not drive.enable_requested and (command is None or command in _TOWARDS)
    return never and any(drive.values.get(one) for one in drive.written_targets)


def _pending(drive: DriveState) -> bool:
    """Return whether an enabled drive has a target that it has not reached."""
    mode = drive.mode
    if mode == Mode.HOMING:
        started = drive.bit(ControlwordBit.NEW_SETPOINT) or drive.edge_at is None
        return started and not drive.shows(Status.HOMING_ATTAINED)
    if mode is not None and mode not in TARGETS and mode:
        return False
    if not drive.written_targets:
        return True
    target = drive.target if drive.target in drive.targets else None
    if target is None:
        return any(drive.values.get(one) for one in drive.written_targets)
    return _away(drive, target in POSITIONS, drive.values[target])


def _away(drive: DriveState, is_position: bool, target: int) -> bool:  # noqa: FBT001 - a kind of target
    if not is_position:
        return target != 0
    actual = drive.values.get(od.POSITION_ACTUAL)
    # Target reached, bit 10, may be that of the target before.
    if actual is None:
        return True
    return abs(target - actual) > WINDOW
