"""A ground station as a node: data of the link for its operator, and the operator's commands.

It opens no socket, reads no clock, and sees nothing but the link's data.
"""

import math
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from firmware_bridge.mavlink.frames import Message, dialect, text_of
from firmware_bridge.mavlink.texts import TextCollector
from firmware_bridge.mavlink.trust import ANY_STATION, Signatures, Stamps, Trust
from firmware_bridge.motion.model import Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.driver import DriveCommand, Driver, Sight, Stick, Target
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.profiles import ORDER, USUAL, Profile
from firmware_bridge.pilot.video import Video, VideoFeed
from firmware_bridge.teleop.telemetry import ROLLING, UNKNOWN_U16
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

SYSTEM: Final = 255
COMPONENT: Final = dialect.MAV_COMP_ID_MISSIONPLANNER
PERIOD: Final[Nanoseconds] = 50 * MILLISECOND
"""Packets at 20 Hz (A. P. Das, PhD thesis, IIT Delhi, 2018, 4.2)."""
SILENT: Final[Nanoseconds] = 3 * SECOND
"""Silence of heartbeats after which a robot may have forgotten the requested intervals."""
RETRY_AFTER: Final[Nanoseconds] = SECOND
MOST_TRIES: Final = 20
FULL: Final = 1000
_LINK: Final = 1
"""Of signatures."""
_UNUSED: Final = 0x7FFF
_PARAMS: Final = 7
_BOOT_MASK: Final = 0xFFFF_FFFF
_VELOCITY_AND_TURN: Final = 0x05E7
"""SET_POSITION_TARGET_LOCAL_NED's mask: all but the velocity and the yaw rate is to be left alone."""


@dataclass(slots=True)
class PendingCommand:
    """A command that has no final answer yet."""

    title: str
    number: int
    params: tuple[float, ...]
    due: Nanoseconds
    tries: int = 0


class RobotText(NamedTuple):
    """A text of the robot."""

    at: Nanoseconds
    text: str


@dataclass(slots=True)
class Display:
    """Content of the station's display."""

    armed: bool = False
    received: bool = False
    """The robot's heartbeat has come."""
    sight: Sight | None = None
    """What the driver sees."""
    newest: Sight | None = None
    """The newest pose that came, seen or not."""
    values: dict[str, float] = field(default_factory=dict)
    """The newest of each named value, switches too: RTT, AGE and LOSS are as the robot finds them."""
    speeds: tuple[float, ...] = ()
    """Of the axes that roll, in the robot's order and units; zeros after the last one."""
    battery_v: float | None = None
    lines: list[RobotText] = field(default_factory=list)
    warning: str = ""
    """The robot's newest warning, or worse."""


