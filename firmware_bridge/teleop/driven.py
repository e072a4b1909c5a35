"""The commands that drive the robot: the newest, or set-points alone where a station has requested that.

A motion's admissibility is for the interlocks, whichever way it came.
"""

from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.mavlink.modes import DrivingMode
from firmware_bridge.teleop.station import Motion, Stick
from firmware_bridge.units import Nanoseconds


class ReportedMode:
    """The reported way of driving, and the commands that do not count in it."""

    __slots__ = ("_guided", "_set_points", "_set_points_at", "_silent_after")

    def __init__(self, silent_after: Nanoseconds) -> None:
        """Take the silence of set-points after which a neutral stick counts again."""
        self._silent_after: Final = silent_after
        self._set_points = False
        """True where the newest motion command was a set-point."""
        self._set_points_at: Nanoseconds = NEVER_RECEIVED
        self._guided = False
        """True where a station has requested set-points alone."""

    def driving_mode(self, *, paused: bool) -> DrivingMode:
        """Return the reported way of driving."""
        if paused:
            return DrivingMode.HOLD
        return DrivingMode.GUIDED if self._guided or self._set_points else DrivingMode.MANUAL

    def begin(self) -> None:
        """Forget it all: another one drives, or no one."""
        self._guided = self._set_points = False

    def wait(self) -> None:
        """Accept no commands: the robot has been paused, and goes on by an order alone."""
        self._guided = self._set_points = False

    def order(self, driving_mode: DrivingMode, now: Nanoseconds) -> None:
        """Be driven in this way from now on."""
        self._guided = self._set_points = driving_mode is DrivingMode.GUIDED
        if self._guided:
            self._set_points_at = now

    def counts(self, motion: Motion, now: Nanoseconds, *, neutral: bool) -> bool:
        """Return whether a motion command counts: all do, but a neutral stick beside set-points."""
        # A centred stick beside set-points would stop the robot between two of them.
        idles = self._guided and neutral and isinstance(motion, Stick)
        return not idles or now - self._set_points_at >= self._silent_after

    def received(self, motion: Motion, now: Nanoseconds, *, neutral: bool) -> None:
        """Take note of a motion command that counted; a deflected stick ends the request for set-points."""
        if not isinstance(motion, Stick):
            self._set_points_at = now
            self._set_points = self._set_points or not neutral
        elif not neutral:
            self._guided = self._set_points = False
        elif not self._guided:
            self._set_points = False


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
