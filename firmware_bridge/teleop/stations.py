"""The ground stations on record, what counts of each one's frames, and which of them is in control.

One station at a time is in control; while none is, each one's newest command counts. This module sends
nothing and knows no motion. Sources: common.xml, CHANGE_OPERATOR_CONTROL; development.xml,
MAV_CMD_REQUEST_OPERATOR_CONTROL, as QGroundControl and MAVProxy send it since 2026.
"""

from dataclasses import dataclass, field
from typing import Final, NamedTuple

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.mavlink.age import BOOT_WRAPS, SET_POINT, Age, Ages
from firmware_bridge.mavlink.frames import FrameNumbers, Message, Sequenced
from firmware_bridge.teleop.station import Motion
from firmware_bridge.teleop.texts import Quality
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.internet import place_of

LAPSES_AFTER: Final[Nanoseconds] = 10 * SECOND
"""Silence after which a station loses control, once the robot is at standstill."""
MOST_STATIONS: Final = 64
"""Most stations on record; of more, the one silent for longest is dropped, never the one in control."""
LATEST_BOOT_MS: Final = 10_000
"""So far behind the newest one a set-point's time is overtaken; further behind its station has restarted."""
UNUSED: Final = 0x7FFF
"""The value of an axis of MANUAL_CONTROL that a station does not use."""


class Sender(NamedTuple):
    """A sender: the source of its datagrams, and its system and component."""

    source: int
    """The packet's address: what `firmware_bridge.wire.internet` makes of a place, or 0 on a link to one."""
    system: int
    component: int

    def __str__(self) -> str:
        place = place_of(self.source)
        return f"{self.system}/{self.component}" + (f" at {place}" if place else "")


class AnsweredCommand(NamedTuple):
    """A command, its parameters and what was answered, for its repetitions."""

    command: int
    params: tuple[float, ...]
    result: int
    at: Nanoseconds


class LastCommand(NamedTuple):
    """A station's newest motion command."""

    motion: Motion
    at: Nanoseconds
    deflected: str
    """The controls that are not neutral in it; empty where it is neutral."""


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


@dataclass(slots=True)
class Channels:
    """One station's channels of RC_CHANNELS_OVERRIDE, each until it is given back, or grows old."""

    _held: dict[int, tuple[int, Nanoseconds]] = field(default_factory=dict)

    @property
    def values(self) -> dict[int, int]:
        """Return what is held, in us, by the channels' numbers."""
        return {number: value for number, (value, _) in self._held.items()}

    def receive(self, channels: dict[int, int | None], now: Nanoseconds, silent_after: Nanoseconds) -> None:
        """Take a message's values of some channels; one without a value for so long is given back."""
        for number, value in channels.items():
            if value is None:
                self._held.pop(number, None)
            else:
                self._held[number] = (value, now)
        for number in [one for one, (_, at) in self._held.items() if now - at >= silent_after]:
            del self._held[number]


