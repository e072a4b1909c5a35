"""MAV_CMD by MAV_CMD: what the bridge does about it, and with which MAV_RESULT it answers.

A command that has no row is UNSUPPORTED. Sources: common.xml, MAV_CMD; MAVLink command protocol.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge import intent
from firmware_bridge.mavlink import modes
from firmware_bridge.mavlink.command import (
    ACCEPTED,
    UNSUPPORTED,
    Command,
    CommandAnswer,
    Result,
    denied,
    whole,
)
from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.teleop.driving import pressed
from firmware_bridge.teleop.incoming import Incoming
from firmware_bridge.teleop.station import FASTEST, AnyStation
from firmware_bridge.units import NEVER

FORCE: Final = 21196
"""The second parameter of COMPONENT_ARM_DISARM that means: without checks (common.xml)."""
MAV_CMD_REQUEST_OPERATOR_CONTROL: Final = 32100
"""Of development.xml; no dialect of pymavlink has it."""
_TERMINATES: Final = 0.5
"""Threshold of DO_FLIGHTTERMINATION's parameter for a termination (common.xml)."""
_LARGEST_NUMBER: Final = 0xFFFF
"""MESSAGE_INTERVAL carries 16 bits of a message's number."""
Action: TypeAlias = Callable[[Command, Incoming], CommandAnswer]


def judged(verdict: intent.Answer) -> CommandAnswer:
    """Return the bridge's verdict as a command's answer."""
    if verdict.accepted:
        return ACCEPTED
    return CommandAnswer(Result.TEMPORARILY_REJECTED if verdict.temporary else Result.DENIED, verdict.reason)


def _arm_or_disarm(command: Command, incoming: Incoming) -> CommandAnswer:
    force = command.params[1] == FORCE
    match command.params[0]:
        case 0.0:
            return judged(incoming.request(intent.Disarm(force=force)))
        case 1.0 if force:
            return denied("arming cannot be forced: the interlocks stay")
        case 1.0:
            return judged(incoming.request(intent.Arm()))
    return denied("arm: parameter 1 must be 0 or 1")


def _terminate(command: Command, incoming: Incoming) -> CommandAnswer:
    if command.params[0] > _TERMINATES:
        return judged(incoming.request(intent.EmergencyStop(final=True)))
    return denied("termination is undone by a restart of the bridge only")


def _safety_switch(command: Command, incoming: Incoming) -> CommandAnswer:
    match command.params[0]:
        case dialect.SAFETY_SWITCH_STATE_SAFE:
            return judged(incoming.request(intent.EmergencyStop()))
        case dialect.SAFETY_SWITCH_STATE_DANGEROUS:
            return judged(incoming.request(intent.ClearEmergencyStop()))
    return denied("safety switch: parameter 1 must be 0 (stop) or 1 (clear)")


def _relay(command: Command, incoming: Incoming) -> CommandAnswer:
    relays = {switch.relay: switch for switch in incoming.link.rows.switches}
    if not relays:
        return UNSUPPORTED
    number, on = whole(command.params[0]), command.params[1]
    if number is None or number not in relays:
        known = ", ".join(f"{relay} {switch.name}" for relay, switch in relays.items())
        return denied(f"relay: {known}; there are no others")
    if on not in (0.0, 1.0):
        return denied("relay: parameter 2 must be 0 or 1")
    incoming.link.driving.switch(relays[number], on=bool(on))
    return ACCEPTED


def _illuminate(command: Command, incoming: Incoming) -> CommandAnswer:
    lamps = [switch for switch in incoming.link.rows.switches if switch.illuminates]
    if not lamps:
        return UNSUPPORTED
    if command.params[0] not in (0.0, 1.0):
        return denied(f"{', '.join(lamp.name for lamp in lamps)}: parameter 1 must be 0 or 1")
    for lamp in lamps:
        incoming.link.driving.switch(lamp, on=bool(command.params[0]))
    return ACCEPTED


