"""One axis of a drive as the guard knows it: what was sent, what was reported, what it may be sent."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState, Status
from firmware_bridge.canopen.objects import CONTROLWORD
from firmware_bridge.canopen_drive.guard.bounds import speed_per_unit, targets
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.words import (
    DISABLE_VOLTAGE,
    ENABLE,
    HALT,
    NEW_SET_POINT,
    POWERED,
    POWERED_STATES,
    QUICK_STOP,
    START_HOMING,
    GuardedSetPoint,
)
from firmware_bridge.canopen_drive.guard.zeroing import Zeroing
from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.robot import AnyRobot, Axis, CommandForm
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

_TARGET_REACHED: Final = int(Status.TARGET_REACHED)


class GuardedAxis:
    """The set-point in force at one drive; without power until one is sent, or the drive reports it."""

    __slots__ = (
        "_changed_at",
        "_confirmed_off",
        "_has_goal",
        "_margin",
        "_off_since",
        "_patience",
        "_speed_per_unit",
        "_standstill_at",
        "_unit",
        "_word",
        "all",
        "axis",
        "by_speed",
        "commanded_at",
        "cycle",
        "node",
        "reported",
        "speed",
        "states",
        "target",
        "targets",
        "zeroing",
    )

    def __init__(self, axis: Axis, robot: AnyRobot, product: GuardedProduct) -> None:
        self.axis: Final = axis
        self.node: Final = DriveAxis.of(axis).node
        self.states: Final = product.states
        self.by_speed: Final = axis.command is CommandForm.SPEED
        """True where its target is a speed; else it is a position."""
        self.zeroing: Final = Zeroing(axis, product)
        self.all: tuple[InForce, ...] = ()
        """Every axis of the robot, this one among them."""
        self._unit: Final = product.units.name(axis.command)
        self.targets: Final = targets(axis, product.units)
        """The targets that it may be sent; units of speed or counts."""
        self.cycle: Final = robot.cycle * DriveLink.of_link(robot, axis.link).every
        """The time from one of its set-points to the next."""
        self.target = 0
        self.speed = 0.0
        """The speed that is in force, in the axis's unit a second; 0 where it is commanded by position."""
        self.commanded_at: Nanoseconds = -NEVER
        """Time of the node's last set-point for it, good or bad."""
        self.reported: PowerState | None = None
        """The drive's state by its newest Statusword; None before the first."""
        self._confirmed_off = False
        """True once a Statusword has reported no power since the last Controlword that gives it."""
        self._off_since: Nanoseconds = NEVER
        """Time since when the Controlword in force disables the power; NEVER where it is another."""
        link = DriveLink.of_link(robot, axis.link)
        self._patience: Final = link.confirmed(robot.cycle).by_object
        """Time within which a drive must confirm that."""
        self._word: int | None = None
        """The controlword that was sent last; None where none is in force."""
        self._has_goal = False
        """True while the drive is on its way to a position and has not reported its arrival."""
        self._changed_at: Nanoseconds = -NEVER
        """Time when it was sent there, was halted, or was released again."""
        self._standstill_at: int | None = None
        """Position at standstill; small deviations from it are no motion. None while it is unknown."""
        self._margin: Final = DriveAxis.of(axis).profile.max_following_error_qc
        """The largest such deviation. The reference stays, so that many small steps are none."""
        self._speed_per_unit: Final = speed_per_unit(axis, product.units)

    @property
    def permitted(self) -> str:
        """The targets that it may be sent."""
        return f"{self.targets[0]} to {self.targets[-1]} {self._unit}"

    @property
    def powered(self) -> bool:
        """True while the drive may have power: by the Controlword sent last, or by its newest Statusword."""
        # The worse of both counts: a Controlword may have been lost, and a Statusword may be late.
        return self._word in POWERED or self.reported in POWERED_STATES

    @property
    def watch_may_end(self) -> bool:
        """True where the drive's Statusword has confirmed no power since it was last given some."""
        return self._confirmed_off

    @property
    def moving(self) -> bool:
        """True while the set-point in force commands motion, or its drive moves for homing."""
        if self._word == ENABLE:
            # With bit 4 low again after the handshake the drive still goes to the position that it has
            # latched.
            return self.target != 0 if self.by_speed else self._has_goal
        return self.homes or (self._word == NEW_SET_POINT and self._has_goal)

    @property
    def homes(self) -> bool:
        """True while its drive is commanded to home with motion."""
        return self._word == START_HOMING and self.zeroing.turns

    @property
    def homes_within_s(self) -> float:
        """Longest permitted time of that, in s."""
        return self.zeroing.within_s

    @property
    def set_point(self) -> GuardedSetPoint:
        """The set-point in force."""
        return GuardedSetPoint(DISABLE_VOLTAGE if self._word is None else self._word, self.target)

    @property
    def safe(self) -> GuardedSetPoint:
        """The set-point that removes motion, and gives no power to a drive without it."""
        return GuardedSetPoint(self._safe_word(), 0 if self.by_speed else self.target)

    def moves_with(self, set_point: GuardedSetPoint) -> bool:
        """Return whether the axis would move by this set-point.

        A position counts until its drive reports that it is there, until a halt, or until the power is off.
        One near to where the axis rests does not count at all.
        """
        if set_point.word == START_HOMING:
            return self.zeroing.turns
        # Profile velocity mode has no start bit: 0x60FF acts as soon as it is written in Operation enabled.
        if self.by_speed:
            return set_point.word == ENABLE and set_point.target != 0
        if set_point.word == NEW_SET_POINT:
            return self._standstill_at is None or abs(set_point.target - self._standstill_at) > self._margin
        return set_point.word == ENABLE and self._has_goal

    def speed_with(self, set_point: GuardedSetPoint) -> float:
        """Return the speed with which the axis would move by this set-point, in its unit a second."""
        if not (self.by_speed and self.moves_with(set_point)):
            return 0.0
        return set_point.target / self._speed_per_unit

    def requested_by(self, set_point: GuardedSetPoint) -> RequestedMotion:
        """Return what the axis would do by this set-point."""
        return RequestedMotion(self.moves_with(set_point), self.speed_with(set_point))

    def keeps_from_reset(self, now: Nanoseconds) -> str | None:
        """Return why its drive may not be reset, or None: only one that does not give up its power may.

        A reset takes torque and zero. It is the last stop stage: the Controlword that disables the power has
        been in force for the drive's time to confirm it, and no Statusword has.
        """
        if self._confirmed_off:
            return f"node {self.node} has no power, and nothing to be reset for"
        if now < self._off_since + self._patience:
            patience = self._patience // MILLISECOND
            return f"node {self.node} has been without an order to disable its power stage for {patience} ms"
        return None

    def sent(self, set_point: GuardedSetPoint, now: Nanoseconds) -> None:
        """Note what is in force from now on."""
        before = self._word
        # Only an unbroken command to disable the power counts towards the reset, the last stop stage.
        if set_point.word != DISABLE_VOLTAGE:
            self._off_since = NEVER
        elif self._off_since == NEVER:
            self._off_since = now
        if set_point.word in POWERED:
            self._confirmed_off = False
        if set_point.word == NEW_SET_POINT:
            # Judged while the position at standstill is still known: a target close to it is no motion.
            self._has_goal = self.moves_with(set_point)
            if self._has_goal:
                self._standstill_at = None
        elif set_point.word not in POWERED:
            self._has_goal = False
        self._word, self.target = set_point
        self.speed = self.speed_with(set_point)
        # Bit 4 that is lowered again ends the handshake of profile position mode and commands nothing new.
        ends_handshake = before == NEW_SET_POINT and self._word == ENABLE
        if self._word == NEW_SET_POINT or (self._word != before and not ends_handshake):
            self._changed_at = now

    def aims(self, target: int) -> None:
        """Note a target that was sent without a Controlword."""
        self.target = target
        self.speed = self.speed_with(self.set_point)

    def not_receiving(self) -> None:
        """Note that nothing is in force any more: the drive receives no set-points, and keeps none."""
        self._word = None
        self._has_goal = False
        self._off_since = NEVER

    def restarted(self) -> None:
        """Note that the drive starts again, without power."""
        self.not_receiving()
        self.reported = None
        self._confirmed_off = False
        self._standstill_at = None
        self.zeroing.restarted()

    def refuses_write(
        self, address: Address, raw: bytes, link: Iterable["GuardedAxis"], *, by_object: bool
    ) -> str | None:
        """Return why a listed value may not be written now; on a `link` where some axis moves it may not."""
        if address == CONTROLWORD:
            word = int.from_bytes(raw, "little")
            return self.zeroing.refuses_word(word, by_object=by_object) or self._homes_beside(word)
        kind = self.zeroing.written.get(address)
        if kind is None:
            return None
        moving = next((f"node {axis.node}" for axis in link if axis.moving), None)
        return self.zeroing.refuses_write(address, kind.decode(raw), self._word, moving)

    def _homes_beside(self, word: int) -> str | None:
        """Return why a Controlword may not start a homing with motion: another axis moves; or None."""
        moving = next((axis.axis.settings.address for axis in self.all if axis.moving), None)
        starts = word == START_HOMING and self.zeroing.turns
        return f"a homing started while {moving} may move" if starts and moving is not None else None

    def wrote(self, address: Address, raw: bytes) -> None:
        """Note what was written to an object of its drive."""
        kind = self.zeroing.written.get(address)
        if kind is None:
            return
        self.zeroing.wrote(address, kind.decode(raw[: kind.size]))
        if self.zeroing.in_homing:
            # Another mode drops where it was sent; and it may count from elsewhere soon.
            self._has_goal, self._standstill_at = False, None

    def read(self, address: Address, raw: bytes) -> None:
        """Note the value that its drive reports of an object."""
        kind = self.zeroing.read_kinds.get(address)
        if kind is not None:
            self.zeroing.read(address, kind.decode(raw[: kind.size]))

    def reports(self, statusword: int, now: Nanoseconds) -> None:
        """Note a Statusword; one without a valid state changes nothing."""
        # An unknown pattern must not pass for a state without power.
        state = self.states.state_of(statusword)
        if state is None:
            return
        self.reported = state
        self._confirmed_off = state not in POWERED_STATES and self._word not in POWERED
        # With halt set, bit 10 means velocity 0 (CiA 402); in an older report it is about the target before.
        there = state is PowerState.OPERATION_ENABLED and statusword & _TARGET_REACHED
        if there and self._word != HALT and self._is_fresh(now):
            self._has_goal = False

    def reports_position(self, position: int, now: Nanoseconds) -> None:
        """Note where the axis is."""
        # Without power the axis may be turned by hand, so each position is a new reference.
        resting = self._standstill_at is None and self._is_fresh(now) and not self.moving
        if resting or not self.powered:
            self._standstill_at = position

    def _is_fresh(self, now: Nanoseconds) -> bool:
        """Return whether a report cannot have left the drive before the newest set-point reached it."""
        return now >= self._changed_at + self.cycle

    def _safe_word(self) -> int:
        if self._word in POWERED:
            # In a drive that has stopped by itself, any other of these Controlwords would enable the power
            # again.
            if self.reported not in {None, PowerState.OPERATION_ENABLED}:
                return QUICK_STOP
            return ENABLE if self.by_speed else HALT
        if self._word is None:
            return QUICK_STOP if self.powered else DISABLE_VOLTAGE
        return self._word
