"""The robot among the captured bodies; a `firmware_bridge.drivers.driver.SensorDriver`.

It turns the stream's axes into the robot's plane: x, y and, upwards, z. It reports nothing while the body is
not tracked, and counts its jumps; the plausibility of a pose is judged with odometry.
"""

import math
from enum import Enum
from typing import Final

from firmware_bridge.drivers.driver import Reading, SeenPose
from firmware_bridge.families.motion_capture.settings import CaptureBody, UpAxis
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Sensor
from firmware_bridge.units import Nanoseconds, to_seconds

Point = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
_TURNED: Final = 0.5
"""A quaternion shorter than this is none: 0 is sent for a body that is lost."""


class Sighting(Enum):
    """State of the body in the newest frame."""

    UNKNOWN = "no frame was received"
    ABSENT = "the stream has no such body"
    LOST = "the body is not tracked"
    SEEN = "the body is tracked"


class SeenBody:
    """One body, frame by frame."""

    def __init__(self, sensor: Sensor, settings: CaptureBody) -> None:
        self.sensor: Final = sensor
        self.settings: Final = settings
        self.sighting = Sighting.UNKNOWN
        self.jumps = 0
        self._last: tuple[Nanoseconds, Point, float] | None = None
        """Time and position of its last sighting."""
        self._newest: tuple[float, Nanoseconds, Nanoseconds, Point, Quaternion, float] | None = None
        """Source of `reading`, made on request: error, instants, position, attitude, heading."""
        self._reading: Reading | None = None
        half, mount = -settings.mount.heading / 2.0, settings.mount
        self._turn: Final = (0.0, 0.0, math.sin(half), math.cos(half))
        self._mount: Final = (mount.x, mount.y, mount.z)

    @property
    def reading(self) -> Reading | None:
        """The pose in the newest frame; None where the body was not tracked in it."""
        if self._reading is None and self._newest is not None:
            error_m, at, received_at, position, attitude, heading = self._newest
            self._reading = Reading(
                error_m, at, received_at, SeenPose(position, attitude, heading, self.jumps)
            )
        return self._reading

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing: it is received without a request."""
        del now
        return ()

    def missed(self, sighting: Sighting) -> None:
        """Note that the newest frame does not show the body."""
        self.sighting, self._newest, self._reading = sighting, None, None

    def seen(
        self,
        position: Point,
        attitude: Quaternion,
        error_m: float,
        at: Nanoseconds,
        received_at: Nanoseconds,
    ) -> None:
        """Take a pose in the stream's axes, m and x, y, z, w, and the instant that it shows.

        What is no pose counts as not tracked.
        """
        x, y, z, w = attitude
        length = math.sqrt(x * x + y * y + z * z + w * w)
        # Written so that NaN is no pose, too.
        if not (length > _TURNED and math.isfinite(length) and math.isfinite(sum(position))):
            self.missed(Sighting.LOST)
            return
        # Rounding on the way makes it a little longer or shorter than 1.
        x, y, z, w = x / length, y / length, z / length, w / length
        if self.settings.up is UpAxis.Y:
            # From y upwards to z upwards: a quarter turn about x, of the place and of the vector part.
            position = (position[0], -position[2], position[1])
            y, z = -z, y
        place, turned = self._robot(position, (x, y, z, w))
        heading = heading_of(turned)
        self._watch(place, heading, at)
        self.sighting = Sighting.SEEN
        self._newest, self._reading = (error_m, at, received_at, place, turned, heading), None

    def _robot(self, position: Point, attitude: Quaternion) -> tuple[Point, Quaternion]:
        """Return where the robot is whose mounted body is there."""
        turned = product(attitude, self._turn)
        # The body is mounted beside the robot's point, so the turned lever is taken off.
        x, y, z = rotated(turned, self._mount)
        return (position[0] - x, position[1] - y, position[2] - z), turned

    def _watch(self, position: Point, heading: float, at: Nanoseconds) -> None:
        """Count a jump: further than the robot gets in the time since it was seen."""
        if self._last is not None:
            since, before, was = self._last
            # Datagrams may overtake one another.
            seconds, allowed = max(to_seconds(at - since), 0.0), self.settings
            far = math.dist(position, before) > allowed.noise_m + allowed.fastest_mps * seconds
            turn = abs(math.remainder(heading - was, math.tau))
            if far or turn > allowed.noise_rad + allowed.fastest_rad_s * seconds:
                self.jumps += 1
        self._last = (at, position, heading)


def heading_of(attitude: Quaternion) -> float:
    """Return the turn to the left about the axis upwards, from x; rad from -pi to pi."""
    x, y, z, w = attitude
    # Yaw of a quaternion; only the turn about the vertical counts on a plane.
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the turn `second`, about the body's own axes, after the turn `first`."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(attitude: Quaternion, point: Point) -> Point:
    """Return a vector of the body's axes in the room's."""
    x, y, z, w = attitude
    px, py, pz = point
    tx, ty, tz = 2.0 * (y * pz - z * py), 2.0 * (z * px - x * pz), 2.0 * (x * py - y * px)
    return (
        px + w * tx + y * tz - z * ty,
        py + w * ty + z * tx - x * tz,
        pz + w * tz + x * ty - y * tx,
    )