def _actuator(command: Command, incoming: Incoming) -> CommandAnswer:
    """Set actuators: NaN leaves one where it is (common.xml), and 0 one that is not there."""
    names = [actuator.name for actuator in incoming.link.rows.actuators]
    if not names:
        return UNSUPPORTED
    shares, others = command.params[: len(names)], command.params[len(names) : 6]
    if command.params[6] != 0.0 or not all(math.isnan(other) or other == 0.0 for other in others):
        return denied(f"actuator: set 0 has {', '.join(names)}; there are no others")
    named = [(place, share) for place, share in enumerate(shares) if not math.isnan(share)]
    beyond = [place for place, share in named if not -1.0 <= share <= 1.0]
    if not named or beyond:
        place = beyond[0] if beyond else 0
        return denied(f"{names[place]}: parameter {place + 1} must be within -1 (lowest) and 1 (highest)")
    if not incoming.link.status.armed:
        return denied(f"{names[named[0][0]]}: arm first; a target is not kept for later")
    for place, share in named:
        incoming.link.driving.actuate(place, (share + 1.0) / 2.0)
    return ACCEPTED


def _request_message(command: Command, incoming: Incoming) -> CommandAnswer:
    number = whole(command.params[0])
    sent = number is not None and incoming.send(number, whole(command.params[1]) or 0)
    return ACCEPTED if sent else UNSUPPORTED


