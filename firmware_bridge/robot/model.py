"""A robot as a checked table: geometry, limits, bus and axes, read by the bridge and by the emulators alike.

It refuses to know where the table came from.
"""

import math
from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator

from firmware_bridge.robot.bus import Bus, Link, NodeId, Table
from firmware_bridge.units import QUADCOUNTS_PER_LINE, STANDARD_GRAVITY
from firmware_bridge.wire.maxon.frame import Generation

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Unsigned16 = Annotated[int, Field(ge=0, le=0xFFFF)]
Signed16 = Annotated[int, Field(ge=-0x8000, le=0x7FFF)]
Unsigned32 = Annotated[int, Field(ge=0, le=0xFFFF_FFFF)]


class Role(StrEnum):
    """What an axis moves."""

    LEFT_WHEEL = "left_wheel"
    RIGHT_WHEEL = "right_wheel"
    STEERING = "steering"
    LIFT = "lift"


class Mode(StrEnum):
    """How a drive is commanded (CiA 402 modes of operation 3 and 1)."""

    VELOCITY = "velocity"
    POSITION = "position"


class Base(Table):
    """Davis-steered platform, lengths in metres (thesis 2.4, Tab. 3.1)."""

    wheel_radius_m: Positive
    rear_track_m: Positive
    wheelbase_m: Positive
    kingpin_distance_m: Positive
    davis_h_m: Positive
    pinion_diameter_m: Positive
    half_support_width_m: Positive
    centre_of_gravity_height_m: Positive

    @property
    def davis_b_m(self) -> float:
        """Half the tie rod's offset, from 2 b / h = a_k / w (2.12)."""
        return self.davis_h_m * self.kingpin_distance_m / (2.0 * self.wheelbase_m)


class Lift(Table):
    """Scissor lift on a screw (thesis 2.5): N stages of equal links, driven along the base."""

    stages: Annotated[int, Field(ge=1, le=20)]
    link_length_m: Positive
    collapsed_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    extended_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    screw_pitch_m: Positive

    @model_validator(mode="after")
    def _extends_upwards(self) -> Self:
        if self.extended_angle_deg <= self.collapsed_angle_deg:
            raise ValueError("extended_angle_deg must be larger than collapsed_angle_deg")
        return self


class Limits(Table):
    """What the interlocks hold, whatever the operator wishes (thesis 2.3.1, 4.2.1)."""

    speed_mps: Positive
    acceleration_g: Positive
    steer_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    turn_radius_m: Positive
    lift_retracted_m: NonNegative
    lift_rate_mps: Positive

    @property
    def acceleration_mps2(self) -> float:
        """The acceleration limit in m/s2."""
        return self.acceleration_g * STANDARD_GRAVITY


class OperatorLink(Table):
    """The operator's link: how long silence is allowed, and the identity on MAVLink."""

    silent_ms: Annotated[int, Field(ge=50, le=10_000)]
    system_id: Annotated[int, Field(ge=1, le=255)]
    component_id: Annotated[int, Field(ge=1, le=255)]


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

    velocity_rpm: Unsigned32
    acceleration_rpm_s: Unsigned32
    deceleration_rpm_s: Unsigned32
    quick_stop_rpm_s: Unsigned32
    max_velocity_rpm: Annotated[int, Field(ge=0, le=25_000)]
    max_following_error_qc: Unsigned32


