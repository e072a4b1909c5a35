"""The handling of each message of a ground station, and the answer to it: a row for each."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

from firmware_bridge.mavlink.command import Command, Result
from firmware_bridge.mavlink.frames import Message, dialect, text_of
from firmware_bridge.mavlink.lacking import LACKING, Refusal
from firmware_bridge.teleop.commands import change_control, obey, requests_stop, stops
from firmware_bridge.teleop.driving import Driving, manual_control, pressed, stick_of
from firmware_bridge.teleop.incoming import AnsweredCommand, Incoming, Lever
from firmware_bridge.teleop.setpoints import (
    channels_of,
    place_of,
    stick_of_channels,
    turns_alone,
    velocity_of,
)
from firmware_bridge.teleop.station import Motion, Place, Unusable, Velocity
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

REMEMBERED: Final[Nanoseconds] = 3 * SECOND
"""Time for which a command's answer is kept for its repetitions."""
STOP_ANSWERED_EVERY: Final[Nanoseconds] = SECOND
"""Of one station that is not in control, and of all untrusted ones."""
_PROGRESS_UNKNOWN: Final = 0
_REQUESTS: Final = 0
_ALREADY_CONTROLLED: Final = 3
"""Of CHANGE_OPERATOR_CONTROL and its acknowledgement (common.xml)."""


def _channels(incoming: Incoming) -> None:
    """Take the channels of an RC_CHANNELS_OVERRIDE as the newest command, or say why they give none."""
    driving, held = incoming.link.driving, incoming.station.channels
    if incoming.refusal is not None:
        incoming.ignore()
    elif incoming.newest():
        given = channels_of(incoming.message, driving.rows.channels)
        if isinstance(given, Unusable):
            incoming.refuse(given)
        elif given:
            held.receive(given, incoming.now, driving.silent_after)
            incoming.move(*stick_of_channels(held.values, driving.rows.channels, driving.rows.dead_band))


def _set_point(incoming: Incoming) -> None:
    """Take a SET_POSITION_TARGET_LOCAL_NED as the newest command, or say why it gives none."""
    link, message = incoming.link, incoming.message
    if incoming.refusal is not None:
        incoming.ignore()
        return
    given: Velocity | Place | Unusable | None = None if link.rows.place is None else place_of(message)
    if given is None:
        given = velocity_of(message, link.rows.largest(link.robot), link.status.heading_rad)
        if not isinstance(given, Unusable) and turns_alone(message):
            given = _turned(given, link.driving)
    if isinstance(given, Unusable):
        incoming.refuse(given)
    elif incoming.newest():
        incoming.move(given, given.deflected)


def _turned(velocity: Velocity, driving: Driving) -> Velocity | Unusable:
    """Refuse a yaw rate alone where it turns nothing: a robot that steers turns only as it drives."""
    command, still = driving.intent.command, replace(velocity, yaw_rate_rad_s=0.0)
    if velocity.yaw_rate_rad_s and driving.applied(velocity, command) == driving.applied(still, command):
        return Unusable("turn alone", "this robot does not turn on the spot; send a velocity, too")
    return velocity


def _later(incoming: Incoming) -> None:
    """Take a command of a second station with this number: only a stop or a neutral stick counts."""
    message, rows, station = incoming.message, incoming.link.rows, incoming.station
    given: tuple[Motion, str] | Unusable
    if message.get_msgId() == dialect.MAVLINK_MSG_ID_MANUAL_CONTROL:
        if pressed(message.buttons, rows.stop_button):
            incoming.emergency_stop()
        position = stick_of(message, rows, Lever())
        given = position if isinstance(position, Unusable) else (position.stick, position.deflected)
    elif message.get_msgId() == dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE:
        channels = channels_of(message, rows.channels)
        if isinstance(channels, Unusable):
            given = channels
        else:
            held = {number: value for number, value in channels.items() if value is not None}
            given = stick_of_channels(held, rows.channels, rows.dead_band)
    else:
        velocity = velocity_of(message, rows.largest(incoming.link.robot), None)
        given = velocity if isinstance(velocity, Unusable) else (velocity, velocity.deflected)
    if isinstance(given, Unusable) or given[1]:
        incoming.link.dropped.undriven += 1
        text = f"{message.get_type()} of the second {station.sender} moves nothing"
        incoming.warn("number", text)
    elif incoming.refusal is None:
        incoming.move(*given)
        station.neutral_at = incoming.now


def _no_way_to_drive(incoming: Incoming) -> None:
    """Say once in a while that a kind of set-point moves nothing."""
    if incoming.refusal is not None:
        incoming.ignore()
    else:
        incoming.refuse(Unusable(incoming.message.get_type(), "send SET_POSITION_TARGET_LOCAL_NED"))


def _command(incoming: Incoming) -> None:
    message = incoming.message
    last = (message.x, message.y) if message.get_type() == "COMMAND_INT" else (message.param5, message.param6)
    height = message.z if message.get_type() == "COMMAND_INT" else message.param7
    params = (message.param1, message.param2, message.param3, message.param4, *last, height)
    _obey(incoming, Command(message.command, params), repeated=getattr(message, "confirmation", 0) > 0)


def _set_mode(incoming: Incoming) -> None:
    """Take the old SET_MODE as its command, and answer under the message's number, as ArduPilot does."""
    answer = obey(
        Command(
            dialect.MAV_CMD_DO_SET_MODE,
            (incoming.message.base_mode, incoming.message.custom_mode, 0, 0, 0, 0, 0),
        ),
        incoming,
    )
    _give_reason(incoming, answer.reason)
    _acknowledge(incoming, dialect.MAVLINK_MSG_ID_SET_MODE, answer.result)


