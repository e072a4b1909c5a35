"""CiA 402 drives in a robot file: their CAN bus, a drive's profile; families add what their products need."""

import math
from types import MappingProxyType
from typing import Annotated, Final, NamedTuple, Self

from pydantic import Field, field_validator, model_validator

from firmware_bridge.node import CAN
from firmware_bridge.robot.table import AxisTable, LinkTable, Medium, Table
from firmware_bridge.units import MILLISECOND, RPM_PER_RAD_S, Nanoseconds

NodeId = Annotated[int, Field(ge=1, le=127)]
Moving = Annotated[int, Field(ge=1, le=0xFFFF_FFFF)]
"""With 0 an axis would never move, or never stop."""
BIT_RATES: Final = (1_000_000, 800_000, 500_000, 250_000, 125_000, 50_000, 20_000)
"""Of the CAN bus (CiA 305), but 10 kbit/s, at which no cycle is carried."""
UNCONFIRMED_CYCLES: Final = 3
"""Cycles of its link without a drive's report, after which a stop counts as not confirmed."""
UNANSWERED_MS: Final = 200
"""Timeout of an object of a silent drive on CAN."""
Confirmation = Annotated[int, Field(ge=10, le=10_000)]


class StopTimes(Table):
    """Longest time of a drive's report of a stop stage, beside the stage's ramp; ms."""

    ramp: Confirmation | None = None
    """None, here and below: three of the link's cycles."""
    quick_stop: Confirmation | None = None
    power_off: Confirmation | None = None
    by_object: Confirmation | None = None
    """For each of the two Controlwords written by object; None: as long as a silent drive keeps the link."""
    silence: Confirmation | None = None
    """After the silence at which the drives stop by themselves, `bridge_silent_ms`."""
    reset: Confirmation = 1_000


class Confirmed(NamedTuple):
    """The same times, all known; nanoseconds."""

    ramp: Nanoseconds
    quick_stop: Nanoseconds
    power_off: Nanoseconds
    by_object: Nanoseconds
    silence: Nanoseconds
    """The drives' patience included."""
    reset: Nanoseconds


class DriveLink(LinkTable):
    """The CAN bus, the bridge's node, and the time-outs; a family adds `driver`."""

    bit_rate: int
    bridge_node: NodeId
    bridge_heartbeat_ms: Annotated[int, Field(ge=10, le=10_000)]
    bridge_silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    """The drives stop by themselves after this silence of the bridge."""
    drive_heartbeat_ms: Annotated[int, Field(ge=10, le=10_000)]
    stop_confirmed_ms: StopTimes = StopTimes()

    @field_validator("bit_rate")
    @classmethod
    def _the_drive_has_the_rate(cls, bit_rate: int) -> int:
        if bit_rate not in BIT_RATES:
            raise ValueError(f"must be one of {', '.join(map(str, BIT_RATES))}")
        return bit_rate

    @model_validator(mode="after")
    def _silence_is_longer_than_the_beat(self) -> Self:
        # A consumer time shorter than the producer's would stop the drives between two beats (0x1016).
        if self.bridge_silent_ms <= self.bridge_heartbeat_ms:
            raise ValueError("bridge_silent_ms must be longer than bridge_heartbeat_ms")
        # Outside the cycle a drive is received by its heartbeat alone.
        if self.silent_ms <= self.drive_heartbeat_ms:
            raise ValueError("silent_ms must be longer than drive_heartbeat_ms")
        return self

    @property
    def medium(self) -> Medium:
        """A CAN bus."""
        return Medium.CAN

    @property
    def kind(self) -> str:
        """CAN frames."""
        return CAN

    @property
    def rate(self) -> int:
        """Bit rate of the port that this machine is on."""
        return self.bit_rate

    @property
    def unanswered_ms(self) -> int:
        """Timeout of an object of a silent drive."""
        return UNANSWERED_MS

    def confirmed(self, cycle: Nanoseconds) -> Confirmed:
        """Return the time for the confirmation of each stop stage; `cycle` is the robot's."""
        times = self.stop_confirmed_ms
        cycles_ms = UNCONFIRMED_CYCLES * self.every * cycle // MILLISECOND
        silent_ms = self.bridge_silent_ms + (times.silence or cycles_ms)
        given = (
            times.ramp or cycles_ms,
            times.quick_stop or cycles_ms,
            times.power_off or cycles_ms,
            times.by_object or self.unanswered_ms,
            silent_ms,
            times.reset,
        )
        return Confirmed(*(time * MILLISECOND for time in given))


