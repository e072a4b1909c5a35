"""MANUAL_CONTROL's axes as a robot's stick: those that its station reads, and how far each is deflected.

Ground stations rest `z`, a throttle, at 0 or at 500, and neither may move anything. A station may name a
button for it: `z` counts then while the button is held, as the way from where it stood when the button was
pressed. An axis that the robot does not read counts for nothing, wherever it stands.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.mavlink.frames import Message
from firmware_bridge.teleop.station import AnyStation, Stick, StickAxis, Unusable
from firmware_bridge.units import Nanoseconds

FULL_STICK: Final = 1000
UNUSED: Final = 0x7FFF
AXES: Final[Mapping[StickAxis, tuple[str, int]]] = {
    StickAxis.FORWARD: ("x", 1),
    StickAxis.LEFT: ("y", -1),
    StickAxis.TURN: ("r", -1),
    StickAxis.UP: ("z", 1),
}
"""The message's field for each axis, and its sign there: MAVLink counts `y` to the right, `r` clockwise."""
EXTENSIONS: Final = ("s", "t", "aux1", "aux2", "aux3", "aux4", "aux5", "aux6")
"""Further axes by their bits in `enabled_extensions` (common.xml); no robot reads them."""


class StickPosition(NamedTuple):
    """Stick position in a message."""

    stick: Stick
    deflected: str
    """The first axis that is not neutral, with its value and the neutral one; empty where all are."""


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


def stick_of(message: Message, station: AnyStation, lever: Lever) -> StickPosition | Unusable:
    """Decode the axes of a MANUAL_CONTROL that a robot reads; the lever has received it already."""
    shares: dict[StickAxis, float] = {}
    deflected = ""
    for axis, (name, sign) in AXES.items():
        value, neutral = _counted(message, station, axis, lever), _neutral(station, axis, lever)
        if value == UNUSED:
            continue
        if abs(value) > FULL_STICK:
            return Unusable("stick", f"{name} = {value} is beyond +-{FULL_STICK}")
        way = max(min(value - neutral, FULL_STICK), -FULL_STICK)
        neutral_now = abs(way) <= station.dead_band * FULL_STICK
        # A lift's stick at neutral gives no rate, so that a target by command stays in force.
        if axis is not StickAxis.UP or not neutral_now:
            shares[axis] = sign * way / FULL_STICK
        if not (neutral_now or deflected):
            deflected = f"{name} stands at {value}: this robot wants {neutral}"
    return StickPosition(
        Stick(
            forward=shares.get(StickAxis.FORWARD),
            left=shares.get(StickAxis.LEFT),
            turn=shares.get(StickAxis.TURN),
            up=shares.get(StickAxis.UP),
        ),
        deflected,
    )


def unread(message: Message, station: AnyStation) -> Iterator[tuple[str, int]]:
    """Yield the deflected axes that the robot does not read: their fields and values."""
    names = [name for axis, (name, _) in AXES.items() if axis not in station.axes]
    names += [name for bit, name in enumerate(EXTENSIONS) if message.enabled_extensions >> bit & 1]
    for name in names:
        value: int = getattr(message, name)
        if value != UNUSED and abs(value) > station.dead_band * FULL_STICK:
            yield name, value


def _counted(message: Message, station: AnyStation, axis: StickAxis, lever: Lever) -> int:
    if axis not in station.axes or (_levered(station, axis) and not lever.held):
        return UNUSED
    value: int = getattr(message, AXES[axis][0])
    return value


def _neutral(station: AnyStation, axis: StickAxis, lever: Lever) -> int:
    return lever.stood if _levered(station, axis) and lever.stood != UNUSED else 0


def _levered(station: AnyStation, axis: StickAxis) -> bool:
    return axis is StickAxis.UP and station.up_button is not None
