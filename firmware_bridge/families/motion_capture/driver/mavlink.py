"""Poses in MAVLink as a link: received from any sender, with nothing sent to it."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.families.motion_capture.driver.body import SeenBody, Sighting
from firmware_bridge.families.motion_capture.driver.clock import StampClock
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.families.motion_capture.wire.mavlink_pose import MavlinkPose, poses
from firmware_bridge.packet import Packet
from firmware_bridge.units import MICROSECOND, Nanoseconds
from firmware_bridge.wire.internet import same_host


class MavlinkPoses(PlainLink):
    """A link whose loss is none: poses that do not come make readings old, and nothing else."""

    def __init__(self, name: str, table: CaptureLink, bodies: Iterable[SeenBody]) -> None:
        super().__init__(name)
        self._table: Final = table
        self._place: Final = table.server_number
        self._bodies: Final = tuple(bodies)
        self._clock: Final = StampClock()
        self._resets: int | None = None

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take the poses of a datagram; one of another host is left."""
        # Poses of any other host could move the robot where they please.
        if same_host(packet.address, self._place):
            for pose in poses(packet.payload):
                self._take(pose, now)
        return ()

    def _take(self, pose: MavlinkPose, now: Nanoseconds) -> None:
        left = self._clock.left_at(pose.stamp_us * MICROSECOND, now) if pose.stamp_us else now
        # reset_counter changes when the estimator jumps, which is no motion of the robot.
        jumped = self._resets is not None and pose.resets != self._resets
        self._resets = pose.resets
        for one in self._bodies:
            if pose.failed:
                one.missed(Sighting.LOST)
                continue
            one.jumps += jumped
            one.seen(pose.position, pose.attitude, pose.deviation_m, left - self._table.latency, now)
