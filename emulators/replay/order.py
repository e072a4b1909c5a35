"""What is to be played into what, and how it is compared."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from firmware_bridge.intent import ConfirmZero
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds


class Into(StrEnum):
    """What a recording is played into."""

    DRIVES = "drives"
    """The emulated drives above the plant hear what everybody else has sent on the CAN bus."""
    BRIDGE = "bridge"
    """The bridge hears what everybody else has sent on the CAN bus, and the operator's messages."""
    BENCH = "bench"
    """The bridge, with the emulated drives, hears the operator's messages."""


@dataclass(frozen=True, slots=True)
class Order:
    """One replay."""

    robot: AnyRobot
    recording: Path
    """A CAN log; for the bench a telemetry log."""
    operator: Path | None = None
    """The telemetry log beside a CAN log."""
    into: Into | None = None
    """None: what suits the files."""
    channel: str | None = None
    """Of a CAN log that holds several."""
    until: Nanoseconds | None = None
    """Leave out what was recorded later, counted from the start of the recording."""
    tolerance: Nanoseconds = 0
    """So far may a frame's instant be from the recorded one."""
    without: frozenset[str] = frozenset()
    """Services that are not compared, by the names of `dissector.canopen.service_name`."""
    plant: Path | None = None
    """Another plant below the drives."""
    stands: tuple[ConfirmZero, ...] = ()
    """What the bridge was told at its start of where its axes stand."""
    mode: str = ""
    """The mode after a failed actuator in which it began."""

    @property
    def link(self) -> str:
        """The link on whose bus the CAN log was recorded: the channel's where that is one, else the first."""
        links = self.robot.links
        return self.channel if self.channel in links else next(iter(links))
