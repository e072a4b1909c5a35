"""State of the operators' session between two datagrams, and the context of its telemetry."""

from dataclasses import dataclass, field
from typing import Final, NamedTuple

from firmware_bridge.drivers.driver import Power
from firmware_bridge.intent import NEVER_RECEIVED, AgeLimit, Intent
from firmware_bridge.mavlink import modes as driving_modes
from firmware_bridge.mavlink.age import BOOT_WRAPS, Age, Ages, boot_ms
from firmware_bridge.mavlink.audience import Audience
from firmware_bridge.mavlink.frames import Codec, Message, dialect
from firmware_bridge.mavlink.numbered import Numbered
from firmware_bridge.mavlink.parameters import Store
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.mavlink.texts import Speaker
from firmware_bridge.mavlink.trust import Signatures, Trust
from firmware_bridge.robot import AnyRobot, UnknownAge
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot, Facts
from firmware_bridge.teleop.control import Sender, StationInControl
from firmware_bridge.teleop.driven import Channels, ReportedMode
from firmware_bridge.teleop.manual_control import Lever
from firmware_bridge.teleop.station import AnyStation, Motion, Unusable, Velocity
from firmware_bridge.teleop.streams import parameters_of, streams_of
from firmware_bridge.teleop.telemetry import TelemetryContext
from firmware_bridge.teleop.texts import LinkState, Quality
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

VERSION: Final = (0, 1, 0)
CAPABILITIES: Final = (
    dialect.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | dialect.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | dialect.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | dialect.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | dialect.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
)
LISTING_GAP: Final[Nanoseconds] = 10 * MILLISECOND
"""Gap between two parameters of a list, where the link's bandwidth is not given."""
LISTED_BITS: Final = 1_500
"""Bits of bandwidth for one parameter of a list: a quarter of it for 37 bytes."""
REMEMBERED: Final[Nanoseconds] = 3 * SECOND
"""Time for which a command's answer is kept for its repetitions."""
ANY_STATION: Final = Trust()
OUT_OF_ORDER: Final[Nanoseconds] = 250 * MILLISECOND
"""Time for which an older sequence number is taken for an overtaken datagram, not for a new start."""

OVERTAKEN: Final[Nanoseconds] = 3 * SECOND
"""The same for one only a few behind: a "go" that comes 0.26 s after the stop is no new start."""
FEW: Final = 96
"""Frames of a station in three seconds, at 30 frames a second."""
LATEST_BOOT_MS: Final = 10_000
"""So far behind the newest one a set-point's time is overtaken; further behind its station has restarted."""
_HALF: Final = 0x80
"""Of all sequence numbers; one that is so many or more behind is ahead."""
MOST_UNTOLD: Final = 8
"""Control that changes all the time must not flood those who only watch."""
MOST_PEERS: Final = 64
"""Most stations on record; of more, the one silent for longest is dropped, never the one in control."""
"""A motion command as it came, before a robot interprets it."""
NOTHING: Final = Velocity(0.0, 0.0, 0.0)


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


class Sequenced(NamedTuple):
    """A frame by its sequence number, and when it came."""

    sequence: int
    at: Nanoseconds

    def follows(self, sequence: int) -> bool:
        """Return whether this frame comes after one with another number, as far as eight bits show."""
        return 0 < (self.sequence - sequence) & 0xFF < _HALF

    def overtook(self, sequence: int, now: Nanoseconds) -> bool:
        """Return whether a frame that comes now was sent before this one."""
        behind = (self.sequence - sequence) & 0xFF
        late = OVERTAKEN if behind <= FEW else OUT_OF_ORDER
        return behind < _HALF and now - self.at < late


