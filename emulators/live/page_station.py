"""The live page as a ground station in the world: stick, commands, and neutral when the page is silent.

A station in control that is there, with its stick let go, sends neutral; one that has left sends nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from emulators.bench.foreign_datagrams import command
from emulators.live.texts import OrderedTexts
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.teleop.commands import MAV_CMD_REQUEST_OPERATOR_CONTROL
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of

SYSTEM: Final = 254
COMPONENT: Final = 190
PLACE: Final = number_of("127.0.0.1", 14_551)
SENDS_EVERY: Final[Nanoseconds] = 50 * MILLISECOND
SILENT_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""A page that has sent no stick for so long has lost its focus: the stick is neutral."""
ENDS_AFTER: Final[Nanoseconds] = SECOND
"""Then a page without control sends no stick any more."""
FULL: Final = 1000
ORDERS: Final[Mapping[tuple[str, bool], tuple[int, tuple[float, ...]]]] = MappingProxyType(
    {
        ("take_control", True): (MAV_CMD_REQUEST_OPERATOR_CONTROL, (1.0, 1.0)),
        ("take_control", False): (MAV_CMD_REQUEST_OPERATOR_CONTROL, (0.0,)),
        ("arm", True): (dialect.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,)),
        ("arm", False): (dialect.MAV_CMD_COMPONENT_ARM_DISARM, (0.0,)),
        ("stop", True): (dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,)),
        ("emergency_stop", True): (dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, (0.0,)),
        ("reset_emergency_stop", True): (dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, (1.0,)),
    }
)
"""Commands of the page, as MAV_CMD and first parameters."""


@dataclass(frozen=True, slots=True)
class Stick:
    """Axes of a stick from -1 to 1, z from 0 to 1, and buttons as bits."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.5
    r: float = 0.0
    buttons: int = 0


NEUTRAL: Final = Stick()
_READ: Final = frozenset({dialect.MAVLINK_MSG_ID_COMMAND_ACK, dialect.MAVLINK_MSG_ID_STATUSTEXT})


class PageStation:
    """A `firmware_bridge.node.Node` on the operator's link."""

    def __init__(self, robot: tuple[int, int]) -> None:
        """Take the robot's system and component."""
        self._robot: Final = robot
        self._codec: Final = Codec(SYSTEM, COMPONENT)
        self._stick = NEUTRAL
        self._stick_at: Nanoseconds = -NEVER
        self._due: Nanoseconds = NEVER
        self._holds = False
        """True from taking control until it is released, or the last page is closed."""
        self._unsent: list[bytes] = []
        self._released: list[Packet] = []
        self.texts: Final = OrderedTexts()
        """What the robot has sent to it, or to another station."""
        self.refusals: list[str] = []
        """Commands of the page that were refused, until they are taken."""

    def moves(self, stick: Stick, now: Nanoseconds) -> None:
        """Hold the stick there from now on."""
        self._stick, self._stick_at = stick, now

    def orders(self, name: str, *, on: bool = True) -> None:
        """Send a command of the page with the next wake; KeyError for one that is none."""
        number, params = ORDERS[name, on]
        if name == "take_control":
            self._holds = on
        self._unsent.append(self._codec.encode(command(*self._robot, number, *params)))

    def releases_for(self, system: int, component: int, place: int) -> None:
        """Release control in the place of the mission's operator, who is the bench's own."""
        number, params = ORDERS["take_control", False]
        message = Codec(system, component).encode(command(*self._robot, number, *params))
        self._released.append(Packet(OPERATOR, place, message))

    def leaves(self, now: Nanoseconds) -> None:
        """Let the stick go and fall silent, as the last page is closed: the link's time-out holds then."""
        self._holds = False
        self._stick_at = min(self._stick_at, now - SILENT_AFTER)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Keep the robot's texts, and refusals."""
        for message in self._codec.decode(packet.payload, _READ):
            self._note(message, now)
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send what is due: commands at once, the stick 20 times a second while the page drives."""
        sent, self._unsent = self._unsent, []
        released, self._released = self._released, []
        silent = now - self._stick_at
        if silent >= ENDS_AFTER and not self._holds:
            self._due = NEVER
        elif self._due == NEVER or now >= self._due:
            stick = self._stick if silent < SILENT_AFTER else NEUTRAL
            sent += [self._heartbeat(), self._manual(stick)]
            self._due = now + SENDS_EVERY
        return Reaction((*released, *(Packet(OPERATOR, PLACE, each) for each in sent)), self._due)

    def _heartbeat(self) -> bytes:
        return self._codec.encode(
            dialect.MAVLink_heartbeat_message(
                dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
            )
        )

    def _manual(self, stick: Stick) -> bytes:
        x, y, r = (round(FULL * max(-1.0, min(1.0, part))) for part in (stick.x, stick.y, stick.r))
        # Its middle is neutral, on the page as here.
        z = round(FULL * max(-1.0, min(1.0, 2.0 * stick.z - 1.0)))
        buttons = stick.buttons & 0xFFFF
        return self._codec.encode(dialect.MAVLink_manual_control_message(self._robot[0], x, y, z, r, buttons))

    def _note(self, message: Any, now: Nanoseconds) -> None:
        if message.get_type() == "STATUSTEXT":
            self.texts.receive(message, now)
        elif message.target_system == SYSTEM and message.result:
            refusal = dialect.enums["MAV_RESULT"][message.result].name.removeprefix("MAV_RESULT_").lower()
            self.refusals.append(f"command {message.command}: {refusal.replace('_', ' ')}")
