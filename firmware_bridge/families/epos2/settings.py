"""EPOS2 drives in a robot file: their bus or serial line, one drive, its analog inputs, its outputs."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Annotated, ClassVar, Final, Self

from pydantic import Field, field_validator, model_validator

from firmware_bridge.canopen_drive.settings import (
    BRUSHED,
    MOTOR_TYPES,
    DriveAxis,
    DriveLink,
    NodeId,
)
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.wire.hardware import too_fast
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.robot.table import (
    HasAxes,
    Medium,
    Name,
    Positive,
    SettingsTable,
    Signed16,
    Table,
    Unsigned16,
    Unsigned32,
)
from firmware_bridge.units import QUADCOUNTS_PER_LINE


class Epos2Driver(StrEnum):
    """The bridge's connection to the drives."""

    CAN = "epos2-can"
    SERIAL = "epos2-serial"
    """Over the serial port of one drive, the gateway, which passes commands on over CAN."""


UNANSWERED_MS: Final = 700
"""Timeout of an object of a silent drive over serial, the gateway's own included."""


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


class Epos2Link(DriveLink):
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

    @property
    def unanswered_ms(self) -> int:
        """Timeout of an object of a silent drive."""
        return UNANSWERED_MS if self.driver is Epos2Driver.SERIAL else super().unanswered_ms

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


class Epos2Axis(DriveAxis):
    """One drive, its motor and its encoder."""

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
    gains: Gains

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
    def counts_per_turn(self) -> int:
        """Quadcounts in one turn of the motor's shaft."""
        return QUADCOUNTS_PER_LINE * self.encoder_lines


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
