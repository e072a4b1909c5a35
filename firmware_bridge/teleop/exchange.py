"""One message from a ground station and everything that is answered to it: a row for each message."""

from collections.abc import Callable, Mapping
from typing import Any, Final, Generic, TypeAlias, TypeVar

from firmware_bridge.intent import EmergencyStop, Intent, Request, ResetOdometry, Verdict
from firmware_bridge.robot import Table
from firmware_bridge.safety.row import Severity
from firmware_bridge.teleop.commands import Order, Result, obey
from firmware_bridge.teleop.mavlink import Message, dialect, text_of
from firmware_bridge.teleop.session import REMEMBERED, Address, Answered, Peer, Session
from firmware_bridge.teleop.setpoints import pressed, stick_of, velocity_of
from firmware_bridge.teleop.station import Switch, Unusable
from firmware_bridge.units import NEVER, Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

Decide: TypeAlias = Callable[[Request], Verdict]

_PROGRESS_UNKNOWN: Final = 0
_LONGEST_INTERVAL_US: Final = 0x7FFF_FFFF


class Exchange(Generic[G, M, S]):
    """What one message brings about; a `firmware_bridge.teleop.commands.CommandContext`."""

    __slots__ = ("address", "decide", "message", "now", "replies", "session")

    def __init__(
        self, session: Session[G, M, S], message: Message, address: Address, now: Nanoseconds, decide: Decide
    ) -> None:
        self.session: Final = session
        self.message: Final[Message] = message
        self.address: Final = address
        self.now: Final = now
        self.decide: Final = decide
        self.replies: list[Message] = []

    @property
    def peer(self) -> Peer:
        """What is remembered of the sender."""
        return self.session.peer(self.address)

    @property
    def armed(self) -> bool:
        """Whether the robot may move, as of the newest snapshot."""
        return self.session.snapshot is not None and self.session.snapshot.facts.armed

    @property
    def relays(self) -> Mapping[int, str]:
        """What each relay's number switches."""
        return {switch.relay: switch.name for switch in self.session.station.switches}

    @property
    def illuminators(self) -> tuple[str, ...]:
        """What ILLUMINATOR_ON_OFF switches."""
        return tuple(switch.name for switch in self.session.station.switches if switch.illuminates)

    @property
    def actuators(self) -> tuple[str, ...]:
        """The actuators of set 0."""
        return tuple(actuator.name for actuator in self.session.station.actuators)

    @property
    def modes(self) -> tuple[str, ...]:
        """The robot's modes by their custom mode; the first, "", is the whole robot's."""
        return self.session.modes

    @property
    def guides(self) -> tuple[str, ...]:
        """Who makes the wishes, by the custom submode; the first, "", is the operator."""
        return self.session.guides

    def request(self, request: Request) -> Verdict:
        """Ask the bridge; what of a wish does not outlive a change of state is forgotten."""
        verdict = self.decide(request)
        session = self.session
        if not verdict.accepted:
            return verdict
        if isinstance(request, ResetOdometry):
            session.resets += 1
        else:
            session.wish(session.station.forgotten(session.intent.wish))
        if isinstance(request, EmergencyStop) and request.final:
            session.terminated = True
        return verdict

    def switch(self, relay: int, *, on: bool) -> None:
        """Switch what is behind a relay's number."""
        for switch in self.session.station.switches:
            if switch.relay == relay:
                self._write(switch, on=on)

    def illuminate(self, *, on: bool) -> None:
        """Switch everything that illuminates."""
        for switch in self.session.station.switches:
            if switch.illuminates:
                self._write(switch, on=on)

    def press(self, buttons: int) -> None:
        """Switch over what has its button among these, which have just gone down."""
        for switch in self.session.station.switches:
            if pressed(buttons, switch.button):
                self._write(switch, on=not switch.read(self.session.intent.wish))

    def actuate(self, place: int, share: float) -> None:
        """Send an actuator of set 0 to a share of its travel, 0 to 1."""
        session = self.session
        session.wish(session.station.actuators[place].send(session.intent.wish, share, session.robot))

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

    def send_period(self, number: int, period: Nanoseconds | None) -> None:
        """Send the MESSAGE_INTERVAL: -1 for switched off, 0 for a message that is no stream."""
        interval = (
            0 if period is None else -1 if period == NEVER else min(period // 1000, _LONGEST_INTERVAL_US)
        )
        self.replies.append(dialect.MAVLink_message_interval_message(number, interval))

    def warn(self, key: str, text: str) -> None:
        """Send a reason, but not at the rate of a joystick."""
        self.replies += self.session.speaker.say_sometimes(key, text, self.now)

    def take_stick(self) -> None:
        """Take the axes of a MANUAL_CONTROL as the newest wish, or say why they are none."""
        session, station = self.session, self.session.station
        up = station.up_button is None or pressed(self.message.buttons, station.up_button)
        stick = stick_of(self.message, up=up, dead_band=station.dead_band)
        if isinstance(stick, Unusable):
            self.refuse(stick)
        else:
            self.move(station.stick(stick, session.intent.wish, session.robot))

    def take_target(self) -> None:
        """Take a SET_POSITION_TARGET_LOCAL_NED as the newest wish, or say why it is none."""
        session, station = self.session, self.session.station
        velocity = velocity_of(self.message, station.largest(session.robot))
        if isinstance(velocity, Unusable):
            self.refuse(velocity)
            return
        wish = station.target(velocity, session.intent.wish, session.robot)
        if isinstance(wish, Unusable):
            self.refuse(wish)
        else:
            self.move(wish)

    def move(self, wish: M) -> None:
        """Take a wish as the newest, unless a newer one has overtaken it."""
        if self.peer.is_newest(self.message.get_seq(), self.now):
            self.session.intent = Intent(wish, self.now)
        else:
            self.session.dropped.overtaken += 1

    def refuse(self, unusable: Unusable) -> None:
        """Say why a motion command is no wish."""
        self.session.dropped.refused += 1
        self.warn(unusable.key, f"{self.message.get_type()} refused: {unusable.reason}")

    def _write(self, switch: Switch[M], *, on: bool) -> None:
        self.session.wish(switch.write(self.session.intent.wish, on))


AnyExchange: TypeAlias = Exchange[Any, Any, Any]


def _manual_control(exchange: AnyExchange) -> None:
    session, peer = exchange.session, exchange.peer
    buttons: int = exchange.message.buttons
    # The first message of a station has no edges: a button that is already down says nothing new.
    gone_down = buttons & ~(buttons if peer.buttons is None else peer.buttons)
    peer.buttons = buttons
    stopped = session.snapshot is not None and session.snapshot.facts.emergency_stopped
    if pressed(buttons, session.station.stop_button) and not stopped:
        exchange.request(EmergencyStop())
    exchange.press(gone_down)
    exchange.take_stick()


def _set_target(exchange: AnyExchange) -> None:
    exchange.take_target()


def _command(exchange: AnyExchange) -> None:
    message = exchange.message
    last = (message.x, message.y) if message.get_type() == "COMMAND_INT" else (message.param5, message.param6)
    height = message.z if message.get_type() == "COMMAND_INT" else message.param7
    params = (message.param1, message.param2, message.param3, message.param4, *last, height)
    _order(exchange, Order(message.command, params), repeated=getattr(message, "confirmation", 0) > 0)


def _set_mode(exchange: AnyExchange) -> None:
    """Take the old SET_MODE as its command, and answer under the message's number, as ArduPilot does."""
    answer = obey(
        Order(
            dialect.MAV_CMD_DO_SET_MODE,
            (exchange.message.base_mode, exchange.message.custom_mode, 0, 0, 0, 0, 0),
        ),
        exchange,
    )
    _acknowledge(exchange, dialect.MAVLINK_MSG_ID_SET_MODE, answer.result)


def _order(exchange: AnyExchange, order: Order, *, repeated: bool) -> None:
    peer = exchange.peer
    before = peer.answered
    if repeated and before is not None and exchange.now - before.at < REMEMBERED:
        same = before.command == order.command and repr(before.params) == repr(order.params)  # NaN is not NaN
        if same:
            _acknowledge(exchange, order.command, before.result)
            return
    answer = obey(order, exchange)
    if answer.reason:
        exchange.replies += exchange.session.speaker.say(Severity.WARNING, answer.reason)
    peer.answered = Answered(order.command, order.params, answer.result, exchange.now)
    _acknowledge(exchange, order.command, answer.result)


def _acknowledge(exchange: AnyExchange, command: int, result: Result | int) -> None:
    exchange.replies.append(
        dialect.MAVLink_command_ack_message(command, result, _PROGRESS_UNKNOWN, 0, *exchange.address),
    )


def _parameter_list(exchange: AnyExchange) -> None:
    exchange.session.listed = 0
    exchange.session.list_due = exchange.now


def _parameter_read(exchange: AnyExchange) -> None:
    index = exchange.session.store.find(exchange.message.param_index, exchange.message.param_id)
    if index is None:
        _parameter_error(exchange, exchange.message.param_index)
    else:
        exchange.replies.append(exchange.session.store.message(index))


def _parameter_set(exchange: AnyExchange) -> None:
    session, message = exchange.session, exchange.message
    index = session.store.find(-1, message.param_id)
    if index is None:
        _parameter_error(exchange, -1)
        return
    trouble = session.store.change(index, message.param_value)
    if trouble:
        exchange.warn(f"parameter {index}", trouble)
    else:
        stream, rate = session.store.rate(index)
        if stream is not None:
            session.schedule.change(stream, round(1e9 / rate) if rate > 0.0 else NEVER, exchange.now)
    exchange.replies.append(session.store.message(index))


def _parameter_error(exchange: AnyExchange, index: int) -> None:
    name = text_of(exchange.message.param_id).encode("ascii")
    unknown = dialect.MAV_PARAM_ERROR_DOES_NOT_EXIST
    exchange.replies.append(dialect.MAVLink_param_error_message(*exchange.address, name, index, unknown))


def _mission_list(exchange: AnyExchange) -> None:
    exchange.replies.append(
        dialect.MAVLink_mission_count_message(*exchange.address, 0, exchange.message.mission_type)
    )


def _mission_refused(exchange: AnyExchange) -> None:
    _mission_ack(exchange, dialect.MAV_MISSION_UNSUPPORTED)


def _mission_item_missing(exchange: AnyExchange) -> None:
    _mission_ack(exchange, dialect.MAV_MISSION_INVALID_SEQUENCE)


def _mission_cleared(exchange: AnyExchange) -> None:
    _mission_ack(exchange, dialect.MAV_MISSION_ACCEPTED)


def _mission_ack(exchange: AnyExchange, kind: int) -> None:
    exchange.replies.append(
        dialect.MAVLink_mission_ack_message(*exchange.address, kind, exchange.message.mission_type)
    )


def _timesync(exchange: AnyExchange) -> None:
    if exchange.message.tc1 == 0:  # anything else answers a request, and we made none
        exchange.replies.append(dialect.MAVLink_timesync_message(max(exchange.now, 1), exchange.message.ts1))


def _ping(exchange: AnyExchange) -> None:
    message = exchange.message
    if (message.target_system, message.target_component) == (0, 0):
        exchange.replies.append(
            dialect.MAVLink_ping_message(message.time_usec, message.seq, *exchange.address)
        )


HANDLERS: Final[dict[int, Callable[[AnyExchange], None]]] = {
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
