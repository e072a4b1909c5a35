"""Whether the robot may move: armed or not, the emergency stop's latch, and what an operator's request does.

It answers every request with a reason. What the interlocks say comes in with the holds; it judges no motion.
"""

from typing import Final

from firmware_bridge.drivers.drive import BRING_UP, Drive, Stop, Task
from firmware_bridge.drivers.fleet import Fleet
from firmware_bridge.intent import Arm, ClearEmergencyStop, Disarm, EmergencyStop, Request, Verdict
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Robot
from firmware_bridge.safety.interlocks import BASE_MOVES_MPS, DRIVE_STOPS, STOPS, drive_silent_after
from firmware_bridge.safety.snapshot import Hold, Snapshot
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State

_DRIVE_STOPS: Final = frozenset((*(row.name for row in DRIVE_STOPS), "drives out of reach"))
_STOPS_EVERYTHING: Final = frozenset(row.name for row in STOPS if not row.lift_is_free) - {
    "not armed",
    "operator silent",
}
"""Arming waits for these to let go. What leaves the lift free does not count: a lift that stands extended
comes down only when the robot is armed. Nor does silence: many stations arm first and speak of motion then,
and until they do the silence holds the robot itself."""


def at_rest(seen: Snapshot) -> bool:
    """Return whether the base stands, and is not told otherwise."""
    return seen.demanded_speed_mps == 0.0 and abs(seen.speed_mps) < BASE_MOVES_MPS


class Permission:
    """The leave to move, and who may change it."""

    __slots__ = ("_final", "_fleet", "_outbox", "_silent_after", "armed", "emergency_stopped", "powered_off")

    def __init__(self, robot: Robot, fleet: Fleet, outbox: list[Packet]) -> None:
        """Take the drives that a request may switch, and where to put what is to be sent at once."""
        self._fleet = fleet
        self._outbox = outbox
        self._silent_after = drive_silent_after(robot)
        self._final = False
        self.armed = False
        self.emergency_stopped = False
        self.powered_off = False
        """A forced disarm took the power off; it stays off until arming puts it on again."""

    def watch(self, holds: tuple[Hold, ...]) -> None:
        """Take the leave away where a drive fails or the emergency stop is latched: to go on, arm again."""
        if self.emergency_stopped or any(_kind(hold) in _DRIVE_STOPS for hold in holds):
            self.armed = False

    def decide(self, request: Request, seen: Snapshot, holds: tuple[Hold, ...]) -> Verdict:
        """Answer one request; `seen` and `holds` are of this instant."""
        match request:
            case Arm():
                return self._arm(seen, holds)
            case Disarm(force=True):
                self.armed = False
                self.powered_off = True
                self._outbox += self._fleet.command_all(Stop.POWER_OFF)
                return Verdict(accepted=True, reason="disarmed by force: the drives are without power")
            case Disarm():
                return self._disarm(seen)
            case EmergencyStop(final=final):
                self.emergency_stopped = True
                self._final = self._final or final
                self.armed = False
                return Verdict(accepted=True, reason="emergency stop: it stays until it is cleared")
            case ClearEmergencyStop():
                return self._clear(seen)
        return Verdict(accepted=True, reason="")

    def _arm(self, seen: Snapshot, holds: tuple[Hold, ...]) -> Verdict:
        if self.armed:
            return Verdict(accepted=True, reason="armed already")
        premature = self._premature(seen)
        if premature is not None:
            return premature
        asleep = [drive for drive in self._fleet.drives if not self._ready(drive, seen.now)]
        if asleep:
            return self._awaken(asleep, seen.now)
        for hold in holds:
            if _kind(hold) in _STOPS_EVERYTHING | _DRIVE_STOPS:
                return Verdict(accepted=False, reason=f"arm: {hold.reason}; {hold.remedy}", temporary=True)
        self.armed = True
        return Verdict(accepted=True, reason="armed")

    def _premature(self, seen: Snapshot) -> Verdict | None:
        if self.emergency_stopped:
            return Verdict(accepted=False, reason="arm: the emergency stop is latched; clear it first")
        if seen.link_lost is not None:
            return Verdict(accepted=False, reason=f"arm: {seen.link_lost}; plug it in again", temporary=True)
        wish = seen.intent
        if wish.speed_mps != 0.0 or wish.lift_rate_mps != 0.0:
            asked = f"{wish.speed_mps:.2f} m/s, lift {wish.lift_rate_mps:.2f} m/s"
            return Verdict(accepted=False, reason=f"arm: the stick asks for {asked}; let it go first")
        if not at_rest(seen):
            return Verdict(accepted=False, reason="arm: the robot still moves", temporary=True)
        return None

    def _awaken(self, asleep: list[Drive], now: Nanoseconds) -> Verdict:
        """Begin to enable drives again; the operator arms again when they are."""
        self.powered_off = False
        told = []
        for drive in asleep:
            before = f" (last try: {drive.failure.problem})" if drive.failure is not None else ""
            told.append(f"drive {drive.axis.node} ({drive.axis.title}){before}")
            if not drive.busy:
                lost = not drive.configured or self._silent(drive, now)
                self._outbox += drive.begin(BRING_UP if lost else (Task.ENABLE,), now)
        return Verdict(accepted=False, reason=f"enabling {', '.join(told)} again, arm again", temporary=True)

    def _disarm(self, seen: Snapshot) -> Verdict:
        if self.armed and not at_rest(seen):
            reason = f"disarm: the robot drives with {seen.speed_mps:.2f} m/s; stop it first, or force"
            return Verdict(accepted=False, reason=reason, temporary=True)
        self.armed = False
        return Verdict(accepted=True, reason="disarmed: the drives hold still")

    def _clear(self, seen: Snapshot) -> Verdict:
        if not self.emergency_stopped:
            return Verdict(accepted=True, reason="no emergency stop is latched")
        if self._final:
            return Verdict(
                accepted=False, reason="this emergency stop is cleared by a restart of the bridge only"
            )
        if not at_rest(seen):
            return Verdict(accepted=False, reason="clear: the robot still moves", temporary=True)
        self.emergency_stopped = False
        return Verdict(accepted=True, reason="emergency stop cleared; arm to move")

    def _ready(self, drive: Drive, now: Nanoseconds) -> bool:
        heard = drive.heard
        fit = drive.configured and not drive.busy and not self._silent(drive, now)
        return fit and heard.state is State.OPERATION_ENABLED and not heard.fault

    def _silent(self, drive: Drive, now: Nanoseconds) -> bool:
        return now - drive.heard.heard_at >= self._silent_after


def _kind(hold: Hold) -> str:
    """Return a hold's name without the axis."""
    return hold.name.split(":")[0]
