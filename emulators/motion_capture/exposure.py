"""The cameras' view of the truth at one instant: noise, bodies that are hidden, markers mistaken.

It does not know a frame's departure and its clients. It draws random numbers for every body in every frame,
seen or not, so that a disturbance changes nothing but its own effect.

Sources: OptiTrack's page on rigid body tracking and reports of its users for what a lost body looks like;
0.2 mm is a calibrated volume's usual error. Where they are silent:
* errors are normal, the same along all axes, and of each frame again.
* the attitude's error is the position's over an arm of 0.15 m.
* a body whose markers are mistaken stays tracked, with the mean error that it had.
* a body that is lost has a mean error of 0.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Final

from emulators.motion_capture.bodies import Attitude, TrackedBody, product, turned
from firmware_bridge.families.motion_capture.wire.frame import (
    BodyFlag,
    LabeledMarker,
    MarkerFlag,
    Point,
    Quaternion,
    RigidBody,
)
from firmware_bridge.units import NEVER, Nanoseconds

ARM_M: Final = 0.15
NORMALS: Final = 6
"""Errors of a body in a frame: along three axes, and about them."""
MARKER_M: Final = 0.014
"""A marker's diameter."""
_NAN: Final = math.nan


class Lost(Enum):
    """Values sent for a body that is not seen; its flag reports that in any case."""

    FREEZE = "freeze"
    """The last pose that was seen."""
    ZERO = "zero"
    NAN = "nan"


class Up(Enum):
    """Axis of the stream that points upwards; the stream itself does not report it."""

    Y = "y"
    """Motive's default: the room's (x, y, z) goes out as (x, z, -y)."""
    Z = "z"


@dataclass(frozen=True, slots=True)
class Cameras:
    """Errors of the cameras, and settings of the software."""

    noise_m: float = 0.0002
    """The standard deviation of a body's position along each axis."""
    lost: Lost = Lost.FREEZE
    up: Up = Up.Y
    markers: bool = True
    """True if the stream has the labeled markers, too."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """A body is not seen from `begin` until `end`."""

    body: int
    begin: Nanoseconds
    end: Nanoseconds = NEVER


@dataclass(frozen=True, slots=True)
class Swapped:
    """Markers are taken for others from `begin` until `end`: the body jumps, and counts as tracked.

    It is seen `aside` of its place, in its own axes, and turned to the left by `turn` rad.
    """

    body: int
    begin: Nanoseconds
    end: Nanoseconds = NEVER
    aside: Point = (0.0, 0.0, 0.0)
    turn: float = math.pi


@dataclass(frozen=True, slots=True)
class Shaken:
    """A body trembles from `begin` until `end`: it is seen so much less exactly, m along each axis."""

    body: int
    begin: Nanoseconds
    end: Nanoseconds = NEVER
    noise_m: float = 0.001


@dataclass(slots=True)
class Exposure:
    """The room, seen again and again."""

    bodies: Sequence[TrackedBody]
    cameras: Cameras
    disturbances: list[Hidden | Swapped | Shaken] = field(default_factory=list)
    _last: dict[int, Attitude] = field(default_factory=dict)
    """Last seen pose of each body."""

    def bodies_at(
        self, now: Nanoseconds, normals: Sequence[float]
    ) -> tuple[tuple[RigidBody, ...], tuple[LabeledMarker, ...]]:
        """Return the bodies, and the markers on them, as the stream has them.

        `normals` are numbers of mean 0 and standard deviation 1, `NORMALS` for each body.
        """
        bodies: list[RigidBody] = []
        markers: list[LabeledMarker] = []
        for number, body in enumerate(self.bodies):
            errors = normals[NORMALS * number : NORMALS * number + NORMALS]
            # Also for a hidden body: truth and chance go on as if it were seen.
            seen = self._noisy(self._swapped(body, now), self._noise(body.id, now), errors)
            if self._hidden(body.id, now):
                # A lost body stays in the frame: a client that
                # ignores its flag sees it frozen, at 0, or as NaN.
                place, error, params = self._lost(body.id), 0.0, 0
            else:
                place, error, params = seen, self.cameras.noise_m, BodyFlag.TRACKED
                self._last[body.id] = seen
            outside = self._outside(place)
            bodies.append(RigidBody(body.id, outside.position, outside.attitude, error, params))
            if self.cameras.markers:
                markers += self._markers(body, place, tracked=params != 0)
        return tuple(bodies), tuple(markers)

    def _hidden(self, body: int, now: Nanoseconds) -> bool:
        for one in self.disturbances:
            if isinstance(one, Hidden) and one.body == body and one.begin <= now < one.end:
                return True
        return False

    def _swapped(self, body: TrackedBody, now: Nanoseconds) -> Attitude:
        place = body.truth(now)
        for one in self.disturbances:
            if isinstance(one, Swapped) and one.body == body.id and one.begin <= now < one.end:
                position = _moved(place.position, turned(place.attitude, one.aside))
                turn = (0.0, 0.0, math.sin(one.turn / 2.0), math.cos(one.turn / 2.0))
                place = Attitude(position, product(place.attitude, turn))
        return place

    def _noise(self, body: int, now: Nanoseconds) -> float:
        shaken = (
            one.noise_m
            for one in self.disturbances
            if isinstance(one, Shaken) and one.body == body and one.begin <= now < one.end
        )
        # Independent errors add as squares.
        return math.hypot(self.cameras.noise_m, *shaken)

    @staticmethod
    def _noisy(place: Attitude, noise: float, errors: Sequence[float]) -> Attitude:
        x, y, z, roll, pitch, yaw = errors
        # A small turn's quaternion has half its angle in the vector part.
        half = 0.5 * noise / ARM_M
        position = _moved(place.position, (x * noise, y * noise, z * noise))
        return Attitude(
            position, _unit(product(place.attitude, (roll * half, pitch * half, yaw * half, 1.0)))
        )

    def _lost(self, body: int) -> Attitude:
        if self.cameras.lost is Lost.NAN:
            return Attitude((_NAN, _NAN, _NAN), (_NAN, _NAN, _NAN, _NAN))
        nothing = Attitude((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
        return nothing if self.cameras.lost is Lost.ZERO else self._last.get(body, nothing)

    def outside(self, point: Point) -> Point:
        """Return a point, or a vector, in the stream's axes."""
        return point if self.cameras.up is Up.Z else (point[0], point[2], -point[1])

    def _outside(self, place: Attitude) -> Attitude:
        # Other axes turn the vector part as any vector; the real part stays.
        qx, qy, qz, qw = place.attitude
        return Attitude(self.outside(place.position), (*self.outside((qx, qy, qz)), qw))

    def _markers(self, body: TrackedBody, place: Attitude, *, tracked: bool) -> Iterable[LabeledMarker]:
        seen = MarkerFlag.POINT_CLOUD if tracked else MarkerFlag.OCCLUDED | MarkerFlag.POINT_CLOUD
        for number, marker in enumerate(body.markers, 1):
            position = self.outside(_moved(place.position, turned(place.attitude, marker)))
            yield LabeledMarker(
                # Motive's identifier of a marker: the body in the high word, the marker in the low one.
                body.id << 16 | number,
                position,
                MARKER_M,
                MarkerFlag.HAS_MODEL | seen,
                self.cameras.noise_m if tracked else 0.0,
            )


def _moved(position: Point, by: Point) -> Point:
    return (position[0] + by[0], position[1] + by[1], position[2] + by[2])


def _unit(attitude: Quaternion) -> Quaternion:
    x, y, z, w = attitude
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return (x / length, y / length, z / length, w / length)