class PilotStation:
    """One station, one robot, and its driver."""

    def __init__(
        self,
        driver: Driver,
        target: tuple[int, int],
        *,
        trust: Trust = ANY_STATION,
        requests: Profile = USUAL,
        video: Video | None = None,
    ) -> None:
        """Send to the system and component `target`; `requests`: the intervals to request from the robot.

        With a key in `trust` frames are signed, and only signed ones are accepted. With a `video` the robot
        is seen by its pictures alone, else by each pose as it comes.
        """
        self.driver: Final = driver
        self.link: Final = PilotLink()
        self.shown: Final = Display()
        self._target: Final = target
        self._requests: Final = requests
        self._video: Final = None if video is None else VideoFeed(video)
        self._codec: Final = trust.writer(SYSTEM, COMPONENT, _LINK)
        self._signatures: Final = Signatures(trust)
        self._doubted = False
        """True once an untrusted frame was reported, since the last trusted one."""
        self._beat_at: Nanoseconds | None = None
        """Time of the robot's last heartbeat."""
        self._listener: Final = TextCollector()
        self._orders: Final[list[PendingCommand]] = []
        self._answers: Final[list[Message]] = []
        self._place = 0
        """Place of the robot's newest frame."""
        self._beat_due: Nanoseconds = 0
        self._command_due: Nanoseconds = 0
        self._received: Final = {
            dialect.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            dialect.MAVLINK_MSG_ID_COMMAND_ACK: self._acknowledged,
            dialect.MAVLINK_MSG_ID_STATUSTEXT: self._on_text,
            dialect.MAVLINK_MSG_ID_ODOMETRY: self._located,
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT: self._valued,
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT: self._valued,
            dialect.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY: self._rolling,
            dialect.MAVLINK_MSG_ID_BATTERY_STATUS: self._charged,
            dialect.MAVLINK_MSG_ID_TIMESYNC: self._timed,
            dialect.MAVLINK_MSG_ID_PING: self._pinged,
        }

    def order(self, title: str, number: int, params: tuple[float, ...], now: Nanoseconds) -> None:
        """Send a command with the next wake, and again until it is answered for good."""
        self._orders.append(PendingCommand(title, number, params, now))

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Read the robot's messages; its requests are answered at once."""
        for message in self._codec.decode(packet.payload):
            # Another robot, or a third party, on the same network.
            if message.get_srcSystem() != self._target[0] or not self._believed(message, packet.address, now):
                continue
            self._place = packet.address
            self.link.received(message.get_seq(), now)
            read = self._received.get(message.get_msgId())
            if read is not None:
                read(message, now)
        answers = tuple(self._packet(one, now) for one in self._answers)
        self._answers.clear()
        return Reaction(answers, self._wake_at())

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send what is due: a heartbeat, a question, commands, and what the station in control commands."""
        messages: list[Message] = []
        if self._video is not None and (picture := self._video.shown(now)) is not None:
            self._see(picture)
        if now >= self._beat_due:
            self._beat_due = now + SECOND
            station, none = dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID
            messages.append(
                dialect.MAVLink_heartbeat_message(station, none, 0, 0, dialect.MAV_STATE_ACTIVE, 3)
            )
        if now >= self.link.next_question:
            messages.append(self.link.question(now))
        messages += self._ordered(now)
        if now >= self._command_due:
            # Not from now on: the rate stays, whatever the delay of one wake-up.
            self._command_due += PERIOD
            command = self.driver.command(self.link, now, armed=self.shown.armed)
            messages.append(self._encoded(command, now))
        return Reaction(tuple(self._packet(one, now) for one in messages), self._wake_at())

    def stamps(self, now: Nanoseconds) -> Stamps:
        """Return which signatures' time stamps must outlive this run."""
        return self._signatures.kept(now)

    def _packet(self, message: Message, now: Nanoseconds) -> Packet:
        return Packet(OPERATOR, self._place, self._codec.encode(message, self._signatures.stamp(now)))

    def _believed(self, message: Message, source: int, now: Nanoseconds) -> bool:
        """Return whether a frame is the robot's; the first that is not is reported."""
        doubt = self._signatures.doubt(message, source, now)
        if doubt is not None and not self._doubted:
            self.shown.lines.append(
                RobotText(now, f"what comes in the robot's name is not believed: it {doubt}")
            )
        self._doubted = doubt is not None
        return doubt is None

    def _wake_at(self) -> Nanoseconds:
        due = min(self._beat_due, self._command_due, self.link.next_question)
        if self._video is not None:
            due = min(due, self._video.due)
        return min([due, *(order.due for order in self._under_way)])

    @property
    def _under_way(self) -> list[PendingCommand]:
        """Return one order of each number: an answer carries a number alone."""
        # Reversed, so that of several the oldest is kept.
        return list({order.number: order for order in reversed(self._orders)}.values())

    def _ordered(self, now: Nanoseconds) -> list[Message]:
        messages = []
        for order in [one for one in self._under_way if one.due <= now]:
            if order.tries == MOST_TRIES:
                self._orders.remove(order)
                self.shown.lines.append(RobotText(now, f"{order.title}: no answer"))
                continue
            params = (*order.params, *(0.0,) * (_PARAMS - len(order.params)))
            messages.append(
                # `confirmation` counts repetitions: a receiver distinguishes them from a new command.
                dialect.MAVLink_command_long_message(*self._target, order.number, order.tries, *params)
            )
            order.tries += 1
            # A repetition before the answer can be here would be for nothing.
            order.due = now + RETRY_AFTER + (self.link.round_trip(now) or 0)
        return messages

    def _encoded(self, command: DriveCommand, now: Nanoseconds) -> Message:
        """Return a command in MAVLink's directions: right and clockwise."""
        if isinstance(command, Stick):
            return dialect.MAVLink_manual_control_message(
                self._target[0],
                _axis(command.forward),
                _UNUSED,
                _axis(command.up),
                _axis(-command.left),
                command.buttons,
            )
        # time_boot_ms has 32 bits of milliseconds, and wraps.
        return _velocity(self._target, command, max(now // MILLISECOND, 1) & _BOOT_MASK)

    def _heartbeat(self, message: Message, now: Nanoseconds) -> None:
        # A robot that restarted has forgotten the intervals.
        if self._beat_at is None or now - self._beat_at > SILENT:
            for number, period in self._requests.items():
                self.order(f"message {number}", ORDER, (float(number), period / MICROSECOND), now)
        self._beat_at = now
        self.shown.received = True
        self.shown.armed = bool(message.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)

    def _acknowledged(self, message: Message, now: Nanoseconds) -> None:
        again = message.result in {dialect.MAV_RESULT_TEMPORARILY_REJECTED, dialect.MAV_RESULT_IN_PROGRESS}
        for order in self._orders:
            if order.number == message.command and order.tries:
                if again:
                    # In progress, or refused for now: the same command may succeed later.
                    order.tries = 1
                    return
                self._orders.remove(order)
                if message.result != dialect.MAV_RESULT_ACCEPTED:
                    self.shown.lines.append(RobotText(now, f"{order.title}: refused ({message.result})"))
                return

    def _on_text(self, message: Message, now: Nanoseconds) -> None:
        for received in self._listener.receive(message):
            self.shown.lines.append(RobotText(now, received.text))
            if received.severity <= dialect.MAV_SEVERITY_WARNING:
                self.shown.warning = received.text

    def _located(self, message: Message, now: Nanoseconds) -> None:
        w, _, _, z = message.q
        # NED to x ahead, y left: y and the heading change sign; heading = 2 atan2(z, w) for a turn about z.
        pose = Pose(message.x, -message.y, -2.0 * math.atan2(z, w))
        moving = Moving(pose, message.vx, -message.yawspeed)
        sight = Sight(moving, self.link.measured_at(message.time_usec * 1000, now), now)
        self.shown.newest = sight
        if self._video is None:
            self._see(sight)
        else:
            self._video.filmed(sight)

    def _see(self, sight: Sight) -> None:
        self.shown.sight = sight
        self.driver.sees(sight)

    def _valued(self, message: Message, _now: Nanoseconds) -> None:
        self.shown.values[text_of(message.name)] = float(message.value)

    def _rolling(self, message: Message, _now: Nanoseconds) -> None:
        if text_of(message.name) == ROLLING:
            self.shown.speeds = tuple(message.data)

    def _charged(self, message: Message, _now: Nanoseconds) -> None:
        self.shown.battery_v = None if message.voltages[0] == UNKNOWN_U16 else message.voltages[0] / 1000.0

    def _timed(self, message: Message, now: Nanoseconds) -> None:
        # tc1 = 0 is a request, which the answer returns with our own time.
        if message.tc1 == 0:
            self._answers.append(dialect.MAVLink_timesync_message(max(now, 1), message.ts1))
        else:
            self.link.answered(message, now)

    def _pinged(self, message: Message, _now: Nanoseconds) -> None:
        if message.target_system == 0:
            self._answers.append(dialect.MAVLink_ping_message(message.time_usec, message.seq, *self._target))


def _axis(share: float) -> int:
    return max(-FULL, min(round(FULL * share), FULL))


def _velocity(target: tuple[int, int], command: Target, boot_ms: int) -> Message:
    nothing = (0.0,) * 3
    return dialect.MAVLink_set_position_target_local_ned_message(
        boot_ms,
        *target,
        dialect.MAV_FRAME_BODY_NED,
        _VELOCITY_AND_TURN,
        *nothing,
        *(command.speed_mps, 0.0, 0.0),
        *nothing,
        0.0,
        # Body axes of NED: a yaw rate is clockwise positive.
        -command.yaw_rate_rad_s,
    )
