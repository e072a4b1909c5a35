"""What the bridge reports of itself: HEARTBEAT's mode and status, which follow from the active interlocks."""

from typing import Final

from firmware_bridge.drivers.driver import Power
from firmware_bridge.intent import NEVER_RECEIVED, ClearEmergencyStop, EmergencyStop, Request, ResetOdometry
from firmware_bridge.mavlink import modes as driving_modes
from firmware_bridge.mavlink.frames import Counters, Message, dialect
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot, Facts
from firmware_bridge.teleop.driving import Driving
from firmware_bridge.teleop.streams import Stream
from firmware_bridge.teleop.telemetry import TelemetryContext
from firmware_bridge.units import Nanoseconds

VERSION: Final = (0, 1, 0)
CAPABILITIES: Final = (
    dialect.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | dialect.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | dialect.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | dialect.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | dialect.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
)


class Status:
    """The newest snapshot as stations see it, and what was granted since."""

    def __init__(
        self,
        driving: Driving,
        counters: Counters,
        streams: tuple[Stream, ...],
        *,
        rolling: tuple[str, ...],
        modes: tuple[str, ...],
    ) -> None:
        """Take what drives, the count of frames, the streams, the rolling axes, and the robot's own modes."""
        self._driving: Final = driving
        self._counters: Final = counters
        self._streams: Final = streams
        self._rolling: Final = rolling
        self.modes: Final = ("", *modes)
        """Modes by custom mode; the first is the whole robot's."""
        self._snapshot: AnySnapshot | None = None
        self._events: tuple[ActiveInterlock, ...] = ()
        self._cleared_at: Nanoseconds = NEVER_RECEIVED
        """Time of the emergency stop's last reset."""
        self._resets = 0
        """Count of the odometry's resets."""
        self._terminated = False

    def see(self, snapshot: AnySnapshot, events: tuple[ActiveInterlock, ...]) -> TelemetryContext:
        """Take the newest cycle's snapshot and active interlocks; return the telemetry's context."""
        self._snapshot, self._events = snapshot, events
        return self._context(snapshot)

    def granted(self, request: Request, now: Nanoseconds) -> None:
        """Take note of what the bridge has granted since the newest snapshot."""
        match request:
            case ClearEmergencyStop():
                self._cleared_at = now
            case ResetOdometry():
                self._resets += 1
            case EmergencyStop(final=True):
                self._terminated = True

    @property
    def armed(self) -> bool:
        """True while the robot may move, as of the newest snapshot."""
        return self._snapshot is not None and self._snapshot.facts.armed

    @property
    def mode(self) -> str:
        """The robot's mode after a failed actuator, as of the newest snapshot; empty while it is whole."""
        return "" if self._snapshot is None else self._snapshot.facts.mode

    @property
    def heading_rad(self) -> float | None:
        """The robot's heading, as of the newest snapshot; None before the first."""
        return None if self._snapshot is None else self._snapshot.pose.heading_rad

    @property
    def stopped(self) -> bool:
        """True while the emergency stop is latched, as of a snapshot since its last reset."""
        snapshot = self._snapshot
        latched = snapshot is not None and snapshot.facts.emergency_stopped
        return latched and snapshot is not None and snapshot.facts.now > self._cleared_at

    def messages(self, number: int, which: int = 0) -> tuple[Message, ...] | None:
        """Return a message for one request of a station; None where the bridge has no such message."""
        if number == dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return (_version(),)
        if number == dialect.MAVLINK_MSG_ID_AVAILABLE_MODES:
            modes = driving_modes.listed(self.modes)
            return tuple(modes[which - 1 : which] if which else modes) or None
        streams = [stream for stream in self._streams if stream.number == number]
        if self._snapshot is None or not streams:
            return None
        context = self._context(self._snapshot)
        return tuple(message for stream in streams for message in stream.encode(context))

    def _context(self, snapshot: AnySnapshot) -> TelemetryContext:
        facts, driving = snapshot.facts, self._driving
        driving_mode = driving.mode(paused=facts.paused)
        mode = dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | driving_modes.BY_DRIVING_MODE[driving_mode].flags
        if facts.armed:
            mode |= dialect.MAV_MODE_FLAG_SAFETY_ARMED
        trouble, station = self._trouble(facts), driving.stations.in_control
        return TelemetryContext(
            robot=driving.robot,
            station=driving.rows,
            rolling=self._rolling,
            snapshot=snapshot,
            twist=driving.rows.twist(snapshot.body),
            base_mode=mode,
            custom_mode=driving_modes.number_of(driving_mode, self.modes.index(facts.mode)),
            system_status=self._driven(facts) if trouble is None else trouble,
            healthy=trouble is None,
            corrupt=self._counters.corrupt,
            resets=self._resets,
            round_trip=None if station is None else station.clocks.trips.newest(facts.now),
            lost=None if station is None else station.clocks.losses.share,
        )

    def _trouble(self, facts: Facts) -> int | None:
        """Return the status of an emergency stop, a fault or a silent device; None without any."""
        axes = facts.axes.values()
        rows: tuple[tuple[bool, int], ...] = (
            (self._terminated, dialect.MAV_STATE_FLIGHT_TERMINATION),
            (facts.emergency_stopped, dialect.MAV_STATE_EMERGENCY),
            (any(axis.fault for axis in axes), dialect.MAV_STATE_CRITICAL),
            (any(axis.power is Power.UNKNOWN for axis in axes), dialect.MAV_STATE_BOOT),
        )
        return next((state for is_so, state in rows if is_so), None)

    def _driven(self, facts: Facts) -> int:
        """Return the status of a robot without trouble: CRITICAL while an interlock holds it."""
        if not facts.armed:
            return int(dialect.MAV_STATE_STANDBY)
        rows = (one.interlock for one in self._events)
        held = any(row.stops is None and row.severity <= Severity.WARNING for row in rows)
        return int(dialect.MAV_STATE_CRITICAL if held else dialect.MAV_STATE_ACTIVE)


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
