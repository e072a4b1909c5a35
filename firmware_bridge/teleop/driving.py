"""The operator's command: the newest motion command, or set-points alone where a station has requested that.

A motion's admissibility is for the interlocks, whichever way it came. MANUAL_CONTROL is read here, too.
Ground stations rest `z`, a throttle, at 0 or at 500, and neither may move anything: a robot's rows may name a
button for it; `z` counts then while the button is held, as the way from where it stood when the button was
pressed. An axis that the robot does not read counts for nothing, wherever it stands.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

from firmware_bridge.intent import NEVER_RECEIVED, AgeLimit, Intent
from firmware_bridge.mavlink.frames import Message
from firmware_bridge.mavlink.injection import Injection
from firmware_bridge.mavlink.modes import DrivingMode
from firmware_bridge.robot import AnyRobot, UnknownAge
from firmware_bridge.teleop.incoming import UNUSED, Incoming, LastCommand, Lever, Station
from firmware_bridge.teleop.station import AnyStation, Motion, Stick, StickAxis, Switch, Unusable, Velocity
from firmware_bridge.teleop.stations import Stations
from firmware_bridge.units import MILLISECOND, Nanoseconds

FULL_STICK: Final = 1000
AXES: Final[Mapping[StickAxis, tuple[str, int]]] = {
    StickAxis.FORWARD: ("x", 1),
    StickAxis.LEFT: ("y", -1),
    StickAxis.TURN: ("r", -1),
    StickAxis.UP: ("z", 1),
}
"""MANUAL_CONTROL's field for each axis, and its sign: MAVLink counts `y` to the right, `r` clockwise."""
EXTENSIONS: Final = ("s", "t", "aux1", "aux2", "aux3", "aux4", "aux5", "aux6")
"""Further axes by their bits in `enabled_extensions` (common.xml); no robot reads them."""
NOTHING: Final = Velocity(0.0, 0.0, 0.0)


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


class StickPosition(NamedTuple):
    """Stick position in a message."""

    stick: Stick
    deflected: str
    """The first axis that is not neutral, with its value and the neutral one; empty where all are."""


