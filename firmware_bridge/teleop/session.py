"""What the bridge remembers of its operators between two datagrams, and what its telemetry tells."""

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from firmware_bridge.drivers.driver import Power
from firmware_bridge.intent import NEVER_HEARD, Intent
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import Facts, Snapshot
from firmware_bridge.teleop.mavlink import Codec, Message, dialect
from firmware_bridge.teleop.parameters import Store, parameters_of
from firmware_bridge.teleop.schedule import Schedule
from firmware_bridge.teleop.station import AnyStation
from firmware_bridge.teleop.telemetry import TelemetryContext, streams_of
from firmware_bridge.teleop.texts import Speaker
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

VERSION: Final = (0, 1, 0)
CAPABILITIES: Final = (
    dialect.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | dialect.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | dialect.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | dialect.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | dialect.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
)
LISTING_GAP: Final[Nanoseconds] = 10 * MILLISECOND
"""Between two parameters of a list: a third of a 57600 baud link, nothing on a network."""
REMEMBERED: Final[Nanoseconds] = 3 * SECOND
"""How long a command's answer is kept for its repetitions."""
OUT_OF_ORDER: Final[Nanoseconds] = 250 * MILLISECOND
"""How long an older sequence number is taken for a datagram that was overtaken, not for a new start."""


class Address(NamedTuple):
    """Who speaks: system and component."""

    system: int
    component: int


class Answered(NamedTuple):
    """A command, its parameters and what was answered, for its repetitions."""

    command: int
    params: tuple[float, ...]
    result: int
    at: Nanoseconds


@dataclass(slots=True)
class Peer:
    """One ground station's last words."""

    sequence: int | None = None
    moved_at: Nanoseconds = NEVER_HEARD
    buttons: int | None = None
    answered: Answered | None = None

    def is_newest(self, sequence: int, now: Nanoseconds) -> bool:
        """Tell whether a motion command is newer than all before it, and remember it if so."""
        if self.sequence is not None and now - self.moved_at < OUT_OF_ORDER:
            ahead = (sequence - self.sequence) & 0xFF
            if ahead == 0 or ahead & 0x80:
                return False
        self.sequence = sequence
        self.moved_at = now
        return True


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


class Session:
    """The whole memory; one for each bridge."""

    def __init__(
        self,
        robot: AnyRobot,
        station: AnyStation,
        rest: object,
        *,
        rolling: tuple[str, ...],
        modes: tuple[str, ...],
        guides: tuple[str, ...] = (),
    ) -> None:
        self.robot: Final = robot
        self.station: Final = station
        self.rolling: Final = rolling
        self.modes: Final = ("", *modes)
        """By custom mode; the first is the whole robot's."""
        self.guides: Final = ("", *guides)
        """By custom submode; the first is the operator."""
        self.codec: Final = Codec(robot.operator.system_id, robot.operator.component_id)
        self.store: Final = Store(parameters_of(robot, station.parameters))
        self.streams: Final = streams_of(robot, station)
        self.schedule: Final = Schedule(tuple((row.number, row.period) for row in self.streams), robot.cycle)
        self.speaker: Final = Speaker()
        self.intent: Intent[Any] = Intent(rest)
        self.snapshot: Snapshot[Any, Any] | None = None
        self.peers: Final[dict[Address, Peer]] = {}
        self.dropped: Final = Dropped()
        self.terminated = False
        self.resets = 0
        self.listed = len(self.store.rows)
        self.list_due: Nanoseconds = NEVER

    def peer(self, address: Address) -> Peer:
        """Return what is remembered of a ground station."""
        peer = self.peers.get(address)
        if peer is None:
            peer = self.peers[address] = Peer()
        return peer

    def wish(self, wish: object) -> None:
        """Change the wish; what is no motion command is no sign of life."""
        before = self.intent
        self.intent = Intent(wish, before.heard_at, before.said_at, neutral=before.neutral)

    def forget(self) -> None:
        """Forget what of a wish does not outlive a change of state."""
        self.wish(self.station.forgotten(self.intent.wish))

    def context(self, snapshot: Snapshot[Any, Any]) -> TelemetryContext:
        """Return what telemetry tells of a snapshot."""
        facts = snapshot.facts
        status = self._status(facts)
        mode = dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | dialect.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        if facts.armed:
            mode |= dialect.MAV_MODE_FLAG_SAFETY_ARMED
        return TelemetryContext(
            robot=self.robot,
            station=self.station,
            rolling=self.rolling,
            snapshot=snapshot,
            twist=self.station.twist(snapshot.body),
            base_mode=mode,
            custom_mode=self.modes.index(facts.mode),
            system_status=status,
            healthy=status in (dialect.MAV_STATE_STANDBY, dialect.MAV_STATE_ACTIVE),
            corrupt=self.codec.counters.corrupt,
            resets=self.resets,
        )

    def messages(self, number: int) -> tuple[Message, ...] | None:
        """Return a message for a station that asks for it once; None where the bridge has no such message."""
        if number == dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return (_version(),)
        streams = [stream for stream in self.streams if stream.number == number]
        if self.snapshot is None or not streams:
            return None
        context = self.context(self.snapshot)
        return tuple(message for stream in streams for message in stream.encode(context))

    def _status(self, facts: Facts) -> int:
        silent = facts.now - self.intent.heard_at > self.robot.operator.silent_ms * MILLISECOND
        axes = facts.axes.values()
        rows: tuple[tuple[bool, int], ...] = (
            (self.terminated, dialect.MAV_STATE_FLIGHT_TERMINATION),
            (facts.emergency_stopped, dialect.MAV_STATE_EMERGENCY),
            (any(axis.fault for axis in axes), dialect.MAV_STATE_CRITICAL),
            (any(axis.power is Power.UNKNOWN for axis in axes), dialect.MAV_STATE_BOOT),
            (not facts.armed, dialect.MAV_STATE_STANDBY),
            (silent, dialect.MAV_STATE_CRITICAL),
        )
        active: int = dialect.MAV_STATE_ACTIVE
        return next((state for holds, state in rows if holds), active)


def _version() -> Message:
    major, minor, patch = VERSION
    nothing = (0,) * 8
    return dialect.MAVLink_autopilot_version_message(
        capabilities=CAPABILITIES,
        flight_sw_version=major << 24 | minor << 16 | patch << 8 | dialect.FIRMWARE_VERSION_TYPE_OFFICIAL,
        middleware_sw_version=0,
        os_sw_version=0,
        board_version=0,
        flight_custom_version=nothing,
        middleware_custom_version=nothing,
        os_custom_version=nothing,
        vendor_id=0,
        product_id=0,
        uid=0,
    )
