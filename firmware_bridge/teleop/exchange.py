"""One message from a ground station, and what it may bring about in the bridge."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeAlias

from firmware_bridge.intent import (
    OF_ANYONE,
    Answer,
    Arm,
    ChangeDriver,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
    Intent,
    Pause,
    Request,
    ResetOdometry,
    kind_of,
)
from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.teleop.control import Sender
from firmware_bridge.teleop.manual_control import Lever, stick_of, unread
from firmware_bridge.teleop.session import LastCommand, Peer, Sequenced, Session
from firmware_bridge.teleop.setpoints import (
    channels_of,
    place_of,
    pressed,
    stick_of_channels,
    turns_alone,
    velocity_of,
)
from firmware_bridge.teleop.station import AnyStation, Motion, Place, Stick, Switch, Unusable, Velocity
from firmware_bridge.units import Nanoseconds, to_seconds

STOPS: Final = (Disarm, EmergencyStop, Pause)
"""The requests that are obeyed however old they are; no older message undoes one of them."""
Decide: TypeAlias = Callable[[Request], Answer]
_ANSWER_WITHIN_S: Final = 10.0
"""Time for which a station shows its operator the request of another one for control."""


@dataclass(slots=True, eq=False)
class Exchange:
    """A message, its sender, and what is answered to it."""

    session: Session
    message: Message
    sender: Sender
    now: Nanoseconds
    decide: Decide
    doubt: str | None = None
    """The reason why the message is untrusted; None where it is trusted."""
    replies: list[Message] = field(default_factory=list)

    @property
    def peer(self) -> Peer:
        """The record of the sender."""
        return self.session.peers[self.sender]

    @property
    def address(self) -> tuple[int, int]:
        """The sender's system and component, to which an answer is addressed."""
        return self.sender.system, self.sender.component

    @property
    def refusal(self) -> str | None:
        """The reason why the sender may not drive; None where it is in control, or no station is."""
        return self.doubt or self.session.control.refusal(self.sender)

    @property
    def late(self) -> str | None:
        """The reason why a command to move is too late; None where it is in time, or of unknown age."""
        stopped, limit = self.peer.stopped, self.session.age_limit.most
        if stopped is not None and stopped.overtook(self.message.get_seq(), self.now):
            return "it was sent before a stop command, and came after it"
        age = self.session.age(self.message, self.sender, self.now)
        if age is None or age.nanoseconds < limit:
            return None
        return f"it was sent {to_seconds(age.nanoseconds):.2f} s ago, limit {to_seconds(limit):.2f} s"

    @property
    def station(self) -> AnyStation:
        """The robot's rows."""
        return self.session.station

    @property
    def armed(self) -> bool:
        """True while the robot may move, as of the newest snapshot."""
        return self.session.snapshot is not None and self.session.snapshot.facts.armed

    @property
    def mode(self) -> str:
        """The robot's mode after a failed actuator, as of the newest snapshot; empty while it is whole."""
        return "" if self.session.snapshot is None else self.session.snapshot.facts.mode

    @property
    def schedule(self) -> Schedule:
        """Schedule of the sender's place."""
        return self.session.audience.schedule(self.sender.source) or self.session.schedule

    @property
    def stopped(self) -> bool:
        """True while the emergency stop is latched, as of a snapshot since its last reset."""
        snapshot, cleared_at = self.session.snapshot, self.session.cleared_at
        return snapshot is not None and snapshot.facts.emergency_stopped and snapshot.facts.now > cleared_at

    def request(self, request: Request) -> Answer:
        """Forward a request of the station in control; forget the state that it makes obsolete.

        Of any other station an emergency stop is obeyed, and nothing else. It does not disable the power,
        which would let the robot roll, and it can be reset.
        """
        session = self.session
        if isinstance(request, STOPS) and self.doubt is None:
            # Before the judgment: whatever becomes of this stop, no older message of the station may undo it.
            self.peer.stopped = Sequenced(self.message.get_seq(), self.now)
        refused = self._refused(request)
        if refused is not None:
            return refused
        # A forced disarm of another station, too, only brakes: without power the robot could roll.
        if self.refusal is not None:
            request = EmergencyStop()
            session.unsent += session.speaker.say_sometimes(
                "stopped", f"emergency stop by {self.sender}", self.now
            )
        if isinstance(request, Arm) and not self.armed:
            session.adopt(self.peer, self.now)
        verdict = self.decide(request)
        if verdict.accepted:
            self._granted(request)
        return verdict

    def _granted(self, request: Request) -> None:
        """Take note of what the bridge has done."""
        session = self.session
        # A ground station without the protocol for control gets it by arming.
        if isinstance(request, Arm) and session.control.driver is None:
            session.control.take(self.sender, self.now)
            self._report_driver()
        if isinstance(request, ClearEmergencyStop):
            session.cleared_at = self.now
        if isinstance(request, Pause):
            session.driven.wait()
        if isinstance(request, ResetOdometry):
            session.resets += 1
        else:
            session.forget()
        if isinstance(request, EmergencyStop) and request.final:
            session.terminated = True

    def _refused(self, request: Request) -> Answer | None:
        """Refuse a request of a station not in control, or one too late; stops are not refused."""
        if self.refusal is not None:
            return None if kind_of(request) in OF_ANYONE else Answer(accepted=False, reason=self.refusal)
        late = None if isinstance(request, STOPS) else self.late
        if late is None:
            return None
        self.session.dropped.aged += 1
        return Answer(accepted=False, reason=late, temporary=True)

    def take_control(self, *, yields: bool = False) -> None:
        """Give the sender control; nothing moves before its own controls are neutral."""
        control = self.session.control
        changes = control.driver != self.sender
        control.take(self.sender, self.now, yields=yields)
        if changes:
            self.session.driven.begin()
            self.session.adopt(self.peer, self.now)
            # Before the texts: nothing moves until the new station's own stick was neutral.
            self.decide(ChangeDriver())
            self._report_driver()

    def _report_driver(self) -> None:
        """Report which station is in control, and what it must know of the robot's start."""
        for text in (f"control: {self.sender} is in control", *self.session.notes):
            self.report(text)

    def give_up_control(self) -> None:
        """Let no one drive: the robot comes to standstill, disarmed."""
        session = self.session
        # Before control is given up: the robot comes to standstill and is disarmed in any case.
        self.decide(Disarm())
        self.decide(ChangeDriver())
        session.control.give_up()
        session.driven.begin()
        session.adopt(None, self.now)
        self.report(f"control: {self.sender} has released it, no station in control")

    def ask_driver(self, command: int) -> None:
        """Inform the station in control of the sender's request for control, and forward it as a command."""
        session, driver = self.session, self.session.control.driver
        given = session.speaker.say_sometimes(
            "requested control", f"control: {self.sender} requests it; {driver} is in control", self.now
        )
        session.unsent += given
        if given and driver is not None:
            ask = (1.0, 0.0, _ANSWER_WITHIN_S, float(self.sender.system), 0.0, 0.0, 0.0)
            session.unsent.append(
                dialect.MAVLink_command_long_message(driver.system, driver.component, command, 0, *ask)
            )

    def report(self, text: str) -> None:
        """Report the change to all stations."""
        self.session.report(Severity.NOTICE, text)

    def switch(self, switch: Switch[Any], *, on: bool) -> None:
        """Switch one of the station's switches."""
        self.session.set_command(switch.write(self.session.intent.command, on))

    def change_interval(self, number: int, period: Nanoseconds | None, default: Nanoseconds) -> str | None:
        """Change a message's interval to the sender's place, None: as for all; or return why not."""
        session, source = self.session, self.sender.source
        # A station that only watches must not slow the telemetry of the one that drives.
        if self.refusal is not None and source == session.drives_from:
            return self.refusal
        if self.refusal is not None and period is not None and period < default:
            return f"{self.refusal}; until then no message comes more often than by default"
        if not session.audience.is_recipient(source, session.drives_from, self.now):
            return "message interval: send heartbeats first, telemetry goes to stations"
        session.audience.change(source, number, period, session.schedule, self.now)
        return None

    def press(self, buttons: int) -> None:
        """Switch over what has its button among these, which have just gone down."""
        for switch in self.station.switches:
            if pressed(buttons, switch.button):
                self.switch(switch, on=not switch.read(self.session.intent.command))

    def actuate(self, place: int, share: float) -> None:
        """Send an actuator of set 0 to a share of its travel, 0 to 1."""
        session = self.session
        session.set_command(
            session.station.actuators[place].send(session.intent.command, share, session.robot)
        )

    def send(self, number: int, which: int = 0) -> bool:
        """Send a message once; False where the bridge has none with this number.

        Of a message that there is of each of several things: all of them, or the one that is `which`, from 1.
        """
        messages = self.session.messages(number, which)
        self.replies += messages or ()
        return messages is not None

    def warn(self, key: str, text: str) -> None:
        """Send a reason, but not at the rate of a joystick."""
        self.replies += self.session.speaker.say_sometimes(key, text, self.now)

    def take_stick(self) -> None:
        """Take the axes of a MANUAL_CONTROL as the newest command, or say why they give none."""
        for name, value in unread(self.message, self.station):
            if name not in self.peer.unread:
                self.peer.unread.add(name)
                text = f"{name} of {self.sender} stands at {value}: this robot does not read it"
                self.session.report(Severity.INFO, text)
        given = stick_of(self.message, self.station, self.peer.lever)
        if isinstance(given, Unusable):
            self.refuse(given)
        else:
            self.move(*given)

    def hold_lever(self) -> None:
        """Take note of where z stands, and whether its button is held."""
        held = pressed(self.message.buttons, self.station.up_button)
        self.peer.lever.receive(self.message.z, self.now, self.session.silent_after, held=held)

    def take_channels(self) -> None:
        """Take the channels of an RC_CHANNELS_OVERRIDE as the newest command, or say why they give none."""
        rows = self.session.station.channels
        given = channels_of(self.message, rows)
        if isinstance(given, Unusable):
            self.refuse(given)
        elif given:
            held = self.peer.channels
            held.receive(given, self.now, self.session.silent_after)
            self.move(*stick_of_channels(held.values, rows, self.station.dead_band))

    def take_target(self) -> None:
        """Take a SET_POSITION_TARGET_LOCAL_NED as the newest command, or say why it gives none."""
        if self.refusal is not None:
            self.ignore()
            return
        place = None if self.station.place is None else place_of(self.message)
        if place is not None:
            self._take_set_point(place)
            return
        snapshot = self.session.snapshot
        heading = None if snapshot is None else snapshot.pose.heading_rad
        velocity = velocity_of(self.message, self.station.largest(self.session.robot), heading)
        if not isinstance(velocity, Unusable) and turns_alone(self.message):
            velocity = self._turned(velocity)
        self._take_set_point(velocity)

    def _take_set_point(self, given: Velocity | Place | Unusable) -> None:
        if isinstance(given, Unusable):
            self.refuse(given)
        elif self.newest():
            self.move(given, given.deflected)

    def take_later(self) -> None:
        """Take a command of a second station with this number: only a stop or a neutral stick counts."""
        message, station = self.message, self.station
        given: tuple[Motion, str] | Unusable
        if message.get_msgId() == dialect.MAVLINK_MSG_ID_MANUAL_CONTROL:
            if pressed(message.buttons, station.stop_button) and not self.stopped:
                self.request(EmergencyStop())
            given = stick_of(message, station, Lever())
        elif message.get_msgId() == dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE:
            channels = channels_of(message, station.channels)
            if isinstance(channels, Unusable):
                given = channels
            else:
                held = {number: value for number, value in channels.items() if value is not None}
                given = stick_of_channels(held, station.channels, station.dead_band)
        else:
            velocity = velocity_of(message, station.largest(self.session.robot), None)
            given = velocity if isinstance(velocity, Unusable) else (velocity, velocity.deflected)
        if isinstance(given, Unusable) or given[1]:
            self.session.dropped.undriven += 1
            self.warn("number", f"{message.get_type()} of the second {self.sender} moves nothing")
        elif self.refusal is None:
            self.move(*given)
            self.peer.neutral_at = self.now

    def _turned(self, velocity: Velocity) -> Velocity | Unusable:
        """Refuse a yaw rate alone where it turns nothing: a robot that steers turns only as it drives."""
        motion_command, still = self.session.intent.command, replace(velocity, yaw_rate_rad_s=0.0)
        if velocity.yaw_rate_rad_s and self.session.applied(velocity, motion_command) == self.session.applied(
            still, motion_command
        ):
            return Unusable("turn alone", "this robot does not turn on the spot; send a velocity, too")
        return velocity

    def move(self, motion: Motion, deflected: str) -> None:
        """Take a motion command as the newest, unless it is unusable; `deflected` is empty for neutral."""
        session, neutral = self.session, not deflected
        # Two stations behind one number: a neutral stick of one of them must not be overruled.
        if deflected and self.now - self.peer.neutral_at < session.silent_after:
            session.dropped.undriven += 1
            self.warn(
                "number",
                f"a second station calls itself {self.sender}, and sends a neutral stick: nothing moves",
            )
            return
        # An axis that was deflected and is not used any more is at neutral at once.
        if isinstance(motion, Stick) and self.peer.last_command is not None:
            motion = motion.after(self.peer.last_command.motion)
        if not session.driven.counts(motion, self.now, neutral=neutral):
            session.dropped.idle += 1
            return
        motion_command = session.applied(motion, session.intent.command)
        if isinstance(motion_command, Unusable):
            self.refuse(motion_command)
        else:
            session.driven.received(motion, self.now, neutral=neutral)
            self.peer.last_command = LastCommand(motion, self.now, deflected)
            age = session.age(self.message, self.sender, self.now)
            sent_at = None if age is None else self.now - age.nanoseconds
            timestamped = age is not None and age.timestamped
            session.intent = Intent(
                motion_command, self.now, sent_at, timestamped=timestamped, deflected=deflected
            )
            # An old command may have been sent before its sender's permission ended.
            session.returned_to_neutral |= neutral and (
                age is None or age.nanoseconds < session.age_limit.most
            )

    def newest(self) -> bool:
        """Return whether no newer motion command has overtaken this one."""
        newest = self.peer.is_newest(self.message, self.now)
        self.session.dropped.overtaken += not newest
        return newest

    def ignore(self) -> None:
        """Report that a motion command of a station not in control moves nothing."""
        self.session.dropped.undriven += 1
        self.warn("control", f"{self.message.get_type()} of {self.sender} moves nothing: {self.refusal}")

    def refuse(self, unusable: Unusable) -> None:
        """Say why a motion command is refused."""
        self.session.dropped.refused += 1
        self.warn(unusable.key, f"{self.message.get_type()} refused: {unusable.reason}")