@dataclass(slots=True)
class Peer:
    """One ground station's last messages."""

    received_at: Nanoseconds = 0
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
    """Its channels of RC_CHANNELS_OVERRIDE."""
    lever: Lever = field(default_factory=Lever)
    unread: set[str] = field(default_factory=set)
    """Its axes that were reported as deflected and not read."""
    answered: AnsweredCommand | None = None
    stop_answered_at: Nanoseconds = NEVER_RECEIVED
    """Time of the answer to its emergency stop while another station was in control."""
    numbered: Numbered = field(default_factory=Numbered)
    later: bool = False
    """The newest frame is of a second station that calls itself so, which came later."""
    neutral_at: Nanoseconds = NEVER_RECEIVED
    """Time when that one was neutral."""

    def is_newest(self, message: Message, now: Nanoseconds) -> bool:
        """Return whether a motion command is newer than all before it, and remember it if so."""
        sequence, time = message.get_seq(), boot_ms(message)
        if self.moved is not None and self.moved.overtook(sequence, now):
            return False
        if time is not None:
            behind = 0 if self.boot_ms is None else (self.boot_ms - time) % BOOT_WRAPS
            # Only both together: a clock that was set back goes on with the next number.
            if self.moved is not None and self.moved.follows(sequence) and 0 < behind <= LATEST_BOOT_MS:
                return False
            self.boot_ms = time
        self.moved = Sequenced(sequence, now)
        return True


@dataclass(slots=True)
class Dropped:
    """Messages that were understood and not obeyed."""

    echoed: int = 0
    """Our own, come back."""
    foreign: int = 0
    """For another system or component."""
    overtaken: int = 0
    """Motion commands that a newer one had overtaken."""
    refused: int = 0
    """Motion commands that made no sense."""
    aged: int = 0
    """Commands to move that were sent before a stop command, or too long ago."""
    idle: int = 0
    """Neutral sticks, while the robot is driven by set-points."""
    undriven: int = 0
    """Motion commands of stations that do not drive."""
    doubted: int = 0
    """Messages that were not signed as they must be, or from a place that is not allowed."""


