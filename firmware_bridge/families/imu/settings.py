"""An IMU in a robot file: its line, its mounting, and the quantities that are read as sensors."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from firmware_bridge.robot.table import Finite, LinkTable, Medium, SettingsTable, Table
from firmware_bridge.units import MILLISECOND, Nanoseconds

Degrees = Annotated[float, Field(ge=-180, le=180)]


class ImuDriver(StrEnum):
    """The protocol of the line."""

    SERIAL = "imu-serial"


class Mounted(Table):
    """Rotation of the sensor on the robot, deg, right-handed about the robot's axes: first x, then y, then z.

    The robot's axes are x ahead, y to the left, z upwards. All 0: the sensor's axes are the robot's.
    """

    about_x_deg: Degrees = 0.0
    about_y_deg: Degrees = 0.0
    about_z_deg: Degrees = 0.0


class ImuLink(LinkTable):
    """The serial line to an IMU, on which the bridge only listens."""

    driver: Annotated[ImuDriver, Field(strict=False)]
    silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    """After this silence there are no readings, and the filter begins again."""
    baud: Annotated[int, Field(ge=38_400, le=1_000_000)] = 115_200
    """Bit rate, bit/s; 100 frames a second need 22,000."""
    port_latency_us: Annotated[int, Field(ge=0, le=20_000)] = 1_000
    """Longest time that this machine's port may keep received bytes."""
    latency_ms: Annotated[float, Field(ge=0, le=100)] = 7.0
    """Age of a sample when its frame is in: the device's filter 5 ms, the bytes 2 ms; assumed."""
    time_constant_s: Annotated[float, Field(ge=1, le=600)] = 20.0
    """So slowly pitch and roll follow the accelerometer; faster they follow the gyro. Assumed."""
    mounted: Mounted = Mounted()
    stops: Annotated[tuple[str, ...] | None, Field(strict=False)] = ()
    """The groups that stop when the line is unplugged; by default none, as the IMU moves nothing."""

    @property
    def medium(self) -> Medium:
        """A serial line."""
        return Medium.SERIAL

    @property
    def rate(self) -> int:
        """Bit rate, bit/s."""
        return self.baud

    @property
    def latency_us(self) -> int:
        """Longest time that this machine's port may keep received bytes."""
        return self.port_latency_us

    @property
    def described(self) -> str:
        """The protocol."""
        return self.driver.value

    @property
    def silent_hint(self) -> str:
        """Power, port and rate of the device."""
        return f"nothing was received on the line at {self.rate} Bd: is the IMU on, and is it this port?"

    @property
    def latency(self) -> Nanoseconds:
        """Age of a sample when its frame is in."""
        return round(self.latency_ms * MILLISECOND)


class Quantity(StrEnum):
    """Quantities of the robot's body, in its axes: x ahead, y to the left, z upwards."""

    PITCH = "pitch"
    """Nose up positive, from the horizontal, rad."""
    ROLL = "roll"
    """Left side up positive, from the horizontal, rad."""
    ACCELERATION_X = "acceleration_x"
    """Specific force, m/s2: at rest and level z has +9.81, as an accelerometer has it."""
    ACCELERATION_Y = "acceleration_y"
    ACCELERATION_Z = "acceleration_z"
    RATE_X = "rate_x"
    """Rate about the axis, right-handed, rad/s: about y the nose goes down."""
    RATE_Y = "rate_y"
    RATE_Z = "rate_z"


class ImuSensor(SettingsTable):
    """One quantity of an IMU."""

    quantity: Annotated[Quantity, Field(strict=False)]
    """Pitch (nose up positive) and roll (left side up positive) in rad from the horizontal; specific force in
    m/s2 along, rates in rad/s about the robot's axes."""
    bias: Finite = 0.0
    """Subtracted from the value, in its unit."""
