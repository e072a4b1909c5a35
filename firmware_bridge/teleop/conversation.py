"""One message from a station and everything that is answered to it: a row for each message that is heard."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Final, TypeAlias

from firmware_bridge.intent import EmergencyStop, Intent, Request, ResetOdometry, Verdict
from firmware_bridge.motion.lift import highest
from firmware_bridge.teleop import setpoints
from firmware_bridge.teleop.commands import Order, Result, obey
from firmware_bridge.teleop.mavlink import Message, dialect, text_of
from firmware_bridge.teleop.session import REMEMBERED, Answered, Peer, Session
from firmware_bridge.teleop.setpoints import Setpoint, Unusable
from firmware_bridge.teleop.texts import Severity
from firmware_bridge.units import NEVER, Nanoseconds

Decide: TypeAlias = Callable[[Request], Verdict]

_PROGRESS_UNKNOWN: Final = 0
_LONGEST_INTERVAL_US: Final = 0x7FFF_FFFF


@dataclass(slots=True)
class Conversation:
    """What one message brings about; it is the desk to which the command rows turn."""

    session: Session
    message: Message
    peer: Peer
    now: Nanoseconds
    decide: Decide
    replies: list[Message] = field(default_factory=list)

    @property
    def armed(self) -> bool:
        """Whether the robot may move, as of the newest snapshot."""
        return self.session.snapshot is not None and self.session.snapshot.armed

    def request(self, request: Request) -> Verdict:
        """Ask the bridge; a lift target does not outlive a change of state, it would act unasked later."""
        verdict = self.decide(request)
        session = self.session
        if not verdict.accepted:
            return verdict
        if isinstance(request, ResetOdometry):
            session.resets += 1
        else:
            session.intent = replace(session.intent, lift_m=None, lift_rate_mps=0.0)
        if isinstance(request, EmergencyStop) and request.final:
            session.terminated = True
        return verdict

    def switch(self, *, headlamp: bool | None = None, detector: bool | None = None) -> None:
        """Switch a device; None leaves it as it is."""
        intent = self.session.intent
        self.session.intent = replace(
            intent,
            headlamp=intent.headlamp if headlamp is None else headlamp,
            detector=intent.detector if detector is None else detector,
        )

    def lift_to(self, share: float) -> None:
        """Send the platform to a share of its travel, 0 to 1."""
        height = share * highest(self.session.robot.lift)
        self.session.intent = replace(self.session.intent, lift_m=height, lift_rate_mps=0.0)

    def send(self, number: int) -> bool:
        """Send a message once; False where the bridge has none with this number."""
        messages = self.session.messages(number)
        self.replies += messages or ()
        return messages is not None

    def period(self, number: int) -> Nanoseconds | None:
        """Return how often a message is sent; `NEVER` for not at all, None where it is no stream."""
        return self.session.schedule.period(number)

    def change_period(self, number: int, period: Nanoseconds | None) -> None:
        """Change how often a message is sent; `NEVER` for not at all, None for the default."""
        self.session.schedule.change(number, period, self.now)

    def tell_period(self, number: int, period: Nanoseconds | None) -> None:
        """Send the MESSAGE_INTERVAL: -1 for switched off, 0 for a message that is no stream."""
        interval = (
            0 if period is None else -1 if period == NEVER else min(period // 1000, _LONGEST_INTERVAL_US)
        )
        self.replies.append(dialect.MAVLink_message_interval_message(number, interval))

    def warn(self, key: str, text: str) -> None:
        """Tell a reason, but not at the rate of a joystick."""
        self.replies += self.session.speaker.say_sometimes(key, text, self.now)

    def move(self, wish: Setpoint | Unusable) -> None:
        """Take a wish for motion as the newest, or say why it is none."""
        session = self.session
        if isinstance(wish, Unusable):
            session.dropped.refused += 1
            self.warn(wish.key, wish.reason)
            return
        if not session.station(self.peer).is_newest(self.message.get_seq(), self.now):
            session.dropped.overtaken += 1
            return
        intent = session.intent
        session.intent = Intent(
            speed_mps=wish.speed_mps,
            steer_rad=intent.steer_rad if wish.steer_rad is None else wish.steer_rad,
            lift_m=None if wish.lift_rate_mps else intent.lift_m,
            lift_rate_mps=wish.lift_rate_mps,
            headlamp=intent.headlamp,
            detector=intent.detector,
            heard_at=self.now,
        )


def _manual_control(talk: Conversation) -> None:
    message, session = talk.message, talk.session
    station = session.station(talk.peer)
    buttons: int = message.buttons
    # The first message of a station has no edges: a button that is already down says nothing new.
    pressed = buttons & ~(buttons if station.buttons is None else station.buttons)
    station.buttons = buttons
    if buttons & setpoints.STOP_BUTTON and not (session.snapshot and session.snapshot.emergency_stopped):
        talk.request(EmergencyStop())
    if pressed & setpoints.DETECTOR_BUTTON:
        talk.switch(detector=not session.intent.detector)
    if pressed & setpoints.HEADLAMP_BUTTON:
        talk.switch(headlamp=not session.intent.headlamp)
    talk.move(setpoints.of_stick(message, session.robot))


def _set_target(talk: Conversation) -> None:
    talk.move(setpoints.of_target(talk.message, talk.session.robot))


def _command(talk: Conversation) -> None:
    message = talk.message
    last = (message.x, message.y) if message.get_type() == "COMMAND_INT" else (message.param5, message.param6)
    height = message.z if message.get_type() == "COMMAND_INT" else message.param7
    params = (message.param1, message.param2, message.param3, message.param4, *last, height)
    _order(talk, Order(message.command, params), repeated=getattr(message, "confirmation", 0) > 0)


def _set_mode(talk: Conversation) -> None:
    """Take the old SET_MODE as its command, and answer under the message's number, as ArduPilot does."""
    answer = obey(
        Order(dialect.MAV_CMD_DO_SET_MODE, (talk.message.base_mode, talk.message.custom_mode, 0, 0, 0, 0, 0)),
        talk,
    )
    _acknowledge(talk, dialect.MAVLINK_MSG_ID_SET_MODE, answer.result)