class Profile(Table):
    """Motion profile: rpm and rpm/s at the motor, counts of its encoder."""

    velocity_rpm: Moving
    acceleration_rpm_s: Moving
    deceleration_rpm_s: Moving
    quick_stop_rpm_s: Moving
    quick_stop_least_rpm_s: Moving | None = None
    """Down to this the bridge lowers it while driving: each axis of a ratio in proportion to its speed.

    So the drives' own stops keep the ratio. None: it stays as it is. Only on CAN: a serial line is too slow.
    """
    max_velocity_rpm: Annotated[int, Field(ge=1, le=25_000)]
    max_following_error_qc: Moving


BRUSHED: Final = 1
SINUSOIDAL: Final = 10
MOTOR_TYPES: Final = MappingProxyType({BRUSHED: "brushed DC", SINUSOIDAL: "EC, sinusoidal", 11: "EC, block"})
"""Values of 0x6402 (CiA 402-2)."""


class DriveAxis(AxisTable):
    """One drive and its profile; a family adds `device`, motor and encoder."""

    node: NodeId
    profile: Profile
    position_every_ms: Annotated[int, Field(ge=1, le=1_000)] | None = None
    """The drive sends its position on change, at most this often: for an axis whose position leads others.

    None: with each sample only. Only on CAN.
    """
    position_lead_ms: Annotated[int, Field(ge=0, le=1_000)] = 0
    """The axes that it leads are commanded for where it will be so much later: their regulators' lag."""

    @model_validator(mode="after")
    def _the_peak_is_the_peak(self) -> Self:
        if self.peak_current_ma < self.continuous_current_ma:
            raise ValueError("peak_current_ma must not be below continuous_current_ma")
        return self

    @model_validator(mode="after")
    def _the_least_is_not_the_most(self) -> Self:
        least, most = self.profile.quick_stop_least_rpm_s, self.profile.quick_stop_rpm_s
        if least is not None and least > most:
            raise ValueError(f"profile.quick_stop_least_rpm_s = {least} is above quick_stop_rpm_s = {most}")
        return self

    @property
    def counts_per_turn(self) -> int:
        """Counts of position in one turn of the motor's shaft."""
        raise NotImplementedError

    @property
    def speed_per_rpm(self) -> float:
        """Units of the drive's speeds and accelerations for 1 rpm and 1 rpm/s of the motor."""
        return 1.0

    @property
    def number(self) -> int:
        """The number by which the drive is called on its link."""
        return self.node

    @property
    def address(self) -> str:
        """The drive as text."""
        return f"node {self.node}"

    def slowest_ramp(self, ratio: float) -> float:
        """Return the gentlest of its accelerations, behind a gear of `ratio`."""
        profile = self.profile
        gentlest = min(profile.acceleration_rpm_s, profile.deceleration_rpm_s, profile.quick_stop_rpm_s)
        return gentlest / RPM_PER_RAD_S / ratio

    def cruise(self, ratio: float) -> float:
        """Return the speed at which it goes to a position, behind a gear of `ratio`."""
        return min(self.profile.velocity_rpm, self.profile.max_velocity_rpm) / RPM_PER_RAD_S / ratio

    def furthest(self, ratio: float) -> float:
        """Return how far from 0 a travel may go in a counter of 32 bits, with `ratio` rad for each unit.

        The drive's own limits lie further out than the travel, by the following error.
        """
        counted = (1 << 31) - 1 - self.profile.max_following_error_qc
        return counted / self.counts_per_turn * 2.0 * math.pi / ratio

    def profile_rpm(self) -> float:
        """Return the velocity of its profile."""
        return self.profile.velocity_rpm
