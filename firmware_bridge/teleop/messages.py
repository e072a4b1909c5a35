"""The handling of each message of a ground station, and the answer to it: a row for each."""

from collections.abc import Callable
from functools import partial
from typing import Final

from firmware_bridge.intent import EmergencyStop
from firmware_bridge.mavlink.command import Command, Result
from firmware_bridge.mavlink.frames import Message, dialect, text_of
from firmware_bridge.mavlink.lacking import LACKING, Refusal
from firmware_bridge.teleop.commands import change_control, obey, requests_stop, stops
from firmware_bridge.teleop.exchange import Exchange
from firmware_bridge.teleop.session import REMEMBERED, AnsweredCommand
from firmware_bridge.teleop.setpoints import pressed
from firmware_bridge.teleop.station import Unusable
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

STOP_ANSWERED_EVERY: Final[Nanoseconds] = SECOND
"""Of one station that is not in control, and of all untrusted ones."""
_PROGRESS_UNKNOWN: Final = 0
_REQUESTS: Final = 0
_ALREADY_CONTROLLED: Final = 3
"""Of CHANGE_OPERATOR_CONTROL and its acknowledgement (common.xml)."""


def _manual_control(exchange: Exchange) -> None:
    session, peer = exchange.session, exchange.peer
    buttons: int = exchange.message.buttons
    if pressed(buttons, session.station.stop_button) and not exchange.stopped:
        exchange.request(EmergencyStop())
    if not exchange.newest():
        return  # its buttons would go down twice
    # The first message of a station has no edges: a button that is already down is no news.
    gone_down = buttons & ~(buttons if peer.buttons is None else peer.buttons)
    peer.buttons = buttons
    exchange.hold_lever()
    if exchange.refusal is not None:
        exchange.ignore()
        return
    if gone_down and exchange.late is None:
        exchange.press(gone_down)
    exchange.take_stick()


def _channels(exchange: Exchange) -> None:
    if exchange.refusal is not None:
        exchange.ignore()
    elif exchange.newest():
        exchange.take_channels()


def _no_way_to_drive(exchange: Exchange) -> None:
    """Say once in a while that a kind of set-point moves nothing."""
    if exchange.refusal is not None:
        exchange.ignore()
    else:
        exchange.refuse(Unusable(exchange.message.get_type(), "send SET_POSITION_TARGET_LOCAL_NED"))


def _command(exchange: Exchange) -> None:
    message = exchange.message
    last = (message.x, message.y) if message.get_type() == "COMMAND_INT" else (message.param5, message.param6)
    height = message.z if message.get_type() == "COMMAND_INT" else message.param7
    params = (message.param1, message.param2, message.param3, message.param4, *last, height)
    _obey(exchange, Command(message.command, params), repeated=getattr(message, "confirmation", 0) > 0)


def _set_mode(exchange: Exchange) -> None:
    """Take the old SET_MODE as its command, and answer under the message's number, as ArduPilot does."""
    answer = obey(
        Command(
            dialect.MAV_CMD_DO_SET_MODE,
            (exchange.message.base_mode, exchange.message.custom_mode, 0, 0, 0, 0, 0),
        ),
        exchange,
    )
    _give_reason(exchange, answer.reason)
    _acknowledge(exchange, dialect.MAVLINK_MSG_ID_SET_MODE, answer.result)


def _give_reason(exchange: Exchange, reason: str) -> None:
    """Report an answer's reason; the same in a row is sent now and then, the answer itself each time."""
    if reason:
        exchange.warn("command" if exchange.refusal is not None else reason, reason)


def _obey(exchange: Exchange, command: Command, *, repeated: bool) -> None:
    peer = exchange.peer
    before = peer.answered if repeated and not stops(command) else None
    if before is not None and exchange.now - before.at < REMEMBERED:
        same = before.command == command.number and repr(before.params) == repr(
            command.params
        )  # NaN is not NaN
        if same:
            _acknowledge(exchange, command.number, before.result)
            return
    bystander_stops = exchange.refusal is not None and requests_stop(exchange.message, exchange.station)
    answer = obey(command, exchange)
    if bystander_stops and exchange.now - peer.stop_answered_at < STOP_ANSWERED_EVERY:
        return
    if bystander_stops:
        peer.stop_answered_at = exchange.now
    _give_reason(exchange, answer.reason)
    peer.answered = AnsweredCommand(command.number, command.params, answer.result, exchange.now)
    _acknowledge(exchange, command.number, answer.result)


def stop_for_anybody(exchange: Exchange) -> list[Message]:
    """Obey an emergency stop of an untrusted sender; it is answered once a second."""
    session, message = exchange.session, exchange.message
    if not exchange.stopped:
        exchange.request(EmergencyStop())
    if exchange.now - session.stop_answered_at < STOP_ANSWERED_EVERY:
        return []
    session.stop_answered_at = exchange.now
    if message.get_type() != "MANUAL_CONTROL":
        _acknowledge(exchange, message.command, Result.ACCEPTED)
    return exchange.replies


