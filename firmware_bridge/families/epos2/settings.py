"""EPOS2 drives in a robot file: their bus or serial line, one drive, its analog inputs, its outputs."""

import math
from collections.abc import Sequence
from enum import StrEnum
from types import MappingProxyType
from typing import Annotated, ClassVar, Final, NamedTuple, Self

from pydantic import Field, field_validator, model_validator

from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.wire.hardware import too_fast
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.robot.table import (
    AxisTable,
    HasAxes,
    LinkTable,
    Medium,
    Name,
    Positive,
    SettingsTable,
    Signed16,
    Table,
    Unsigned16,
    Unsigned32,
)
from firmware_bridge.units import MILLISECOND, QUADCOUNTS_PER_LINE, RPM_PER_RAD_S, Nanoseconds

NodeId = Annotated[int, Field(ge=1, le=127)]
Moving = Annotated[int, Field(ge=1, le=0xFFFF_FFFF)]
"""With 0 an axis would never move, or never stop."""
BIT_RATES: Final = (1_000_000, 800_000, 500_000, 250_000, 125_000, 50_000, 20_000)
"""Of the CAN bus; what the drive's 0x2001 can name."""


class Epos2Driver(StrEnum):
    """The bridge's connection to the drives."""

    CAN = "epos2-can"
    SERIAL = "epos2-serial"
    """Over the serial port of one drive, the gateway, which passes commands on over CAN."""


UNCONFIRMED_CYCLES: Final = 3
"""Cycles of its link without a drive's report, after which a stop counts as not confirmed."""
UNANSWERED_MS: Final = {Epos2Driver.CAN: 200, Epos2Driver.SERIAL: 700}
"""Timeout of an object of a silent drive; over serial it includes the gateway's own."""


class Epos2Device(StrEnum):
    """The type of a drive, as maxon names it behind the word EPOS2: supply in V, continuous current in A."""

    EPOS2_24_2 = "24/2"
    EPOS2_24_5 = "24/5"
    MODULE_36_2 = "36/2"
    EPOS2_50_5 = "50/5"
    EPOS2_70_10 = "70/10"

    @property
    def supply_v(self) -> int:
        """Its highest supply voltage, by the type's name."""
        return int(self.value.partition("/")[0])

    @property
    def continuous_ma(self) -> int:
        """The current that it can supply continuously, by the type's name."""
        return 1000 * int(self.value.partition("/")[2])

    @property
    def peak_ma(self) -> int:
        """Most that 0x6410:02 takes: by its EDS for 70/10; for others twice the continuous one, assumed."""
        return 25_000 if self is Epos2Device.EPOS2_70_10 else 2 * self.continuous_ma


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


class Epos2Link(LinkTable):
    """The CAN bus, the bridge's way to it, and the time-outs."""

    driver: Annotated[Epos2Driver, Field(strict=False)]
    gateway: NodeId | None = None
    """The drive whose serial port the bridge is on."""
    protocol: Annotated[Generation, Field(strict=False)] = Generation.V2
    """Protocol of that port: v1 as on RS232, v2 as on USB."""
    baud: Annotated[int, Field(ge=9_600, le=1_000_000)] | None = None
    """Of that port; None for the protocol's default."""
    port_latency_us: Annotated[int, Field(ge=0, le=20_000)] = 1_000
    """Longest time that this machine's port may keep received bytes: the latency timer of a USB converter."""
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

    @model_validator(mode="after")
    def _a_serial_link_has_a_gateway(self) -> Self:
        if self.driver is Epos2Driver.SERIAL and self.gateway is None:
            raise ValueError("driver = 'epos2-serial' needs gateway, the node of the drive with the port")
        return self

    @property
    def medium(self) -> Medium:
        """A CAN bus, or the serial port of the gateway."""
        return Medium.SERIAL if self.driver is Epos2Driver.SERIAL else Medium.CAN

    @property
    def kind(self) -> str:
        """CAN frames, or maxon's protocol on a line."""
        return SERIAL if self.driver is Epos2Driver.SERIAL else CAN

    @property
    def rate(self) -> int:
        """Bit rate of the port that this machine is on."""
        return self.line_rate if self.driver is Epos2Driver.SERIAL else self.bit_rate

    @property
    def line_rate(self) -> int:
        """The serial port's rate in bits a second: RS232 at 115.2 kBd, USB's converter at 1 MBd."""
        return self.baud or (115_200 if self.protocol is Generation.V1 else 1_000_000)

    @property
    def latency_us(self) -> int:
        """Longest time that this machine's port may keep received bytes."""
        return self.port_latency_us

    @property
    def described(self) -> str:
        """Protocol and rate of the port, and its drive; empty for a bus."""
        if self.driver is not Epos2Driver.SERIAL:
            return ""
        return f"({self.protocol.value}, {self.line_rate} Bd), node {self.gateway} passes on to the others"

    @property
    def silent_hint(self) -> str:
        """The other protocol."""
        other = next(one.value for one in Generation if one is not self.protocol)
        return (
            f"nothing was received on the line, which was tried in {self.protocol.value} at {self.line_rate} "
            f"Bd: is the drive on, and is it not {other} (--protocol {other})?"
        )

    def confirmed(self, cycle: Nanoseconds) -> Confirmed:
        """Return the time for the confirmation of each stop stage; `cycle` is the robot's."""
        times = self.stop_confirmed_ms
        cycles_ms = UNCONFIRMED_CYCLES * self.every * cycle // MILLISECOND
        silent_ms = self.bridge_silent_ms + (times.silence or cycles_ms)
        given = (
            times.ramp or cycles_ms,
            times.quick_stop or cycles_ms,
            times.power_off or cycles_ms,
            times.by_object or UNANSWERED_MS[self.driver],
            silent_ms,
            times.reset,
        )
        return Confirmed(*(time * MILLISECOND for time in given))

    def guardian(self, nodes: Sequence[int]) -> int:
        """Return the node on a serial link whose answers to node guarding the gateway watches."""
        return next(node for node in nodes if node != self.gateway)

    def watched_by(self, node: int, nodes: Sequence[int]) -> int:
        """Return the node whose silence stops this drive.

        That is the bridge; but the gateway does not receive its own CAN frames for the bridge, so it watches
        another drive, which sends only on the bridge's request.
        """
        through = self.driver is Epos2Driver.SERIAL and node == self.gateway
        return self.guardian(nodes) if through else self.bridge_node

    def over_serial(self, gateway: int, protocol: Generation | None, baud: int | None) -> Self:
        """Return this bus as it is reached over the serial port of the drive `gateway`."""
        settings = {
            "driver": Epos2Driver.SERIAL,
            "gateway": gateway,
            "protocol": protocol or self.protocol,
            # Another protocol brings its own default rate, unless one is given.
            "baud": baud if protocol or baud else self.baud,
        }
        return self.model_validate(self.model_dump() | settings)


