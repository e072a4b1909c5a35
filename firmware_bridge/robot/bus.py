"""The drives' bus and the bridge's way to it, as a robot file tells them."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from firmware_bridge.wire.maxon.frame import Generation

NodeId = Annotated[int, Field(ge=1, le=127)]


class Table(BaseModel):
    """A table of a robot file: no unknown key, no value of another kind, nothing changed later."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, str_strip_whitespace=True)


class Link(StrEnum):
    """How the bridge reaches the drives."""

    CAN = "can"
    SERIAL = "serial"
    """Over the serial port of one drive, the gateway, which passes commands on over CAN."""


class Bus(Table):
    """The CAN bus, the bridge's way to it, and the time-outs."""

    link: Annotated[Link, Field(strict=False)] = Link.CAN
    gateway: NodeId | None = None
    """The drive whose serial port the bridge is on."""
    protocol: Annotated[Generation, Field(strict=False)] = Generation.V2
    """What that port speaks: v1 as on RS232, v2 as on USB."""
    baud: Annotated[int, Field(ge=9_600, le=1_000_000)] | None = None
    """Of that port; None for the protocol's default."""
    port_latency_us: Annotated[int, Field(ge=0, le=20_000)] = 1_000
    """How long this machine's port may keep what it has heard: the latency timer of a converter on USB."""
    bit_rate: Annotated[int, Field(ge=10_000, le=1_000_000)]
    cycle_ms: Annotated[int, Field(ge=5, le=1000)]
    bridge_node: NodeId
    bridge_heartbeat_ms: Annotated[int, Field(ge=10, le=10_000)]
    bridge_silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    drive_heartbeat_ms: Annotated[int, Field(ge=10, le=10_000)]
    drive_silent_ms: Annotated[int, Field(ge=10, le=10_000)]

    @model_validator(mode="after")
    def _silence_is_longer_than_the_beat(self) -> Self:
        if self.bridge_silent_ms <= self.bridge_heartbeat_ms:
            raise ValueError("bridge_silent_ms must be longer than bridge_heartbeat_ms")
        if self.drive_silent_ms <= max(self.drive_heartbeat_ms, self.cycle_ms):
            raise ValueError("drive_silent_ms must be longer than drive_heartbeat_ms and cycle_ms")
        return self

    @model_validator(mode="after")
    def _a_serial_link_has_a_gateway(self) -> Self:
        if self.link is Link.SERIAL and self.gateway is None:
            raise ValueError("link = 'serial' needs gateway, the node of the drive with the serial port")
        return self

    @property
    def line_rate(self) -> int:
        """The serial port's rate in bits a second: RS232 at 115.2 kBd, USB's converter at 1 MBd."""
        return self.baud or (115_200 if self.protocol is Generation.V1 else 1_000_000)