class Driving:
    """The operator's command, and the way of driving that decides which motion commands count."""

    def __init__(
        self,
        robot: AnyRobot,
        rows: AnyStation,
        rest: object,
        stations: Stations,
        *,
        signed: bool,
        injection: Injection,
    ) -> None:
        """Begin at rest; where messages are signed, one of unknown age is refused by default."""
        self.injection: Final = injection
        self.robot: Final = robot
        self.rows: Final = rows
        self.stations: Final = stations
        self.dropped: Final = Dropped()
        self.stop_mask: Final = 0 if rows.stop_button is None else 1 << rows.stop_button
        """The bit of the emergency stop's button in MANUAL_CONTROL; 0 without one."""
        self.up_mask: Final = 0 if rows.up_button is None else 1 << rows.up_button
        """The bit of the button without which z counts for nothing."""
        self.silent_after: Final[Nanoseconds] = robot.operator.silent_ms * MILLISECOND
        self.intent: Intent = Intent(rest)
        self.returned_to_neutral = False
        """A neutral motion command has come since the newest cycle, whatever came after it."""
        decided = robot.operator.unknown_age
        needed = signed if decided is None else decided is UnknownAge.REFUSE
        self.age_limit = AgeLimit(
            robot.operator.age_limit_ms * MILLISECOND, needed, robot.operator.max_age_ms * MILLISECOND
        )
        """Age limit of a motion command."""
        self._guided = False
        """True where a station has requested set-points alone."""
        self._set_points = False
        """True where the newest motion command was a set-point."""
        self._set_points_at: Nanoseconds = NEVER_RECEIVED

    def mode(self, *, paused: bool) -> DrivingMode:
        """Return the reported way of driving."""
        if paused:
            return DrivingMode.HOLD
        return DrivingMode.GUIDED if self._guided or self._set_points else DrivingMode.MANUAL

    def by_hand(self) -> None:
        """Let any newest command count: another one drives, no one, or the robot has been paused."""
        self._guided = self._set_points = False

    def order(self, mode: DrivingMode, now: Nanoseconds) -> None:
        """Be driven in this way from now on."""
        self._guided = self._set_points = mode is DrivingMode.GUIDED
        if self._guided:
            self._set_points_at = now

    def set_command(self, command: object) -> None:
        """Change the command; what is no motion command is no sign of life."""
        before = self.intent
        self.intent = Intent(
            command,
            before.received_at,
            before.sent_at,
            timestamped=before.timestamped,
            deflected=before.deflected,
        )

    def press(self, buttons: int) -> None:
        """Switch over what has its button among these, which have just gone down."""
        for switch in self.rows.switches:
            if pressed(buttons, switch.button):
                self.switch(switch, on=not switch.read(self.intent.command))

    def switch(self, switch: Switch[Any], *, on: bool) -> None:
        """Switch one of the robot's switches."""
        self.set_command(switch.write(self.intent.command, on))

    def actuate(self, place: int, share: float) -> None:
        """Send an actuator of set 0 to a share of its travel, 0 to 1."""
        self.set_command(self.rows.actuators[place].send(self.intent.command, share, self.robot))

    def forget(self) -> None:
        """Forget what of a command does not outlive a change of state."""
        self.injection.forget()
        self.set_command(self.rows.forgotten(self.intent.command))

    def adopt(self, station: Station | None, now: Nanoseconds) -> None:
        """Take a station's own newest motion command; no one's, and an old one's, is to standstill.

        What is switched stays as it is.
        """
        self.injection.forget()
        command: object = self.rows.forgotten(self.intent.command)
        stands = self.applied(NOTHING, command)
        if not isinstance(stands, Unusable):
            command = stands
        self.intent = Intent(command)
        gone = self.robot.operator.lost_ms * MILLISECOND
        last = None if station is None else station.last_command
        if last is None or now - last.at >= gone:
            return
        applied = self.applied(last.motion, command)
        if not isinstance(applied, Unusable):
            self.intent = Intent(applied, last.at, deflected=last.deflected)

    def applied(self, motion: Motion, command: object) -> object:
        """Return what a motion command makes of the one before it; `Unusable` where it is none."""
        made: object = self.rows.applied(motion, command, self.robot)
        return made

    def take(
        self, station: Station, message: Message, motion: Motion, deflected: str, now: Nanoseconds
    ) -> Unusable | None:
        """Take a motion command as the newest, if it counts; return why it is unusable, None where it is not.

        `deflected` is empty for one that is neutral.
        """
        if self.injection.on:
            later = partial(self.take_now, station, message, motion, deflected)
            if self.injection.holds(now, later):
                return None
        return self.take_now(station, message, motion, deflected, now)

    def take_now(
        self, station: Station, message: Message, motion: Motion, deflected: str, now: Nanoseconds
    ) -> Unusable | None:
        """Take a motion command that no injected failure delays, or not any more."""
        # Two stations behind one number: a neutral stick of one of them must not be overruled.
        if deflected and now - station.neutral_at < self.silent_after:
            return Unusable("number", f"a second station calls itself {station.sender}, its stick is neutral")
        stick = isinstance(motion, Stick)
        # A centred stick beside set-points would stop the robot between two of them.
        if stick and not deflected and self._guided and now - self._set_points_at < self.silent_after:
            self.dropped.idle += 1
            return None
        motion = _released(motion, station.last_command)
        make: Callable[..., object] = self.rows.stick if stick else self.rows.applied
        command = make(motion, self.intent.command, self.robot)
        if isinstance(command, Unusable):
            return command
        station.last_command = LastCommand(motion, now, deflected)
        in_control = station is self.stations.in_control
        age = station.age(message, now, self.age_limit.most) if in_control else None
        sent_at = None if age is None else now - age.nanoseconds
        timestamped = age is not None and age.timestamped
        self.intent = Intent(command, now, sent_at, timestamped=timestamped, deflected=deflected)
        # An old command may have been sent before its sender's permission ended.
        recent = age is None or age.nanoseconds < self.age_limit.most
        self.returned_to_neutral = self.returned_to_neutral or (recent and not deflected)
        self._follow_mode(now, stick=stick, neutral=not deflected)
        return None

    def _follow_mode(self, now: Nanoseconds, *, stick: bool, neutral: bool) -> None:
        """Take note of a motion command that counted; a deflected stick ends the request for set-points."""
        if not stick:
            self._set_points_at = now
            self._set_points = self._set_points or not neutral
        elif not neutral:
            self._guided = self._set_points = False
        elif not self._guided:
            self._set_points = False


