"""Order of a replay: the recording, its target, and the way of comparison."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds


class Into(StrEnum):
    """Target of a recording."""

    DRIVES = "drives"
    """The emulated drives above the plant receive the CAN frames of all other nodes."""
    BRIDGE = "bridge"
    """The bridge receives the CAN frames of all other nodes, and the operator's messages."""
    BENCH = "bench"
    """The bridge, with the emulated drives, receives the operator's messages."""


@dataclass(frozen=True, slots=True)
class ReplayOrder:
    """One replay."""

    robot: AnyRobot
    recording: Path
    """A CAN log; for the bench a telemetry log."""
    operator: Path | None = None
    """The telemetry log beside a CAN log."""
    into: Into | None = None
    """Target; None: the one that suits the files."""
    channel: str | None = None
    """Channel of a CAN log that holds several."""
    until: Nanoseconds | None = None
    """Leave out what was recorded later, counted from the start of the recording."""
    tolerance: Nanoseconds = 0
    """Tolerance of a frame's instant against the recorded one."""
    without: frozenset[str] = frozenset()
    """Services that are not compared, by the names of `dissector.canopen.service_name`."""
    plant: Path | None = None
    """Another plant below the drives."""
    confirmed: tuple[ConfirmPosition, ...] = ()
    """Axis positions that the bridge received at its start."""
    mode: str = ""
    """The mode after a failed actuator in which it began."""

    @property
    def link(self) -> str:
        """The link on whose bus the CAN log was recorded: the channel's where that is one, else the first."""
        links = self.robot.links
        return self.channel if self.channel in links else next(iter(links))