class Session:
    """The whole memory; one for each bridge."""

    def __init__(
        self,
        robot: AnyRobot,
        station: AnyStation,
        rest: object,
        *,
        rolling: tuple[str, ...],
        modes: tuple[str, ...],
        path_followers: tuple[str, ...] = (),
        trust: Trust = ANY_STATION,
    ) -> None:
        self.robot: Final = robot
        self.station: Final = station
        self.rolling: Final = rolling
        self.modes: Final = ("", *modes)
        """Modes by custom mode; the first is the whole robot's."""
        self.path_followers: Final = ("", *path_followers)
        """Path followers by custom submode; the first is the operator."""
        self.codec: Final = Codec(robot.operator.system_id, robot.operator.component_id)
        self.streams: Final = streams_of(robot, station)
        self.schedule: Final = Schedule(tuple((row.number, row.period) for row in self.streams), robot.cycle)
        self.store: Final = Store(parameters_of(robot, station.parameters, self.schedule))
        self.silent_after: Final[Nanoseconds] = robot.operator.silent_ms * MILLISECOND
        self.driven: Final = ReportedMode(self.silent_after)
        self.speaker: Final = Speaker()
        self.intent: Intent = Intent(rest)
        self.returned_to_neutral = False
        """A neutral motion command has come since the newest cycle, whatever came after it."""
        self.snapshot: AnySnapshot | None = None
        self.events: tuple[ActiveInterlock, ...] = ()
        """The active interlocks of the newest cycle: what the heartbeat reports follows from them."""
        self.trust: Final = trust
        self.signatures: Final = Signatures(trust)
        self.audience: Final = Audience(self.codec.system, self.codec.component, trust, self.signatures.stamp)
        self.namesake = False
        """A station that calls itself as the robot has been named."""
        self.signed_in_vain = False
        """A frame was signed, and there is no key."""
        self.stop_answered_at: Nanoseconds = NEVER_RECEIVED
        """Time of the answer to an untrusted sender's emergency stop."""
        self.control: Final = StationInControl()
        decided = robot.operator.unknown_age
        needed = trust.key is not None if decided is None else decided is UnknownAge.REFUSE
        self.age_limit = AgeLimit(
            robot.operator.age_limit_ms * MILLISECOND, needed, robot.operator.max_age_ms * MILLISECOND
        )
        """Age limit of a message, as agreed on for this session."""
        self._ages: tuple[int, Ages, Quality] = (0, Ages(signed=False), Quality())
        self.peers: Final[dict[Sender, Peer]] = {}
        self.unsent: list[Message] = []
        """Messages about control, sent with the next report, beside the answers."""
        self.notes: tuple[str, ...] = ()
        """Findings of the start for the station in control."""
        self.dropped: Final = Dropped()
        self.terminated = False
        self.cleared_at: Nanoseconds = NEVER_RECEIVED
        """Time of the emergency stop's last reset."""
        self.resets = 0
        bandwidth = robot.operator.bandwidth_bit_s
        slow = 0 if bandwidth is None else LISTED_BITS * SECOND // bandwidth
        self.listing_gap: Final[Nanoseconds] = max(LISTING_GAP, slow)
        self.listed = len(self.store.rows)
        self.list_due: Nanoseconds = NEVER

    @property
    def drives_from(self) -> int | None:
        """The place of the station in control; None without one."""
        return None if self.control.driver is None else self.control.driver.source

    @property
    def ages(self) -> Ages:
        """The clocks and the link of the station in control; after a change of control nothing is known."""
        if self._ages[0] != self.control.turns:
            self._ages = (self.control.turns, Ages(signed=self.trust.key is not None), Quality())
        return self._ages[1]

    def age(self, message: Message, sender: Sender, now: Nanoseconds) -> Age | None:
        """Return the age of a message that arrives now; None where unknown or its sender lacks control."""
        if sender != self.control.driver:
            return None
        return self.ages.age(message, now, self.age_limit.most)

    def report_link(self, now: Nanoseconds) -> None:
        """Report changes about the link of the station in control."""
        ages, quality = self.ages, self._ages[2]
        if self.control.driver is not None:
            for severity, text in quality.changes(
                LinkState(ages, self.age_limit, self.intent.timestamped, now)
            ):
                self.report(severity, text)

    def passed(self, sender: Sender, sequence: int, now: Nanoseconds) -> None:
        """Note a frame for another robot: from the station in control it does not count as missing."""
        if sender == self.control.driver:
            self.ages.losses.received(sequence, now)

    def received(self, sender: Sender, message: Message, now: Nanoseconds) -> Peer:
        """Take note of a good frame; return what is remembered of its sender."""
        self.control.received(sender, now)
        self.passed(sender, message.get_seq(), now)
        peer = self.peers.get(sender)
        if peer is None:
            if len(self.peers) >= MOST_PEERS:
                others = (one for one in self.peers if one != self.control.driver)
                del self.peers[min(others, key=lambda one: self.peers[one].received_at)]
            peer = self.peers[sender] = Peer()
        peer.received_at, alone = now, not peer.numbered.two
        peer.later = peer.numbered.receive(message.get_seq(), message.get_crc(), now)
        if alone and peer.numbered.two:
            peer.moved = None
            text = f"two stations call themselves {sender}: only the first is in control; renumber one"
            self.report(Severity.WARNING, text)
        return peer

    def applied(self, motion: Motion, motion_command: object) -> object:
        """Return what a motion command makes of the one before it; `Unusable` where it is none."""
        made: object = self.station.applied(motion, motion_command, self.robot)
        return made

    def adopt(self, peer: Peer | None, now: Nanoseconds) -> None:
        """Take a station's own newest motion command; no one's, and an old one's, is to standstill.

        What is switched stays as it is.
        """
        motion_command: object = self.station.forgotten(self.intent.command)
        stands = self.applied(NOTHING, motion_command)
        if not isinstance(stands, Unusable):
            motion_command = stands
        self.intent = Intent(motion_command)
        gone = self.robot.operator.lost_ms * MILLISECOND
        if peer is None or peer.last_command is None or now - peer.last_command.at >= gone:
            return
        applied_command = self.applied(peer.last_command.motion, motion_command)
        if not isinstance(applied_command, Unusable):
            self.intent = Intent(applied_command, peer.last_command.at, deflected=peer.last_command.deflected)

    def report(self, severity: Severity, text: str) -> None:
        """Queue a text for the next report, unless the queue is full."""
        if len(self.unsent) < MOST_UNTOLD:
            self.unsent += self.speaker.say(severity, text)

    def set_command(self, motion_command: object) -> None:
        """Change the command; what is no motion command is no sign of life."""
        before = self.intent
        self.intent = Intent(
            motion_command,
            before.received_at,
            before.sent_at,
            timestamped=before.timestamped,
            deflected=before.deflected,
        )

    def set_period(self, number: int, period: Nanoseconds, now: Nanoseconds) -> None:
        """Set a message's period for all places without an interval of their own."""
        self.schedule.follow(number, period, now)
        self.audience.follow(number, period, now)

    def forget(self) -> None:
        """Forget what of a command does not outlive a change of state."""
        self.set_command(self.station.forgotten(self.intent.command))

    def context(self, snapshot: AnySnapshot) -> TelemetryContext:
        """Return the telemetry's context of a snapshot."""
        facts = snapshot.facts
        status = self._status(facts)
        driving_mode = self.driven.driving_mode(paused=facts.paused)
        mode = dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | driving_modes.BY_DRIVING_MODE[driving_mode].flags
        if facts.armed:
            mode |= dialect.MAV_MODE_FLAG_SAFETY_ARMED
        return TelemetryContext(
            robot=self.robot,
            station=self.station,
            rolling=self.rolling,
            snapshot=snapshot,
            twist=self.station.twist(snapshot.body),
            base_mode=mode,
            custom_mode=driving_modes.number_of(driving_mode, self.modes.index(facts.mode)),
            system_status=status,
            healthy=self._trouble(facts) is None,
            corrupt=self.codec.counters.corrupt,
            resets=self.resets,
            round_trip=self.ages.trips.newest(facts.now),
            lost=self.ages.losses.share,
        )

    def messages(self, number: int, which: int = 0) -> tuple[Message, ...] | None:
        """Return a message for one request of a station; None where the bridge has no such message."""
        if number == dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return (_version(),)
        if number == dialect.MAVLINK_MSG_ID_AVAILABLE_MODES:
            modes = driving_modes.listed(self.modes)
            return tuple(modes[which - 1 : which] if which else modes) or None
        streams = [stream for stream in self.streams if stream.number == number]
        if self.snapshot is None or not streams:
            return None
        context = self.context(self.snapshot)
        return tuple(message for stream in streams for message in stream.encode(context))

    def _trouble(self, facts: Facts) -> int | None:
        """Return the status of an emergency stop, a fault or a silent device; None without any."""
        axes = facts.axes.values()
        rows: tuple[tuple[bool, int], ...] = (
            (self.terminated, dialect.MAV_STATE_FLIGHT_TERMINATION),
            (facts.emergency_stopped, dialect.MAV_STATE_EMERGENCY),
            (any(axis.fault for axis in axes), dialect.MAV_STATE_CRITICAL),
            (any(axis.power is Power.UNKNOWN for axis in axes), dialect.MAV_STATE_BOOT),
        )
        return next((state for is_so, state in rows if is_so), None)

    def _status(self, facts: Facts) -> int:
        rows = (one.interlock for one in self.events)
        held = any(row.stops is None and row.severity <= Severity.WARNING for row in rows)
        driven: int = dialect.MAV_STATE_CRITICAL if held else dialect.MAV_STATE_ACTIVE
        state = driven if facts.armed else dialect.MAV_STATE_STANDBY
        trouble = self._trouble(facts)
        return state if trouble is None else trouble


def _version() -> Message:
    major, minor, patch = VERSION
    nothing = (0,) * 8
    return dialect.MAVLink_autopilot_version_message(
        capabilities=CAPABILITIES,
        flight_sw_version=major << 24 | minor << 16 | patch << 8 | dialect.FIRMWARE_VERSION_TYPE_OFFICIAL,
        middleware_sw_version=0,
        os_sw_version=0,
        board_version=0,
        flight_custom_version=nothing,
        middleware_custom_version=nothing,
        os_custom_version=nothing,
        vendor_id=0,
        product_id=0,
        uid=0,
    )