class Axis(Table):
    """One drive and what hangs on its shaft."""

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
    title: str
    role: Annotated[Role, Field(strict=False)]
    node: NodeId
    mode: Annotated[Mode, Field(strict=False)]
    device: str
    product_code: Unsigned32
    motor: str
    gear_ratio: Positive
    encoder_lines: Annotated[int, Field(ge=16, le=2_500_000)]
    direction: Annotated[int, Field(ge=-1, le=1)]
    motor_type: Unsigned16
    continuous_current_ma: Unsigned16
    peak_current_ma: Unsigned16
    thermal_time_constant_100ms: Annotated[int, Field(ge=1, le=5400)]
    profile: Profile
    gains: Gains

    @model_validator(mode="after")
    def _makes_sense(self) -> Self:
        if self.direction == 0:
            raise ValueError("direction must be 1 or -1")
        if self.peak_current_ma < self.continuous_current_ma:
            raise ValueError("peak_current_ma must not be below continuous_current_ma")
        return self

    @property
    def quadcounts_per_turn(self) -> int:
        """Quadcounts in one turn of the motor's shaft."""
        return QUADCOUNTS_PER_LINE * self.encoder_lines

    @property
    def quadcounts_per_radian(self) -> float:
        """Quadcounts in one radian behind the gear; its sign is the axis's direction."""
        return self.direction * self.quadcounts_per_turn * self.gear_ratio / (2.0 * math.pi)


class Battery(Table):
    """How the battery is measured: an analogue input of one drive, behind a divider."""

    axis: str
    analogue_input: Annotated[int, Field(ge=1, le=2)]
    divider: Positive
    nominal_v: Positive
    low_v: Positive


class PlantFile(Table):
    """The simulated robot: which FMU, which of its named parameter sets, and single values that differ."""

    fmu: str
    parameter_set: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)


class Robot(Table):
    """A whole robot file, checked."""

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
    title: str
    source: str
    bus: Bus
    base: Base
    lift: Lift
    limits: Limits
    operator: OperatorLink
    battery: Battery
    plant: PlantFile
    axes: Annotated[tuple[Axis, ...], Field(min_length=1, strict=False)]

    @model_validator(mode="after")
    def _axes_are_distinct(self) -> Self:
        for key in ("name", "node", "role"):
            seen: dict[object, str] = {}
            for axis in self.axes:
                value = getattr(axis, key)
                if value in seen:
                    raise ValueError(f"{key} {value} is taken by two axes, '{seen[value]}' and '{axis.name}'")
                seen[value] = axis.name
        if self.battery.axis not in {axis.name for axis in self.axes}:
            raise ValueError(f"battery.axis '{self.battery.axis}' is not an axis")
        if self.bus.bridge_node in {axis.node for axis in self.axes}:
            raise ValueError(f"bridge_node {self.bus.bridge_node} is the node of an axis, too")
        return self

    @model_validator(mode="after")
    def _the_gateway_is_watched(self) -> Self:
        if self.bus.link is Link.SERIAL:
            if self.bus.gateway not in {axis.node for axis in self.axes}:
                raise ValueError(f"bus.gateway {self.bus.gateway} is not the node of an axis")
            if len(self.axes) == 1:
                raise ValueError("bus.gateway: a drive without another one behind it watches nobody")
        return self

    def axis(self, role: Role) -> Axis:
        """Return the axis with this role; KeyError where the robot has none."""
        for axis in self.axes:
            if axis.role is role:
                return axis
        raise KeyError(role)

    @property
    def guardian(self) -> int:
        """On a serial link: the node whose answers to node guarding the gateway watches."""
        return next(axis.node for axis in self.axes if axis.node != self.bus.gateway)

    def watched_by(self, axis: Axis) -> int:
        """Return the node whose silence stops this drive.

        That is the bridge; but the gateway does not hear what it sends onto the bus for the bridge, so it
        watches another drive, which speaks only when the bridge asks it.
        """
        through = self.bus.link is Link.SERIAL and axis.node == self.bus.gateway
        return self.guardian if through else self.bus.bridge_node

    def over_serial(self, protocol: Generation | None = None, baud: int | None = None) -> "Robot":
        """Return this robot on its serial link; the gateway is the first drive where the file names none."""
        bus = self.bus
        told = {
            "link": Link.SERIAL,
            "gateway": bus.gateway or self.axes[0].node,
            "protocol": protocol or bus.protocol,
            "baud": baud if protocol or baud else bus.baud,
        }
        return self.model_validate({**self._fields(), "bus": Bus.model_validate(bus.model_dump() | told)})

    def _fields(self) -> dict[str, object]:
        return {name: getattr(self, name) for name in type(self).model_fields}
