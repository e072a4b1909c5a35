"""What the bridge remembers of its operators between two datagrams, and the scene for its telemetry."""

from dataclasses import dataclass, field
from typing import Final, NamedTuple

from firmware_bridge.intent import Intent
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.mavlink import Codec, Message, dialect
from firmware_bridge.teleop.parameters import PARAMETERS, Store
from firmware_bridge.teleop.schedule import Schedule
from firmware_bridge.teleop.telemetry import STREAMS, Scene, tell
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


class Peer(NamedTuple):
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
class Station:
    """One peer's last words."""

    sequence: int | None = None
    moved_at: Nanoseconds = -NEVER
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


@dataclass(slots=True)
class Session:
    """The whole memory; one for each bridge."""

    robot: Robot
    codec: Codec
    store: Store
    schedule: Schedule
    speaker: Speaker = field(default_factory=Speaker)
    intent: Intent = field(default_factory=Intent)
    snapshot: Snapshot | None = None
    stations: dict[Peer, Station] = field(default_factory=dict)
    dropped: Dropped = field(default_factory=Dropped)
    terminated: bool = False
    resets: int = 0
    listed: int = len(PARAMETERS)
    list_due: Nanoseconds = NEVER

    def station(self, peer: Peer) -> Station:
        """Return what is remembered of a peer."""
        station = self.stations.get(peer)
        if station is None:
            station = self.stations[peer] = Station()
        return station

    def scene(self, snapshot: Snapshot) -> Scene:
        """Return what telemetry tells of a snapshot."""
        status = self._status(snapshot)
        mode = dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | dialect.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        if snapshot.armed:
            mode |= dialect.MAV_MODE_FLAG_SAFETY_ARMED
        return Scene(
            robot=self.robot,
            snapshot=snapshot,
            base_mode=mode,
            system_status=status,
            healthy=status in (dialect.MAV_STATE_STANDBY, dialect.MAV_STATE_ACTIVE),
            corrupt=self.codec.counters.corrupt,
            resets=self.resets,
        )

    def messages(self, number: int) -> tuple[Message, ...] | None:
        """Return a message for a station that asks for it once; None where the bridge has no such message."""
        if number == dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return (_version(),)
        if self.snapshot is None or all(stream.number != number for stream in STREAMS):
            return None
        return tell(number, self.scene(self.snapshot))

    def _status(self, snapshot: Snapshot) -> int:
        silent = snapshot.now - self.intent.heard_at > self.robot.operator.silent_ms * MILLISECOND
        rows: tuple[tuple[bool, int], ...] = (
            (self.terminated, dialect.MAV_STATE_FLIGHT_TERMINATION),
            (snapshot.emergency_stopped, dialect.MAV_STATE_EMERGENCY),
            (any(drive.fault for drive in snapshot.drives), dialect.MAV_STATE_CRITICAL),
            (any(drive.state is None for drive in snapshot.drives), dialect.MAV_STATE_BOOT),
            (not snapshot.armed, dialect.MAV_STATE_STANDBY),
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
