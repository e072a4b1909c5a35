"""A motion capture system in a robot file: where its stream comes from, and the robot's body in it."""

from enum import StrEnum
from typing import Annotated, Final, Self

from pydantic import Field, field_validator, model_validator

from firmware_bridge.robot.table import (
    Finite,
    LinkTable,
    Medium,
    OdometryBounds,
    Positive,
    SettingsTable,
    Table,
)
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of

FURTHEST_M: Final = 10.0
"""From a robot to the body that is mounted on it; further is millimeters, or a mistake."""


class CaptureDriver(StrEnum):
    """The source of poses."""

    NATNET = "natnet"
    """From the cameras' software, by its own protocol over UDP."""
    MAVLINK = "mavlink-pose"
    """As VISION_POSITION_ESTIMATE or ODOMETRY, over UDP."""


class UpAxis(StrEnum):
    """The stream's axis that points upwards; a NatNet stream does not report it."""

    Y = "y"
    Z = "z"


def place_number(text: str) -> int:
    """Return the number of a place HOST:PORT, the host an address; ValueError for anything else."""
    # From the right: an address of IP version 6 has colons of its own.
    host, colon, port = text.rpartition(":")
    if not colon or not port.isdecimal():
        raise ValueError("must be HOST:PORT, as 192.168.1.10:1510")
    return number_of(host.strip("[]"), int(port))


class CaptureLink(LinkTable):
    """The way to a capture system."""

    driver: Annotated[CaptureDriver, Field(strict=False)]
    server: str
    """HOST:PORT of the system's command port; with MAVLink the sender of poses. No other host is accepted."""
    listen: str = "0.0.0.0:0"
    """HOST:PORT of this machine for poses; 0, which is any port, needs a server that receives the number."""
    latency_ms: Annotated[float, Field(ge=0, le=1_000)] = 5.4
    """From the exposure until a pose leaves, where the stream has no value: measured on a Motive 2.1."""

    @model_validator(mode="after")
    def _can_be_found(self) -> Self:
        if self.driver is CaptureDriver.MAVLINK and self.listen.endswith(":0"):
            raise ValueError("a sender of MAVLink must know where poses are waited for: give listen a port")
        return self

    @field_validator("server")
    @classmethod
    def _is_a_place(cls, server: str) -> str:
        place_number(server)
        return server

    @property
    def medium(self) -> Medium:
        """Datagrams."""
        return Medium.UDP

    @property
    def place(self) -> str:
        """Where poses are waited for."""
        return self.listen

    @property
    def server_number(self) -> int:
        """The place of `server` as packets have it."""
        return place_number(self.server)

    @property
    def latency(self) -> Nanoseconds:
        """From the exposure until a pose leaves."""
        return round(self.latency_ms * MILLISECOND)


class Mount(Table):
    """Position of the captured body's pivot on the robot, and its axes' rotation to the left; m, rad."""

    x: Finite = 0.0
    y: Finite = 0.0
    z: Finite = 0.0
    heading: Finite = 0.0


class CaptureBody(SettingsTable):
    """The robot among the bodies that are captured."""

    body: Annotated[int, Field(ge=0)] | Annotated[str, Field(min_length=1)]
    """Its number in the stream, or its name; with MAVLink, which knows one body only, any text."""
    up: Annotated[UpAxis, Field(strict=False)] = UpAxis.Y
    mount: Mount = Mount()
    fastest_mps: Positive
    """A body that is elsewhere sooner than so has jumped: its markers were taken for others."""
    fastest_rad_s: Positive
    noise_m: Positive = 0.005
    """So far it may be elsewhere at once."""
    noise_rad: Positive = 0.05
    odometry: OdometryBounds | None = None
    """With it the robot's pose is this body's, carried on by odometry; without, it is only reported."""

    @model_validator(mode="after")
    def _nothing_is_mounted_far_off(self) -> Self:
        if max(abs(self.mount.x), abs(self.mount.y), abs(self.mount.z)) > FURTHEST_M:
            raise ValueError(f"mount is in m, and more than {FURTHEST_M:g} m from the robot")
        return self

    @property
    def locates(self) -> OdometryBounds | None:
        """Odometry's bounds, where the robot's pose is this body's."""
        return self.odometry