def _give_reason(incoming: Incoming, reason: str) -> None:
    """Report an answer's reason; the same in a row is sent now and then, the answer itself each time."""
    if reason:
        incoming.warn("command" if incoming.refusal is not None else reason, reason)


def _obey(incoming: Incoming, command: Command, *, repeated: bool) -> None:
    station = incoming.station
    before = station.answered if repeated and not stops(command) else None
    if before is not None and incoming.now - before.at < REMEMBERED:
        same = before.command == command.number and repr(before.params) == repr(
            command.params
        )  # NaN is not NaN
        if same:
            _acknowledge(incoming, command.number, before.result)
            return
    bystander_stops = incoming.refusal is not None and requests_stop(incoming.message, incoming.link.rows)
    answer = obey(command, incoming)
    if bystander_stops and incoming.now - station.stop_answered_at < STOP_ANSWERED_EVERY:
        return
    if bystander_stops:
        station.stop_answered_at = incoming.now
    _give_reason(incoming, answer.reason)
    station.answered = AnsweredCommand(command.number, command.params, answer.result, incoming.now)
    _acknowledge(incoming, command.number, answer.result)


def stop_for_anybody(incoming: Incoming) -> list[Message]:
    """Obey an emergency stop of an untrusted sender; it is answered once a second."""
    link, message = incoming.link, incoming.message
    incoming.emergency_stop()
    if incoming.now - link.stop_answered_at < STOP_ANSWERED_EVERY:
        return []
    link.stop_answered_at = incoming.now
    if message.get_type() != "MANUAL_CONTROL":
        _acknowledge(incoming, message.command, Result.ACCEPTED)
    return incoming.replies


def _acknowledge(incoming: Incoming, command: int, result: Result | int) -> None:
    incoming.replies.append(
        dialect.MAVLink_command_ack_message(command, result, _PROGRESS_UNKNOWN, 0, *incoming.address),
    )


def _parameter_list(incoming: Incoming) -> None:
    store = incoming.link.store
    # Repeated requests of a station that only watches must not keep it from its end.
    if incoming.refusal is None or store.list_due == NEVER:
        store.begin_list(incoming.now)


def _parameter_read(incoming: Incoming) -> None:
    index = incoming.link.store.find(incoming.message.param_index, incoming.message.param_id)
    if index is None:
        _parameter_error(incoming, incoming.message.param_index)
    else:
        incoming.replies.append(incoming.link.store.message(index))


def _parameter_set(incoming: Incoming) -> None:
    link, message = incoming.link, incoming.message
    index = link.store.find(-1, message.param_id)
    if index is None:
        _parameter_error(incoming, -1)
        return
    trouble = incoming.refusal or link.store.change(index, message.param_value)
    if trouble:
        incoming.warn(f"parameter {index}", trouble)
    else:
        stream, rate = link.store.rate(index)
        if stream is not None:
            link.set_period(stream, round(1e9 / rate) if rate > 0.0 else NEVER, incoming.now)
    incoming.replies.append(link.store.message(index))


def _parameter_error(incoming: Incoming, index: int) -> None:
    name = text_of(incoming.message.param_id).encode("ascii")
    unknown = dialect.MAV_PARAM_ERROR_DOES_NOT_EXIST
    incoming.replies.append(dialect.MAVLink_param_error_message(*incoming.address, name, index, unknown))


def _version(incoming: Incoming) -> None:
    incoming.send(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION)


def _change_control(incoming: Incoming) -> None:
    """Take the old CHANGE_OPERATOR_CONTROL as the command that replaced it; no pass key is required."""
    requests: int = incoming.message.control_request
    answer = change_control(incoming, requests=requests == _REQUESTS, yields=False)
    refused = _ALREADY_CONTROLLED if answer.result is not Result.ACCEPTED else 0
    incoming.replies.append(
        dialect.MAVLink_change_operator_control_ack_message(incoming.station.sender.system, requests, refused)
    )


def _setup_signing(incoming: Incoming) -> None:
    incoming.warn("signing", "SETUP_SIGNING refused: the key comes from a file, drive --key")


def _timesync(incoming: Incoming) -> None:
    if incoming.message.tc1 != 0:
        _answered(incoming)
    else:
        incoming.replies.append(dialect.MAVLink_timesync_message(max(incoming.now, 1), incoming.message.ts1))


def _ping(incoming: Incoming) -> None:
    message = incoming.message
    if (message.target_system, message.target_component) == (0, 0):
        incoming.replies.append(
            dialect.MAVLink_ping_message(message.time_usec, message.seq, *incoming.address)
        )
    else:
        _answered(incoming)


def _answered(incoming: Incoming) -> None:
    """Take an answer to a request of ours: only the station in control gets one."""
    if incoming.station is incoming.link.stations.in_control:
        incoming.station.clocks.answered(incoming.message, incoming.now)


def _lacks(refusal: Refusal, incoming: Incoming) -> None:
    answer = refusal(incoming.message, incoming.address)
    incoming.replies += () if answer is None else (answer,)


HANDLERS: Final[dict[int, Callable[[Incoming], None]]] = {
    dialect.MAVLINK_MSG_ID_MANUAL_CONTROL: manual_control,
    dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: _channels,
    dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: _set_point,
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
LATER: Final[dict[int, Callable[[Incoming], None]]] = HANDLERS | dict.fromkeys(
    (
        dialect.MAVLINK_MSG_ID_MANUAL_CONTROL,
        dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE,
        dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
    ),
    _later,
)
"""Of a second station that calls itself as one that was there before."""
