"""A ground station, and one message of it as it is handled: what it may bring about, and what is answered."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from firmware_bridge.intent import (
    NEVER_RECEIVED,
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
from firmware_bridge.mavlink.age import BOOT_WRAPS, SET_POINT, Age, Ages
from firmware_bridge.mavlink.channels import Channels
from firmware_bridge.mavlink.command import ACCEPTED, CommandAnswer
from firmware_bridge.mavlink.frames import FrameNumbers, Message, Sequenced, dialect
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.teleop.station import Motion, Unusable
from firmware_bridge.teleop.texts import Quality
from firmware_bridge.units import NEVER, Nanoseconds, to_seconds
from firmware_bridge.wire.internet import place_of

if TYPE_CHECKING:
    from firmware_bridge.teleop.operator_link import OperatorLink

LATEST_BOOT_MS: Final = 10_000
"""So far behind the newest one a set-point's time is overtaken; further behind its station has restarted."""
UNUSED: Final = 0x7FFF
"""The value of an axis of MANUAL_CONTROL that a station does not use."""
STOPS: Final = (Disarm, EmergencyStop, Pause)
"""The requests that are obeyed however old they are; no older message undoes one of them."""
Decide: TypeAlias = Callable[[Request], Answer]
LONGEST_INTERVAL_US: Final = 0x7FFF_FFFF
"""MESSAGE_INTERVAL carries 31 bits of a time."""
_ANSWER_WITHIN_S: Final = 10.0
"""Time for which a station shows its operator the request of another one for control."""


class Sender(NamedTuple):
    """A sender: the source of its datagrams, and its system and component."""

    source: int
    """The packet's address: what `firmware_bridge.wire.internet` makes of a place, or 0 on a link to one."""
    system: int
    component: int

    def __str__(self) -> str:
        place = place_of(self.source)
        return f"{self.system}/{self.component}" + (f" at {place}" if place else "")


class AnsweredCommand(NamedTuple):
    """A command, its parameters and what was answered, for its repetitions."""

    command: int
    params: tuple[float, ...]
    result: int
    at: Nanoseconds


class LastCommand(NamedTuple):
    """A station's newest motion command."""

    motion: Motion
    at: Nanoseconds
    deflected: str
    """The controls that are not neutral in it; empty where it is neutral."""


@dataclass(slots=True)
class Lever:
    """Position of one station's z when its button was pressed."""

    stood: int = 0
    """The value that counts as neutral; 0 until the button is pressed."""
    held: bool = False
    _z: int = UNUSED
    _received_at: Nanoseconds = NEVER_RECEIVED

    def receive(self, z: int, now: Nanoseconds, silent_after: Nanoseconds, *, held: bool) -> None:
        """Take a message's z, and whether the button is held in it.

        It was pressed since the message before: what z was there, it was then. After a silence no one knows.
        """
        fresh = self._received_at != NEVER_RECEIVED and now - self._received_at < silent_after
        if held and not (self.held and fresh):
            # The button was pressed between two messages: z of the one before is where it stood.
            self.stood = self._z if fresh and self._z != UNUSED else z
        self.held, self._z, self._received_at = held, z, now


@dataclass(slots=True, eq=False)
class Station:
    """One ground station: its last messages, its controls, and its clocks while it is in control."""

    sender: Sender
    received_at: Nanoseconds = 0
    """Time of its newest good frame, whatever it is."""
    last_command: LastCommand | None = None
    """Its last command while it was in control or no station was: others' commands are ignored."""
    moved: Sequenced | None = None
    """Its newest motion command."""
    boot_ms: int | None = None
    """The newest time that a set-point carried."""
    stopped: Sequenced | None = None
    """Its newest stop command."""
    buttons: int | None = None
    channels: Channels = field(default_factory=Channels)
    lever: Lever = field(default_factory=Lever)
    unread: set[str] = field(default_factory=set)
    """Its axes that were reported as deflected and not read."""
    answered: AnsweredCommand | None = None
    stop_answered_at: Nanoseconds = NEVER_RECEIVED
    """Time of the answer to its emergency stop while another station was in control."""
    numbers: FrameNumbers = field(default_factory=FrameNumbers)
    later: bool = False
    """The newest frame is of a second station that calls itself so, which came later."""
    neutral_at: Nanoseconds = NEVER_RECEIVED
    """Time when that one was neutral."""
    clocks: Ages = field(default_factory=lambda: Ages(signed=False))
    """Its clocks and its link since it took control; nothing is known of them before."""
    quality: Quality = field(default_factory=Quality)

    def receive(self, message: Message, now: Nanoseconds) -> bool:
        """Take note of a good frame; return whether it shows that two stations have this number."""
        alone = not self.numbers.two
        self.received_at = now
        self.clocks.losses.received(message.get_seq(), now)
        self.later = self.numbers.receive(message.get_seq(), message.get_crc(), now)
        if alone and self.numbers.two:
            self.moved = None
            return True
        return False

    def is_newest(self, message: Message, now: Nanoseconds) -> bool:
        """Return whether a motion command is newer than all before it, and remember it if so."""
        sequence = message.get_seq()
        if self.moved is not None and self.moved.overtook(sequence, now):
            return False
        if message.get_msgId() == SET_POINT and message.time_boot_ms != 0:
            time: int = message.time_boot_ms
            behind = 0 if self.boot_ms is None else (self.boot_ms - time) % BOOT_WRAPS
            # Only both together: a clock that was set back goes on with the next number.
            if self.moved is not None and self.moved.follows(sequence) and 0 < behind <= LATEST_BOOT_MS:
                return False
            self.boot_ms = time
        self.moved = Sequenced(sequence, now)
        return True

    def age(self, message: Message, now: Nanoseconds, limit: Nanoseconds) -> Age | None:
        """Return the age of a message that arrives now, of the station in control; None where it is unknown.

        Ways to find it that differ by more than `limit` do not date it.
        """
        clocks = self.clocks
        if clocks.signed or message.get_msgId() == SET_POINT:
            return clocks.age(message, now, limit)
        # It carries no time: all that is known is that it has travelled.
        trips = clocks.trips
        trip = trips.least if now <= trips.least_until else trips.newest(now)
        return None if trip is None else Age(trip // 2, timestamped=False)


class Incoming:
    """A message, its station, and what is answered to it."""

    __slots__ = ("decide", "doubted", "link", "message", "now", "refusal", "replies", "station")

    def __init__(
        self,
        link: "OperatorLink",
        station: Station,
        message: Message,
        now: Nanoseconds,
        decide: Decide,
        *,
        refusal: str | None = None,
        doubted: bool = False,
    ) -> None:
        """Take the message with the instant of its arrival, and what judges requests.

        `refusal` is the reason why the station may not drive, None where it is in control, or no station is;
        with `doubted` the message is untrusted, which is its refusal.
        """
        self.link: Final = link
        self.station: Final = station
        self.message: Final = message
        self.now: Final = now
        self.decide: Final = decide
        self.refusal: Final = refusal
        self.doubted: Final = doubted
        self.replies: list[Message] = []

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

    def inject(self, unit: float, kind: float, instance: float) -> CommandAnswer:
        """Carry out an injected failure, and report to all operators what is on."""
        answer = self.link.injection.request(unit, kind, instance)
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
