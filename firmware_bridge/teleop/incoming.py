"""One message of a ground station as it is handled: what it may bring about, and what is answered."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

from firmware_bridge.intent import (
    OF_ANYONE,
    Answer,
    Arm,
    ChangeDriver,
    Disarm,
    EmergencyStop,
    Pause,
    Request,
    ResetOdometry,
    kind_of,
)
from firmware_bridge.mavlink.command import ACCEPTED, CommandAnswer
from firmware_bridge.mavlink.frames import Message, Sequenced, dialect
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.teleop.station import Motion, Unusable
from firmware_bridge.teleop.stations import Station
from firmware_bridge.units import NEVER, Nanoseconds, to_seconds

if TYPE_CHECKING:
    from firmware_bridge.teleop.operator_link import OperatorLink

STOPS: Final = (Disarm, EmergencyStop, Pause)
"""The requests that are obeyed however old they are; no older message undoes one of them."""
Decide: TypeAlias = Callable[[Request], Answer]
LONGEST_INTERVAL_US: Final = 0x7FFF_FFFF
"""MESSAGE_INTERVAL carries 31 bits of a time."""
_ANSWER_WITHIN_S: Final = 10.0
"""Time for which a station shows its operator the request of another one for control."""


@dataclass(slots=True, eq=False)
class Incoming:
    """A message, its station, and what is answered to it."""

    link: "OperatorLink"
    station: Station
    message: Message
    now: Nanoseconds
    decide: Decide
    refusal: str | None = None
    """The reason why the station may not drive; None where it is in control, or no station is."""
    doubted: bool = False
    """The message is untrusted: that is its refusal."""
    replies: list[Message] = field(default_factory=list)

    @property
    def address(self) -> tuple[int, int]:
        """The station's system and component, to which an answer is addressed."""
        return self.station.sender.system, self.station.sender.component

    @property
    def late(self) -> str | None:
        """The reason why a command to move is too late; None where it is in time, or of unknown age."""
        station, limit = self.station, self.link.driving.age_limit.most
        if station.stopped is not None and station.stopped.overtook(self.message.get_seq(), self.now):
            return "it was sent before a stop command, and came after it"
        if station is not self.link.stations.in_control:
            return None
        age = station.age(self.message, self.now, limit)
        if age is None or age.nanoseconds < limit:
            return None
        return f"it was sent {to_seconds(age.nanoseconds):.2f} s ago, limit {to_seconds(limit):.2f} s"

    @property
    def schedule(self) -> Schedule:
        """Schedule of the station's place."""
        return self.link.audience.schedule(self.station.sender.source) or self.link.schedule

    def request(self, request: Request) -> Answer:
        """Forward a request of the station in control; forget the state that it makes obsolete.

        Of any other station an emergency stop is obeyed, and nothing else. It does not disable the power,
        which would let the robot roll, and it can be reset.
        """
        link, station = self.link, self.station
        if isinstance(request, STOPS):
            # Before the judgment: whatever becomes of this stop, no older message of the station may undo it.
            station.stopped = Sequenced(self.message.get_seq(), self.now)
        refused = self._refused(request)
        if refused is not None:
            return refused
        # A forced disarm of another station, too, only brakes: without power the robot could roll.
        if self.refusal is not None:
            request = EmergencyStop()
            link.texts.sometimes("stopped", f"emergency stop by {station.sender}", self.now)
        if isinstance(request, Arm) and not link.status.armed:
            link.driving.adopt(station, self.now)
        verdict = self.decide(request)
        if verdict.accepted:
            self._granted(request)
        return verdict

    def _granted(self, request: Request) -> None:
        """Take note of what the bridge has done."""
        link = self.link
        # A ground station without the protocol for control gets it by arming.
        if isinstance(request, Arm) and link.stations.in_control is None:
            link.stations.take(self.station)
            self._report_control()
        if isinstance(request, Pause):
            link.driving.by_hand()
        link.status.granted(request, self.now)
        if not isinstance(request, ResetOdometry):
            link.driving.forget()

    def _refused(self, request: Request) -> Answer | None:
        """Refuse a request of a station not in control, or one too late; stops are not refused."""
        if self.refusal is not None:
            return None if kind_of(request) in OF_ANYONE else Answer(accepted=False, reason=self.refusal)
        late = None if isinstance(request, STOPS) else self.late
        if late is None:
            return None
        self.link.dropped.aged += 1
        return Answer(accepted=False, reason=late, temporary=True)

    def emergency_stop(self) -> None:
        """Request an emergency stop, once for each time that it is latched."""
        if not self.link.status.stopped:
            self.request(EmergencyStop())

    def take_control(self, *, yields: bool = False) -> None:
        """Give the station control; nothing moves before its own controls are neutral."""
        link = self.link
        changes = link.stations.in_control is not self.station
        link.stations.take(self.station, yields=yields)
        if changes:
            link.driving.by_hand()
            link.driving.adopt(self.station, self.now)
            # Before the texts: nothing moves until the new station's own stick was neutral.
            self.decide(ChangeDriver())
            self._report_control()

    def _report_control(self) -> None:
        """Report which station is in control, and what it must know of the robot's start."""
        for text in (f"control: {self.station.sender} is in control", *self.link.notes):
            self.link.texts.report(Severity.NOTICE, text)

    def give_up_control(self) -> None:
        """Let no one drive: the robot comes to standstill, disarmed."""
        # Before control is given up: the robot comes to standstill and is disarmed in any case.
        self.decide(Disarm())
        self.decide(ChangeDriver())
        self.link.end_control(self.now)
        text = f"control: {self.station.sender} has released it, no station in control"
        self.link.texts.report(Severity.NOTICE, text)

    def ask_for_control(self, command: int) -> None:
        """Inform the station in control of this one's request, and forward it as a command."""
        link, in_control = self.link, self.link.stations.in_control
        sender, driver = self.station.sender, None if in_control is None else in_control.sender
        text = f"control: {sender} requests it; {driver} is in control"
        if link.texts.sometimes("requested control", text, self.now) and driver is not None:
            ask = (1.0, 0.0, _ANSWER_WITHIN_S, float(sender.system), 0.0, 0.0, 0.0)
            link.texts.unsent.append(
                dialect.MAVLink_command_long_message(driver.system, driver.component, command, 0, *ask)
            )

    def change_interval(self, number: int, period: Nanoseconds | None, default: Nanoseconds) -> str | None:
        """Change a message's interval to the station's place, None: as for all; or return why not."""
        link, source, refusal = self.link, self.station.sender.source, self.refusal
        # A station that only watches must not slow the telemetry of the one that drives.
        if refusal is not None and source == link.stations.source:
            return refusal
        if refusal is not None and period is not None and period < default:
            return f"{refusal}; until then no message comes more often than by default"
        if not link.audience.is_recipient(source, link.stations.source, self.now):
            return "message interval: send heartbeats first, telemetry goes to stations"
        link.audience.change(source, number, period, link.schedule, self.now)
        return None

    def inject(self, unit: float, kind: float) -> CommandAnswer:
        """Carry out an injected failure, and report to all operators what is on."""
        answer = self.link.injection.request(unit, kind)
        if answer is ACCEPTED:
            active = ", ".join(self.link.injection.active) or "none"
            self.link.texts.report(Severity.WARNING, f"injected failures: {active}")
        return answer

    def send_interval(self, number: int) -> None:
        """Send the interval of a message to the station's place: 0 is no stream, -1 one that is off."""
        period = self.schedule.period(number)
        interval = (
            0 if period is None else -1 if period == NEVER else min(period // 1000, LONGEST_INTERVAL_US)
        )
        self.replies.append(dialect.MAVLink_message_interval_message(number, interval))

    def send(self, number: int, which: int = 0) -> bool:
        """Send a message once; False where the bridge has none with this number.

        Of a message that there is of each of several things: all of them, or the one that is `which`, from 1.
        """
        messages = self.link.status.messages(number, which)
        self.replies += messages or ()
        return messages is not None

    def warn(self, key: str, text: str) -> None:
        """Send a reason, but not at the rate of a joystick."""
        self.replies += self.link.texts.speaker.say_sometimes(key, text, self.now)

    def newest(self) -> bool:
        """Return whether no newer motion command has overtaken this one."""
        newest = self.station.is_newest(self.message, self.now)
        self.link.dropped.overtaken += not newest
        return newest

    def move(self, motion: Motion, deflected: str) -> None:
        """Take a motion command, or say why it is none; `deflected` is empty for neutral."""
        unusable = self.link.driving.take(self.station, self.message, motion, deflected, self.now)
        if unusable is not None:
            self.refuse(unusable)

    def report_unread(self, name: str, value: int) -> None:
        """Report once a deflected axis that the robot does not read."""
        if name not in self.station.unread:
            self.station.unread.add(name)
            text = f"{name} of {self.station.sender} stands at {value}: this robot does not read it"
            self.link.texts.report(Severity.INFO, text)

    def ignore(self) -> None:
        """Report that a motion command of a station not in control moves nothing."""
        self.link.dropped.undriven += 1
        text = f"{self.message.get_type()} of {self.station.sender} moves nothing: {self.refusal}"
        self.warn("control", text)

    def refuse(self, unusable: Unusable) -> None:
        """Say why a motion command is refused."""
        self.link.dropped.refused += 1
        self.warn(unusable.key, f"{self.message.get_type()} refused: {unusable.reason}")
