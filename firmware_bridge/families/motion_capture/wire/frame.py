"""A frame of data: what the cameras saw at one instant. Positions in meters, quaternions scalar last.

Source: the fields as OptiTrack's own PacketClient and Python client of the NatNet SDK 2.9 to 4.2 read them,
checked against frames that a Motive 2.1 has sent; 2.x, 4.x, skeletons and devices have none behind them.
"""

from dataclasses import dataclass
from enum import IntFlag
from typing import Any, Final, NamedTuple

from firmware_bridge.families.motion_capture.wire.layout import (
    V2_11,
    V3_0,
    V4_0,
    V4_1,
    Columns,
    FieldRow,
    Items,
    NatNetError,
    Number,
    RecordLayout,
    Text,
    Version,
    WhereThereIsRoom,
    decode,
    encode,
)
from firmware_bridge.families.motion_capture.wire.plain import (
    BODY_VALUES,
    MARKER_VALUES,
    Plain,
    plain,
    shown,
)

Point = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""


class BodyFlag(IntFlag):
    """Flags of `RigidBody.params`."""

    TRACKED = 1
    """The pose is of this frame. Without it the pose is the last one, zeros or no number, by the server."""


class MarkerFlag(IntFlag):
    """Flags of `LabeledMarker.params`."""

    OCCLUDED = 1
    POINT_CLOUD = 2
    MODEL_FILLED = 4
    HAS_MODEL = 8
    UNLABELED = 16
    ACTIVE = 32


class FrameFlag(IntFlag):
    """Flags of `Frame.params`."""

    RECORDING = 1
    MODELS_CHANGED = 2
    EDIT_MODE = 4
    VERSION_CHANGED = 8


@dataclass(frozen=True, slots=True)
class MarkerSet:
    """Markers under one name; the set "all" has those of every asset."""

    name: str
    markers: tuple[Point, ...] = ()


@dataclass(frozen=True, slots=True)
class BodyMarker:
    """A marker of a rigid body, as it came with the body before 3.0."""

    position: Point
    id: int
    size_m: float


class RigidBody(NamedTuple):
    """A rigid body, or a bone, whose number is then the skeleton's << 16 | the bone's."""

    id: int
    position: Point
    attitude: Quaternion
    mean_error_m: float = 0.0
    params: int = BodyFlag.TRACKED
    markers: tuple[BodyMarker, ...] = ()


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Bones that hang together."""

    id: int
    bones: tuple[RigidBody, ...] = ()


@dataclass(frozen=True, slots=True)
class AssetMarker:
    """A marker of an asset."""

    id: int
    position: Point
    size_m: float
    params: int
    residual: float


@dataclass(frozen=True, slots=True)
class Asset:
    """A trained asset; from 4.1 on."""

    id: int
    bodies: tuple[RigidBody, ...] = ()
    markers: tuple[AssetMarker, ...] = ()


@dataclass(frozen=True, slots=True)
class LabeledMarker:
    """A marker; the upper half of its number is the rigid body's, the lower one its own from 1 on."""

    id: int
    position: Point
    size_m: float
    params: int
    residual: float = 0.0
    """Residual in meters a ray; from 3.0 on."""


@dataclass(frozen=True, slots=True)
class Device:
    """A force plate or another device: samples by channel."""

    id: int
    channels: tuple[tuple[float, ...], ...] = ()


class Frame(NamedTuple):
    """One frame; a tuple, as bodies are: a frozen dataclass takes six times as long to make."""

    number: int
    marker_sets: tuple[MarkerSet, ...] = ()
    other_markers: tuple[Point, ...] = ()
    bodies: tuple[RigidBody, ...] = ()
    skeletons: tuple[Skeleton, ...] = ()
    assets: tuple[Asset, ...] = ()
    markers: tuple[LabeledMarker, ...] = ()
    force_plates: tuple[Device, ...] = ()
    devices: tuple[Device, ...] = ()
    latency_s: float = 0.0
    """The software's, before 3.0."""
    timecode: int = 0
    subframe: int = 0
    timestamp_s: float = 0.0
    """Since the software was started."""
    exposed: int = 0
    """The middle of the exposure, in the server's ticks, as the two that follow; 0 where no one knows it."""
    received: int = 0
    sent: int = 0
    precise: tuple[int, int] | None = None
    """Seconds and their fraction by PTP; from 4.1 on."""
    params: int = 0
    end: int = 0


_POINT: Final = Number("3f")
_QUATERNION: Final = Number("4f")
_INT: Final = Number("i")
_FLOAT: Final = Number("f")
_SHORT: Final = Number("h")
_TICKS: Final = Number("Q")

_BODY: Final = RecordLayout(
    RigidBody,
    FieldRow("id", _INT),
    FieldRow("position", _POINT),
    FieldRow("attitude", _QUATERNION),
    FieldRow(
        "markers",
        Columns(BodyMarker, FieldRow("position", _POINT), FieldRow("id", _INT), FieldRow("size_m", _FLOAT)),
        before=V3_0,
    ),
    FieldRow("mean_error_m", _FLOAT),
    FieldRow("params", _SHORT),
)
_DEVICES: Final = Items(
    RecordLayout(Device, FieldRow("id", _INT), FieldRow("channels", Items(Items(_FLOAT)))), announced=True
)
_TAIL: Final = 14
"""Size in bytes of the part behind the time stamps, where the precise one is there: itself, params, end."""

