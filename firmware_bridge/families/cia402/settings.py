"""CiA 402 drives in a robot file: their CAN bus, one drive, the supply that it measures."""

from enum import StrEnum
from typing import Annotated, ClassVar, Final, Self, TypeAlias

from pydantic import Field, model_validator

from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink, StopTimes
from firmware_bridge.robot.table import Name, Positive, SettingsTable, Table, Unsigned32

BOOT_MS: Final = 3_000
"""Longest time of a drive's start; the slowest one known takes 1.5 s."""
MOST_PER_MILLE: Final = 0xFFFF
"""Of the rated current: 0x6073, the current limit, is UNSIGNED16 (CiA 402-2)."""


class Cia402Driver(StrEnum):
    """The bridge's connection to the drives."""

    CAN = "cia402-can"


class Cia402Link(DriveLink):
    """The CAN bus, the bridge's node, and the time-outs."""

    driver: Annotated[Cia402Driver, Field(strict=False)]
    stop_confirmed_ms: StopTimes = StopTimes(reset=BOOT_MS)


class Cia402Device(StrEnum):
    """The kind of drive."""

    SERVO = "cia402"


class Home(StrEnum):
    """The position at home by 0x607C: the standard reads both ways."""

    NEGATIVE = "negative"
    """-0x607C: zero lies 0x607C beyond home (CiA 402-2)."""
    ITSELF = "itself"
    """0x607C."""


Factor: TypeAlias = Annotated[int, Field(ge=1, le=0xFFFF_FFFF)]


class PositionFactors(Table):
    """Factors of a drive's positions (CiA 402-2), which the set-up writes and reads back."""

    encoder_counts: Factor
    """0x608F:01, edges of the encoder in `encoder_turns`."""
    encoder_turns: Factor = 1
    """0x608F:02, turns of the motor's shaft."""
    gear_motor_turns: Factor = 1
    """0x6091:01, turns of the motor's shaft for `gear_shaft_turns`."""
    gear_shaft_turns: Factor = 1
    """0x6091:02, turns of the driving shaft."""
    feed: Factor
    """0x6092:01, units of position in `feed_turns`."""
    feed_turns: Factor = 1
    """0x6092:02, turns of the driving shaft."""


class Cia402Axis(DriveAxis):
    """One drive, its motor and its encoder; its maker's tool has commissioned and tuned it."""

    device: Annotated[Cia402Device, Field(strict=False)]
    vendor_id: Unsigned32
    """0x1018:01, which `canopen` tools show; so is the next."""
    product_code: Unsigned32
    motor: str
    encoder_counts: Annotated[int, Field(ge=16, le=0x7FFF_FFFF)]
    """Units of 0x6064 in one turn of the motor's shaft: edges of the encoder, where nothing scales them."""
    factors: PositionFactors | None = None
    """What scales the positions; None: what the drive has, which has to give `encoder_counts`."""
    speed_units_per_rpm: Positive = 1.0
    """Units of 0x606C for 1 rpm of the motor, and of 0x6083 for 1 rpm/s."""
    continuous_current_ma: Annotated[int, Field(ge=1, le=0xFFFF_FFFF)]
    """The rated current, 0x6075: the drive's other currents are thousandths of it."""
    peak_current_ma: Annotated[int, Field(ge=1, le=0xFFFF_FFFF)]
    current_object: int = 0x6078
    """The motor's current: 0x6078, or 0x6077, its torque, where the drive has no other."""
    home: Annotated[Home, Field(strict=False)] = Home.NEGATIVE
    tuned_for_kg_m2: Positive | None = None
    """Inertia at the motor's shaft that the maker's tool has tuned the drive for; on the bench alone."""

    @model_validator(mode="after")
    def _the_current_is_one(self) -> Self:
        if self.current_object not in {0x6077, 0x6078}:
            raise ValueError(f"current_object = 0x{self.current_object:04X}: must be 0x6077 or 0x6078")
        return self

    @model_validator(mode="after")
    def _its_peak_fits_its_object(self) -> Self:
        if self.peak_current_ma * 1000 // self.continuous_current_ma > MOST_PER_MILLE:
            most = self.continuous_current_ma * MOST_PER_MILLE // 1000
            raise ValueError(f"peak_current_ma = {self.peak_current_ma}: 0x6073 holds {most} mA at most")
        return self

    @model_validator(mode="after")
    def _its_factors_give_its_counts(self) -> Self:
        factors = self.factors
        if factors is None:
            return self
        units = factors.feed * factors.gear_shaft_turns
        turns = factors.feed_turns * factors.gear_motor_turns
        if units != self.encoder_counts * turns:
            raise ValueError(
                f"encoder_counts = {self.encoder_counts}: by factors a turn of the motor has "
                f"{units / turns:g} units of position"
            )
        return self

    @model_validator(mode="after")
    def _its_ramps_are_units(self) -> Self:
        slowest = min(
            self.profile.velocity_rpm, self.profile.acceleration_rpm_s,
            self.profile.deceleration_rpm_s, self.profile.quick_stop_rpm_s,
        )  # fmt: skip
        if slowest * self.speed_per_rpm < 1.0:
            raise ValueError(f"speed_units_per_rpm = {self.speed_units_per_rpm:g}: a ramp is below 1 unit")
        return self

    @property
    def counts_per_turn(self) -> int:
        """Counts of position in one turn of the motor's shaft."""
        return self.encoder_counts

    @property
    def speed_per_rpm(self) -> float:
        """Units of the drive's speeds and accelerations for 1 rpm and 1 rpm/s of the motor."""
        return self.speed_units_per_rpm


class Measured(StrEnum):
    """What a drive measures beside its axis."""

    SUPPLY = "supply"
    """The voltage of its DC link, 0x6079."""


class Cia402Supply(SettingsTable):
    """The voltage that a drive measures at its supply, 0x6079."""

    VOLTAGE: ClassVar[bool] = True

    axis: Name
    measures: Annotated[Measured, Field(strict=False)]