class Gains(Table):
    """Regulator gains as the drive's raw integers (EPOS2 objects 0x60F6, 0x60F9, 0x60FB)."""

    current_p: Signed16
    current_i: Signed16
    velocity_p: Signed16
    velocity_i: Signed16
    velocity_feedforward: Unsigned16 = 0
    acceleration_feedforward: Unsigned16 = 0
    position_p: Signed16
    position_i: Signed16
    position_d: Signed16
    position_velocity_feedforward: Unsigned16 = 0
    position_acceleration_feedforward: Unsigned16 = 0


class Profile(Table):
    """Motion profile in the drive's units: rpm and rpm/s at the motor, quadcounts."""

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
"""Values of 0x6402 (EPOS2 firmware specification)."""


class Epos2Axis(AxisTable):
    """One drive, its motor and its encoder."""

    node: NodeId
    device: Annotated[Epos2Device, Field(strict=False)]
    product_code: Unsigned32
    motor: str
    encoder_lines: Annotated[int, Field(ge=16, le=2_500_000)]
    motor_type: Unsigned16
    pole_pairs: Annotated[int, Field(ge=1, le=255)] | None = None
    """Of an EC motor, for 0x6410:3; None: the drive keeps what it has."""
    continuous_current_ma: Unsigned16
    peak_current_ma: Unsigned16
    thermal_time_constant_100ms: Annotated[int, Field(ge=1, le=5400)]
    profile: Profile
    gains: Gains
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

    @field_validator("motor_type")
    @classmethod
    def _is_known(cls, motor_type: int) -> int:
        if motor_type not in MOTOR_TYPES:
            known = ", ".join(f"{number} ({what})" for number, what in MOTOR_TYPES.items())
            raise ValueError(f"0x6402 knows {known}")
        return motor_type

    @model_validator(mode="after")
    def _brushes_have_no_poles(self) -> Self:
        if self.motor_type == BRUSHED and self.pole_pairs is not None:
            raise ValueError(f"pole_pairs = {self.pole_pairs}: motor_type {BRUSHED} is brushed, and has none")
        return self

    @model_validator(mode="after")
    def _the_least_is_not_the_most(self) -> Self:
        least, most = self.profile.quick_stop_least_rpm_s, self.profile.quick_stop_rpm_s
        if least is not None and least > most:
            raise ValueError(f"profile.quick_stop_least_rpm_s = {least} is above quick_stop_rpm_s = {most}")
        return self

    @model_validator(mode="after")
    def _its_encoder_is_counted(self) -> Self:
        if why := too_fast(self.encoder_lines, self.profile.max_velocity_rpm):
            raise ValueError(f"encoder_lines and max_velocity_rpm: {why}")
        return self

    @model_validator(mode="after")
    def _the_drive_gives_it(self) -> Self:
        for key, value, most in (
            ("continuous_current_ma", self.continuous_current_ma, self.device.continuous_ma),
            ("peak_current_ma", self.peak_current_ma, self.device.peak_ma),
        ):
            if value > most:
                raise ValueError(f"{key} = {value}: an EPOS2 {self.device} takes {most} at most")
        return self

    @property
    def number(self) -> int:
        """The number by which the drive is called on its link."""
        return self.node

    @property
    def address(self) -> str:
        """The drive as text."""
        return f"node {self.node}"

    @property
    def quadcounts_per_turn(self) -> int:
        """Quadcounts in one turn of the motor's shaft."""
        return QUADCOUNTS_PER_LINE * self.encoder_lines

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
        return counted / self.quadcounts_per_turn * 2.0 * math.pi / ratio

    def profile_rpm(self) -> float:
        """Return the velocity of its profile."""
        return self.profile.velocity_rpm


class Epos2AnalogueInput(SettingsTable):
    """A sensor behind an analog input of one drive (0x207C)."""

    VOLTAGE: ClassVar[bool] = True

    axis: Name
    input: Annotated[int, Field(ge=1, le=2)]
    per_volt: Positive
    """The sensor's value for each volt at the input."""


class Epos2DigitalOutput(SettingsTable):
    """A device behind a digital output of one drive, switched as a general purpose output (0x2078)."""

    axis: Name
    output: Annotated[int, Field(ge=1, le=4)]


def nodes_on(robot: HasAxes, link: str) -> tuple[int, ...]:
    """Return the nodes of a robot's drives on a link."""
    return tuple(Epos2Axis.of(axis).node for axis in robot.axes_on(link))