@dataclass(slots=True, eq=False)
class Station:
    """One ground station: its last messages, its controls, and its clocks while it is in control."""

    sender: Sender
    received_at: Nanoseconds = 0
    """Time of its newest good frame, whatever it is."""
    last_command: LastCommand | None = None
    """Its last command while it was in control or no station was: others' commands are ignored."""
    moved: Sequenced | None = None
    """Its newest motion command."""
    boot_ms: int | None = None
    """The newest time that a set-point carried."""
    stopped: Sequenced | None = None
    """Its newest stop command."""
    buttons: int | None = None
    channels: Channels = field(default_factory=Channels)
    lever: Lever = field(default_factory=Lever)
    unread: set[str] = field(default_factory=set)
    """Its axes that were reported as deflected and not read."""
    answered: AnsweredCommand | None = None
    stop_answered_at: Nanoseconds = NEVER_RECEIVED
    """Time of the answer to its emergency stop while another station was in control."""
    numbers: FrameNumbers = field(default_factory=FrameNumbers)
    later: bool = False
    """The newest frame is of a second station that calls itself so, which came later."""
    neutral_at: Nanoseconds = NEVER_RECEIVED
    """Time when that one was neutral."""
    clocks: Ages = field(default_factory=lambda: Ages(signed=False))
    """Its clocks and its link since it took control; nothing is known of them before."""
    quality: Quality = field(default_factory=Quality)

    def receive(self, message: Message, now: Nanoseconds) -> bool:
        """Take note of a good frame; return whether it shows that two stations have this number."""
        alone = not self.numbers.two
        self.received_at = now
        self.clocks.losses.received(message.get_seq(), now)
        self.later = self.numbers.receive(message.get_seq(), message.get_crc(), now)
        if alone and self.numbers.two:
            self.moved = None
            return True
        return False

    def is_newest(self, message: Message, now: Nanoseconds) -> bool:
        """Return whether a motion command is newer than all before it, and remember it if so."""
        sequence = message.get_seq()
        if self.moved is not None and self.moved.overtook(sequence, now):
            return False
        if message.get_msgId() == SET_POINT and message.time_boot_ms != 0:
            time: int = message.time_boot_ms
            behind = 0 if self.boot_ms is None else (self.boot_ms - time) % BOOT_WRAPS
            # Only both together: a clock that was set back goes on with the next number.
            if self.moved is not None and self.moved.follows(sequence) and 0 < behind <= LATEST_BOOT_MS:
                return False
            self.boot_ms = time
        self.moved = Sequenced(sequence, now)
        return True

    def age(self, message: Message, now: Nanoseconds, limit: Nanoseconds) -> Age | None:
        """Return the age of a message that arrives now, of the station in control; None where it is unknown.

        Ways to find it that differ by more than `limit` do not date it.
        """
        clocks = self.clocks
        if clocks.signed or message.get_msgId() == SET_POINT:
            return clocks.age(message, now, limit)
        # It carries no time: all that is known is that it has travelled.
        trips = clocks.trips
        trip = trips.least if now <= trips.least_until else trips.newest(now)
        return None if trip is None else Age(trip // 2, timestamped=False)


class Stations:
    """All stations, and control of the robot; no station has it at first."""

    __slots__ = ("_by_key", "in_control", "of", "yields")

    def __init__(self, *, signed: bool) -> None:
        """Begin with none; `signed`: signatures are checked, so that their stamps are the stations'."""
        self._by_key: Final = signed
        self.of: Final[dict[Sender, Station]] = {}
        self.in_control: Station | None = None
        self.yields = False
        """True where the station in control lets any station take over on request."""

    @property
    def source(self) -> int | None:
        """The place of the station in control; None without one."""
        return None if self.in_control is None else self.in_control.sender.source

    def find(self, sender: Sender) -> Station:
        """Return the record of a sender, a new one where it has none."""
        station = self.of.get(sender)
        if station is None:
            if len(self.of) >= MOST_STATIONS:
                others = (one for one in self.of.values() if one is not self.in_control)
                del self.of[min(others, key=lambda one: one.received_at).sender]
            station = self.of[sender] = Station(sender)
        return station

    def passed(self, sender: Sender, sequence: int, now: Nanoseconds) -> None:
        """Note a frame for another robot: from the station in control it does not count as missing."""
        if self.in_control is not None and self.in_control.sender == sender:
            self.in_control.clocks.losses.received(sequence, now)

    def refusal(self) -> str:
        """Say why a station may not drive that is not in control, while another one is."""
        in_control = None if self.in_control is None else self.in_control.sender
        return f"{in_control} is in control; request control, or wait until it is released"

    def take(self, station: Station, *, yields: bool = False) -> None:
        """Let a station drive."""
        if station is not self.in_control:
            # Of another station's link nothing is known yet.
            station.clocks, station.quality = Ages(signed=self._by_key), Quality()
        self.in_control, self.yields = station, yields

    def give_up(self) -> None:
        """Let no one drive."""
        self.in_control, self.yields = None, False

    def lapses(self, now: Nanoseconds) -> bool:
        """Return whether the station in control has been silent for too long; the robot must rest first."""
        station = self.in_control
        return station is not None and now - station.received_at >= LAPSES_AFTER