def _capabilities(command: Command, incoming: Incoming) -> CommandAnswer:
    if command.params[0] == 1.0:
        incoming.send(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    return ACCEPTED


def _send_home(_: Command, incoming: Incoming) -> CommandAnswer:
    """Send where the odometry begins; before the first cycle nothing is known of it."""
    sent = incoming.send(dialect.MAVLINK_MSG_ID_HOME_POSITION)
    return ACCEPTED if sent else CommandAnswer(Result.TEMPORARILY_REJECTED, "home: the bridge is starting")


def _change_interval(command: Command, incoming: Incoming) -> CommandAnswer:
    """Change a message's interval to this station; more often than others only with control."""
    number, wanted = whole(command.params[0]), command.params[1]
    default = None if number is None else incoming.link.schedule.default(number)
    if number is None or default is None:
        return UNSUPPORTED
    if not math.isfinite(wanted) or wanted < -1.0:
        return denied("message interval: parameter 2 is in microseconds, 0 for the default, -1 for off")
    if number == dialect.MAVLINK_MSG_ID_HEARTBEAT and wanted != 0.0:
        return denied("message interval: the heartbeat keeps its rate")
    period = None if wanted == 0.0 else NEVER if wanted < 0.0 else max(round(wanted) * 1000, FASTEST)
    refused = incoming.change_interval(number, period, default)
    return ACCEPTED if refused is None else denied(refused)


def _send_interval(command: Command, incoming: Incoming) -> CommandAnswer:
    number = whole(command.params[0])
    if number is None or number > _LARGEST_NUMBER:
        return denied("message interval: parameter 1 must be a message number up to 65535")
    incoming.send_interval(number)
    return ACCEPTED


def _inject(command: Command, incoming: Incoming) -> CommandAnswer:
    return incoming.inject(*command.params[:3])


def _pause(command: Command, incoming: Incoming) -> CommandAnswer:
    match command.params[0]:
        case dialect.MAV_GOTO_DO_HOLD:
            return judged(incoming.request(intent.Pause()))
        case dialect.MAV_GOTO_DO_CONTINUE:
            return judged(incoming.request(intent.Resume()))
    return denied("pause: parameter 1 must be 0 (pause) or 1 (continue)")


def _set_standard_mode(command: Command, incoming: Incoming) -> CommandAnswer:
    """Pause, whichever mode it is: a station that requests another mode no longer drives by hand."""
    paused = judged(incoming.request(intent.Pause()))
    if command.params[0] == dialect.MAV_STANDARD_MODE_POSITION_HOLD:
        return paused
    return denied("mode: of the standard modes only position hold; the robot is paused")


def _set_mode(command: Command, incoming: Incoming) -> CommandAnswer:
    """Enter a mode; one that cannot be entered now, or is none of the robot's, pauses it."""
    entered = _enter_mode(command, incoming)
    if entered.result is not Result.ACCEPTED:
        incoming.request(intent.Pause())
    return entered


def _enter_mode(command: Command, incoming: Incoming) -> CommandAnswer:
    link, main, sub = incoming.link, whole(command.params[1]), whole(command.params[2]) or 0
    requested = None if main is None else modes.requested(main, sub, len(link.status.modes))
    if requested is None:
        known = [f"{row.number} {row.driving_mode.value}" for row in modes.ROWS]
        own = enumerate(link.status.modes)
        known += [f"{modes.number_of_own(place)} {name}" for place, name in own if name]
        return denied(f"mode: {', '.join(known)}; there are no others; it is paused")
    link.audience.voice(incoming.station.sender.source).px4 = requested.px4
    if requested.driving_mode is modes.DrivingMode.HOLD:
        return judged(incoming.request(intent.Pause()))
    path_follower = 0 if requested.px4 else sub
    if path_follower >= len(link.path_followers):
        known = [f"{place} {name or 'the operator'}" for place, name in enumerate(link.path_followers)]
        return denied(f"submode: {', '.join(known)}; there are no others")
    mode = link.status.mode if requested.own is None else link.status.modes[requested.own]
    entered = judged(incoming.request(intent.EnterMode(mode)))
    if entered.result is Result.ACCEPTED and len(link.path_followers) > 1:
        entered = judged(incoming.request(intent.Follow(link.path_followers[path_follower])))
    if entered.result is Result.ACCEPTED:
        link.driving.order(requested.driving_mode, incoming.now)
    return entered


def _home(command: Command, incoming: Incoming) -> CommandAnswer:
    if command.params[0] != 1.0:
        return denied("home: only the present place (parameter 1 = 1) can be the origin")
    return judged(incoming.request(intent.ResetOdometry()))


def _confirm_position(command: Command, incoming: Incoming) -> CommandAnswer:
    number, axes = whole(command.params[0]), incoming.link.robot.axes
    # Counted from 1: a command of zeros alone names no axis.
    known = number is not None and 1 <= number <= len(axes)
    axis = axes[number - 1].name if number is not None and known else f"axis {command.params[0]:g}"
    return judged(incoming.request(intent.ConfirmPosition(axis, command.params[1])))


def _reboot(_: Command, incoming: Incoming) -> CommandAnswer:
    if incoming.link.status.armed:
        return denied("reboot: disarm first")
    return CommandAnswer(Result.UNSUPPORTED, "reboot: restart the bridge's program where it runs")


def _request_control(command: Command, incoming: Incoming) -> CommandAnswer:
    """Take or give up control; stations of 2025 say in parameter 2 what those of 2026 say in parameter 1."""
    first, second, third = command.params[:3]
    if first == 1.0:
        return change_control(incoming, requests=True, yields=second == 1.0)
    if first == 0.0 and second in (0.0, 1.0):
        return change_control(incoming, requests=second == 1.0, yields=third == 1.0)
    return denied("control: parameter 1 must be 0 (release) or 1 (request)")


def change_control(incoming: Incoming, *, requests: bool, yields: bool) -> CommandAnswer:
    """Take or give up control; `yields`: and let any station take it over on request.

    The station in control receives the request, by the same command, so that it may ask its operator.
    """
    stations = incoming.link.stations
    if not requests and stations.in_control is not incoming.station:
        return denied(f"control: {incoming.station.sender} is not in control")
    if not requests:
        incoming.give_up_control()
    elif incoming.refusal is None or stations.yields:
        incoming.take_control(yields=yields)
    else:
        incoming.ask_for_control(MAV_CMD_REQUEST_OPERATOR_CONTROL)
        return CommandAnswer(Result.FAILED)
    return ACCEPTED


def _zero(command: Command) -> bool:
    return command.params[0] == 0.0


def _stops_by_mode(command: Command) -> bool:
    main, sub = whole(command.params[1]), whole(command.params[2]) or 0
    requested = None if main is None else modes.requested(main, sub, 0)
    return requested is not None and requested.driving_mode is modes.DrivingMode.HOLD


@dataclass(frozen=True, slots=True)
class Entry:
    """One command that the bridge knows."""

    command: int
    act: Action
    does: str
    anyone: bool = False
    """True where it is obeyed of a station not in control; its request is judged there once more."""
    stops: Callable[[Command], bool] = lambda _: False
    """Return whether a command stops: it is carried out each time it is sent, as a repetition, too."""


ROWS: Final = (
    Entry(
        dialect.MAV_CMD_COMPONENT_ARM_DISARM,
        _arm_or_disarm,
        "arm; disarm, forced with p2 = 21196",
        anyone=True,
        stops=_zero,
    ),
    Entry(
        dialect.MAV_CMD_DO_FLIGHTTERMINATION,
        _terminate,
        "emergency stop until the bridge is restarted",
        anyone=True,
        stops=lambda command: command.params[0] > _TERMINATES,
    ),
    Entry(
        dialect.MAV_CMD_DO_PAUSE_CONTINUE,
        _pause,
        "p1 0: stop and wait; 1: continue, with the stick neutral",
        stops=_zero,
    ),
    Entry(dialect.MAV_CMD_OVERRIDE_GOTO, _pause, "the same", stops=_zero),
    Entry(
        dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE,
        _safety_switch,
        "p1 0: emergency stop; 1: clear it",
        anyone=True,
        stops=_zero,
    ),
    Entry(
        dialect.MAV_CMD_DO_SET_ACTUATOR, _actuator, "actuators of set 0: -1 lowest to 1 highest, NaN stays"
    ),
    Entry(dialect.MAV_CMD_DO_SET_RELAY, _relay, "p1: its number; p2 0 or 1"),
    Entry(dialect.MAV_CMD_ILLUMINATOR_ON_OFF, _illuminate, "p1 0 or 1"),
    Entry(dialect.MAV_CMD_REQUEST_MESSAGE, _request_message, "send a message once", anyone=True),
    Entry(
        dialect.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, _capabilities, "send AUTOPILOT_VERSION", anyone=True
    ),
    Entry(dialect.MAV_CMD_GET_HOME_POSITION, _send_home, "send HOME_POSITION", anyone=True),
    Entry(
        dialect.MAV_CMD_SET_MESSAGE_INTERVAL,
        _change_interval,
        "set the interval of a message to this station",
        anyone=True,
    ),
    Entry(
        dialect.MAV_CMD_GET_MESSAGE_INTERVAL, _send_interval, "send the interval of a message", anyone=True
    ),
    Entry(
        dialect.MAV_CMD_DO_SET_MODE,
        _set_mode,
        "0 Manual: the whole robot, and continue after a pause; 15 Guided; 4 Hold: pause; others after a "
        "failed actuator; submode: the path follower, 0 none; also PX4's numbers",
        stops=_stops_by_mode,
    ),
    Entry(
        dialect.MAV_CMD_DO_SET_STANDARD_MODE,
        _set_standard_mode,
        "p1 1, position hold: pause",
        stops=lambda _: True,
    ),
    Entry(
        dialect.MAV_CMD_DO_SET_HOME,
        _home,
        "p1 = 1: the present position is the origin; cameras are trusted again",
    ),
    Entry(
        dialect.MAV_CMD_USER_1,
        _confirm_position,
        "p1: an axis by its place in the robot file, from 1; p2: its position, read off the robot; "
        "NaN: home it",
    ),
    Entry(dialect.MAV_CMD_INJECT_FAILURE, _inject, "p1: FAILURE_UNIT; p2: FAILURE_TYPE; if allowed"),
    Entry(dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, _reboot, "refused: never by remote command"),
    Entry(
        MAV_CMD_REQUEST_OPERATOR_CONTROL,
        _request_control,
        "p1 1: take control, p2 1: and allow others to take over; p1 0: release control",
        anyone=True,
    ),
)

_BY_NUMBER: Final = {row.command: row for row in ROWS}


def requests_stop(message: Message, station: AnyStation) -> bool:
    """Return whether a message is an emergency stop: one of three commands, or the stick's button."""
    if message.get_type() == "MANUAL_CONTROL":
        return pressed(message.buttons, station.stop_button)
    if message.get_type() not in ("COMMAND_LONG", "COMMAND_INT"):
        return False
    match message.command, message.param1:
        case dialect.MAV_CMD_DO_FLIGHTTERMINATION, share:
            return bool(share > _TERMINATES)
        case dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, dialect.SAFETY_SWITCH_STATE_SAFE:
            return True
        case dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0:
            return bool(message.param2 == FORCE)
    return False


def stops(command: Command) -> bool:
    """Return whether a command stops, in whichever way."""
    row = _BY_NUMBER.get(command.number)
    return row is not None and row.stops(command)


def obey(command: Command, incoming: Incoming) -> CommandAnswer:
    """Carry out a command, where it is possible, and where its sender may send it."""
    row = _BY_NUMBER.get(command.number)
    if row is None:
        return UNSUPPORTED
    if incoming.refusal is not None and not row.anyone:
        return denied(incoming.refusal)
    return row.act(command, incoming)