def manual_control(incoming: Incoming) -> None:
    """Take a MANUAL_CONTROL: its emergency stop of anyone, its buttons and axes of the station in control."""
    message, station, now, link = incoming.message, incoming.station, incoming.now, incoming.link
    driving, buttons = link.driving, int(message.buttons)
    rows = driving.rows
    if buttons & driving.stop_mask:
        incoming.emergency_stop()
    if not station.is_newest(message, now):
        driving.dropped.overtaken += 1
        return  # its buttons would go down twice
    # The first message of a station has no edges: a button that is already down is no news.
    gone_down = buttons & ~(buttons if station.buttons is None else station.buttons)
    station.buttons = buttons
    station.lever.receive(message.z, now, driving.silent_after, held=bool(buttons & driving.up_mask))
    if incoming.refusal is not None:
        incoming.ignore()
        return
    if gone_down and incoming.late is None:
        driving.press(gone_down)
    given = stick_of(message, rows, station.lever)
    unusable = (
        given
        if isinstance(given, Unusable)
        else driving.take(station, message, given.stick, given.deflected, now)
    )
    if unusable is not None:
        incoming.refuse(unusable)
    for name, value in unread(message, rows):
        incoming.report_unread(name, value)


def stick_of(message: Message, rows: AnyStation, lever: Lever) -> StickPosition | Unusable:
    """Decode the axes of a MANUAL_CONTROL that a robot reads; the lever has received it already."""
    shares: dict[StickAxis, float] = {}
    deflected = ""
    for axis, (name, sign) in AXES.items():
        value: int = getattr(message, name)
        levered = axis is StickAxis.UP and rows.up_button is not None
        if value == UNUSED or axis not in rows.axes or (levered and not lever.held):
            continue
        if abs(value) > FULL_STICK:
            return Unusable("stick", f"{name} = {value} is beyond +-{FULL_STICK}")
        neutral = lever.stood if levered and lever.stood != UNUSED else 0
        way = max(min(value - neutral, FULL_STICK), -FULL_STICK)
        is_neutral = abs(way) <= rows.dead_band * FULL_STICK
        # A lift's stick at neutral gives no rate, so that a target by command stays in force.
        if axis is not StickAxis.UP or not is_neutral:
            shares[axis] = sign * way / FULL_STICK
        if not (is_neutral or deflected):
            deflected = f"{name} stands at {value}: this robot wants {neutral}"
    stick = Stick(
        forward=shares.get(StickAxis.FORWARD),
        left=shares.get(StickAxis.LEFT),
        turn=shares.get(StickAxis.TURN),
        up=shares.get(StickAxis.UP),
    )
    return StickPosition(stick, deflected)


def unread(message: Message, rows: AnyStation) -> Iterator[tuple[str, int]]:
    """Yield the deflected axes that the robot does not read: their fields and values."""
    names = [name for axis, (name, _) in AXES.items() if axis not in rows.axes]
    names += [name for bit, name in enumerate(EXTENSIONS) if message.enabled_extensions >> bit & 1]
    for name in names:
        value: int = getattr(message, name)
        if value != UNUSED and abs(value) > rows.dead_band * FULL_STICK:
            yield name, value


def pressed(buttons: int, button: int | None) -> bool:
    """Return whether a button, from 0, is among these bits; a robot without it never has it pressed."""
    return button is not None and bool(buttons >> button & 1)


def _released(motion: Motion, last: LastCommand | None) -> Motion:
    """Return a stick with those axes at 0 that its station deflected before, and does not use any more."""
    before = None if last is None else last.motion
    if not isinstance(motion, Stick) or not isinstance(before, Stick):
        return motion
    forward, left, turn = motion.forward, motion.left, motion.turn
    if forward is None and before.forward:
        forward = 0.0
    # Where one of the two is in use, it steers.
    if left is None and turn is None:
        left, turn = 0.0 if before.left else None, 0.0 if before.turn else None
    return Stick(forward, left, turn, motion.up)