def _order(talk: Conversation, order: Order, *, repeated: bool) -> None:
    station = talk.session.station(talk.peer)
    before = station.answered
    if repeated and before is not None and talk.now - before.at < REMEMBERED:
        same = before.command == order.command and repr(before.params) == repr(order.params)  # NaN is not NaN
        if same:
            _acknowledge(talk, order.command, before.result)
            return
    answer = obey(order, talk)
    if answer.reason:
        talk.replies += talk.session.speaker.say(Severity.WARNING, answer.reason)
    station.answered = Answered(order.command, order.params, answer.result, talk.now)
    _acknowledge(talk, order.command, answer.result)


def _acknowledge(talk: Conversation, command: int, result: Result | int) -> None:
    talk.replies.append(
        dialect.MAVLink_command_ack_message(command, result, _PROGRESS_UNKNOWN, 0, *talk.peer),
    )


def _parameter_list(talk: Conversation) -> None:
    talk.session.listed = 0
    talk.session.list_due = talk.now


def _parameter_read(talk: Conversation) -> None:
    index = talk.session.store.find(talk.message.param_index, talk.message.param_id)
    if index is None:
        _parameter_error(talk, talk.message.param_index)
    else:
        talk.replies.append(talk.session.store.message(index))


def _parameter_set(talk: Conversation) -> None:
    session, message = talk.session, talk.message
    index = session.store.find(-1, message.param_id)
    if index is None:
        _parameter_error(talk, -1)
        return
    trouble = session.store.change(index, message.param_value)
    if trouble:
        talk.warn(f"parameter {index}", trouble)
    else:
        stream, rate = session.store.rate(index)
        if stream is not None:
            session.schedule.change(stream, round(1e9 / rate) if rate > 0.0 else NEVER, talk.now)
    talk.replies.append(session.store.message(index))


def _parameter_error(talk: Conversation, index: int) -> None:
    name = text_of(talk.message.param_id).encode("ascii")
    unknown = dialect.MAV_PARAM_ERROR_DOES_NOT_EXIST
    talk.replies.append(dialect.MAVLink_param_error_message(*talk.peer, name, index, unknown))


def _mission_list(talk: Conversation) -> None:
    talk.replies.append(dialect.MAVLink_mission_count_message(*talk.peer, 0, talk.message.mission_type))


def _mission_refused(talk: Conversation) -> None:
    _mission_ack(talk, dialect.MAV_MISSION_UNSUPPORTED)


def _mission_item_missing(talk: Conversation) -> None:
    _mission_ack(talk, dialect.MAV_MISSION_INVALID_SEQUENCE)


def _mission_cleared(talk: Conversation) -> None:
    _mission_ack(talk, dialect.MAV_MISSION_ACCEPTED)


def _mission_ack(talk: Conversation, kind: int) -> None:
    talk.replies.append(dialect.MAVLink_mission_ack_message(*talk.peer, kind, talk.message.mission_type))


def _timesync(talk: Conversation) -> None:
    if talk.message.tc1 == 0:  # anything else answers a request, and we made none
        talk.replies.append(dialect.MAVLink_timesync_message(max(talk.now, 1), talk.message.ts1))


def _ping(talk: Conversation) -> None:
    message = talk.message
    if (message.target_system, message.target_component) == (0, 0):
        talk.replies.append(dialect.MAVLink_ping_message(message.time_usec, message.seq, *talk.peer))


HEARD: Final[dict[int, Callable[[Conversation], None]]] = {
    dialect.MAVLINK_MSG_ID_MANUAL_CONTROL: _manual_control,
    dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: _set_target,
    dialect.MAVLINK_MSG_ID_COMMAND_LONG: _command,
    dialect.MAVLINK_MSG_ID_COMMAND_INT: _command,
    dialect.MAVLINK_MSG_ID_SET_MODE: _set_mode,
    dialect.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: _parameter_list,
    dialect.MAVLINK_MSG_ID_PARAM_REQUEST_READ: _parameter_read,
    dialect.MAVLINK_MSG_ID_PARAM_SET: _parameter_set,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: _mission_list,
    dialect.MAVLINK_MSG_ID_MISSION_COUNT: _mission_refused,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST: _mission_item_missing,
    dialect.MAVLINK_MSG_ID_MISSION_REQUEST_INT: _mission_item_missing,
    dialect.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: _mission_cleared,
    dialect.MAVLINK_MSG_ID_TIMESYNC: _timesync,
    dialect.MAVLINK_MSG_ID_PING: _ping,
}