def _acknowledge(exchange: Exchange, command: int, result: Result | int) -> None:
    exchange.replies.append(
        dialect.MAVLink_command_ack_message(command, result, _PROGRESS_UNKNOWN, 0, *exchange.address),
    )


def _parameter_list(exchange: Exchange) -> None:
    if exchange.refusal is not None and exchange.session.list_due != NEVER:
        return  # repeated requests must not keep it from its end
    exchange.session.listed = 0
    exchange.session.list_due = exchange.now


def _parameter_read(exchange: Exchange) -> None:
    index = exchange.session.store.find(exchange.message.param_index, exchange.message.param_id)
    if index is None:
        _parameter_error(exchange, exchange.message.param_index)
    else:
        exchange.replies.append(exchange.session.store.message(index))


def _parameter_set(exchange: Exchange) -> None:
    session, message = exchange.session, exchange.message
    index = session.store.find(-1, message.param_id)
    if index is None:
        _parameter_error(exchange, -1)
        return
    trouble = exchange.refusal or session.store.change(index, message.param_value)
    if trouble:
        exchange.warn(f"parameter {index}", trouble)
    else:
        stream, rate = session.store.rate(index)
        if stream is not None:
            session.set_period(stream, round(1e9 / rate) if rate > 0.0 else NEVER, exchange.now)
    exchange.replies.append(session.store.message(index))


def _parameter_error(exchange: Exchange, index: int) -> None:
    name = text_of(exchange.message.param_id).encode("ascii")
    unknown = dialect.MAV_PARAM_ERROR_DOES_NOT_EXIST
    exchange.replies.append(dialect.MAVLink_param_error_message(*exchange.address, name, index, unknown))


def _version(exchange: Exchange) -> None:
    exchange.send(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION)


def _change_control(exchange: Exchange) -> None:
    """Take the old CHANGE_OPERATOR_CONTROL as the command that replaced it; no pass key is required."""
    requests: int = exchange.message.control_request
    answer = change_control(exchange, requests=requests == _REQUESTS, yields=False)
    refused = _ALREADY_CONTROLLED if answer.result is not Result.ACCEPTED else 0
    exchange.replies.append(
        dialect.MAVLink_change_operator_control_ack_message(exchange.sender.system, requests, refused)
    )


def _setup_signing(exchange: Exchange) -> None:
    exchange.warn("signing", "SETUP_SIGNING refused: the key comes from a file, drive --key")


def _timesync(exchange: Exchange) -> None:
    if exchange.message.tc1 != 0:
        _answered(exchange)
    else:
        exchange.replies.append(dialect.MAVLink_timesync_message(max(exchange.now, 1), exchange.message.ts1))


def _ping(exchange: Exchange) -> None:
    message = exchange.message
    if (message.target_system, message.target_component) == (0, 0):
        exchange.replies.append(
            dialect.MAVLink_ping_message(message.time_usec, message.seq, *exchange.address)
        )
    else:
        _answered(exchange)


def _answered(exchange: Exchange) -> None:
    """Take an answer to a request of ours: only the station in control gets one."""
    session = exchange.session
    if exchange.sender == session.control.driver:
        session.ages.answered(exchange.message, exchange.now)


def _lacks(refusal: Refusal, exchange: Exchange) -> None:
    answer = refusal(exchange.message, exchange.address)
    exchange.replies += () if answer is None else (answer,)


HANDLERS: Final[dict[int, Callable[[Exchange], None]]] = {
    dialect.MAVLINK_MSG_ID_MANUAL_CONTROL: _manual_control,
    dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: _channels,
    dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: Exchange.take_target,
    dialect.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: _no_way_to_drive,
    dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: _no_way_to_drive,
    dialect.MAVLINK_MSG_ID_SET_ACTUATOR_CONTROL_TARGET: _no_way_to_drive,
    dialect.MAVLINK_MSG_ID_COMMAND_LONG: _command,
    dialect.MAVLINK_MSG_ID_COMMAND_INT: _command,
    dialect.MAVLINK_MSG_ID_SET_MODE: _set_mode,
    dialect.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: _parameter_list,
    dialect.MAVLINK_MSG_ID_PARAM_REQUEST_READ: _parameter_read,
    dialect.MAVLINK_MSG_ID_PARAM_SET: _parameter_set,
    dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION_REQUEST: _version,
    **{number: partial(_lacks, refusal) for number, refusal in LACKING.items()},
    dialect.MAVLINK_MSG_ID_CHANGE_OPERATOR_CONTROL: _change_control,
    dialect.MAVLINK_MSG_ID_SETUP_SIGNING: _setup_signing,
    dialect.MAVLINK_MSG_ID_TIMESYNC: _timesync,
    dialect.MAVLINK_MSG_ID_PING: _ping,
}
LATER: Final[dict[int, Callable[[Exchange], None]]] = HANDLERS | dict.fromkeys(
    (
        dialect.MAVLINK_MSG_ID_MANUAL_CONTROL,
        dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE,
        dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
    ),
    Exchange.take_later,
)
"""Of a second station that calls itself as one that was there before."""