FRAME: Final = RecordLayout(
    Frame,
    FieldRow("number", _INT),
    FieldRow(
        "marker_sets",
        Items(
            RecordLayout(MarkerSet, FieldRow("name", Text()), FieldRow("markers", Items(_POINT))),
            announced=True,
        ),
    ),
    FieldRow("other_markers", Items(_POINT, announced=True)),
    FieldRow("bodies", Items(_BODY, announced=True)),
    FieldRow(
        "skeletons",
        Items(RecordLayout(Skeleton, FieldRow("id", _INT), FieldRow("bones", Items(_BODY))), announced=True),
    ),
    FieldRow(
        "assets",
        Items(
            RecordLayout(
                Asset,
                FieldRow("id", _INT),
                FieldRow("bodies", Items(_BODY)),
                FieldRow(
                    "markers",
                    Items(
                        RecordLayout(
                            AssetMarker,
                            FieldRow("id", _INT),
                            FieldRow("position", _POINT),
                            FieldRow("size_m", _FLOAT),
                            FieldRow("params", _SHORT),
                            FieldRow("residual", _FLOAT),
                        )
                    ),
                ),
            ),
            announced=True,
        ),
        since=V4_1,
    ),
    FieldRow(
        "markers",
        Items(
            RecordLayout(
                LabeledMarker,
                FieldRow("id", _INT),
                FieldRow("position", _POINT),
                FieldRow("size_m", _FLOAT),
                FieldRow("params", _SHORT),
                FieldRow("residual", _FLOAT, since=V3_0),
            ),
            announced=True,
        ),
    ),
    FieldRow("force_plates", _DEVICES),
    FieldRow("devices", _DEVICES, since=V2_11),
    FieldRow("latency_s", _FLOAT, before=V3_0),
    FieldRow("timecode", Number("I")),
    FieldRow("subframe", Number("I")),
    FieldRow("timestamp_s", Number("d")),
    FieldRow("exposed", _TICKS, since=V3_0),
    FieldRow("received", _TICKS, since=V3_0),
    FieldRow("sent", _TICKS, since=V3_0),
    # A 4.0 that has it is read, because clients disagree on that; none is written.
    FieldRow("precise", WhereThereIsRoom(Number("2I"), _TAIL, since=V4_1), since=V4_0),
    FieldRow("params", _SHORT),
    FieldRow("end", Number("I")),
)
"""The payload of a frame of data."""


def decoded(payload: bytes, version: Version) -> Frame:
    """Return a frame; NatNetError where these bytes are none of this version."""
    # Most frames have bodies and markers alone: they are read at once, four times as fast as by rows.
    layout = shown(payload, version)
    values = None if layout is None else layout.unpack(payload)
    if layout is not None and values is not None:
        return _of_values(values, layout)
    frame: Frame = decode(FRAME, payload, version, "frame")
    # The end marker is 0; another value shows that a list was read with a wrong layout.
    if frame.end != 0:
        raise NatNetError(f"frame {frame.number} ends with 0x{frame.end:08X} in place of 0")
    return frame


def encoded(frame: Frame, version: Version) -> bytes:
    """Return a frame's payload; NatNetError where a value does not fit."""
    payload = _in_one_stroke(frame, version)
    return encode(FRAME, frame, version, "frame") if payload is None else payload


def _of_values(values: tuple[Any, ...], layout: Plain) -> Frame:
    bodies, markers = values[layout.bodies], values[layout.markers]
    timecode, subframe, timestamp, exposed, received, sent, *precise, params, end = values[layout.tail]
    return Frame(
        values[0],
        bodies=tuple(
            [
                RigidBody(
                    bodies[at],
                    bodies[at + 1 : at + 4],
                    bodies[at + 4 : at + 8],
                    bodies[at + 8],
                    bodies[at + 9],
                )
                for at in range(0, len(bodies), BODY_VALUES)
            ]
        ),
        markers=tuple(
            [
                LabeledMarker(
                    markers[at], markers[at + 1 : at + 4], markers[at + 4], markers[at + 5], markers[at + 6]
                )
                for at in range(0, len(markers), MARKER_VALUES)
            ]
        ),
        timecode=timecode,
        subframe=subframe,
        timestamp_s=timestamp,
        exposed=exposed,
        received=received,
        sent=sent,
        precise=(precise[0], precise[1]) if precise else None,
        params=params,
        end=end,
    )


def _in_one_stroke(frame: Frame, version: Version) -> bytes | None:
    """Return the payload of a frame that has nothing but bodies and their markers; None for another one."""
    layout = plain(version, len(frame.bodies), len(frame.markers))
    others = (frame.marker_sets, frame.other_markers, frame.skeletons, frame.assets, frame.force_plates)
    if layout is None or any(others) or frame.devices or frame.end:
        return None
    # Markers of a body are of versions before 3.0; from 4.1 on the precise stamp is always there.
    if any(body.markers for body in frame.bodies) or (frame.precise is None and version >= V4_1):
        return None
    precise = frame.precise if version >= V4_1 and frame.precise is not None else ()
    return layout.pack(
        frame.number,
        [
            it
            for one in frame.bodies
            for it in (one.id, *one.position, *one.attitude, one.mean_error_m, one.params)
        ],
        [it for one in frame.markers for it in (one.id, *one.position, one.size_m, one.params, one.residual)],
        (
            frame.timecode,
            frame.subframe,
            frame.timestamp_s,
            frame.exposed,
            frame.received,
            frame.sent,
            *precise,
            frame.params,
            frame.end,
        ),
    )
