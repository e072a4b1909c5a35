"""Model definitions: the names of the numbers in a frame; requested and sent on the command channel.

Source: as for frames. The part about markers in a bone is there from 3.0 on in OptiTrack's Python client and
missing in an older C++ one: assumed it is there, no capture has a skeleton.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.families.motion_capture.wire.frame import Point, Quaternion
from firmware_bridge.families.motion_capture.wire.layout import (
    V3_0,
    V4_0,
    V4_2,
    Columns,
    FieldRow,
    Items,
    NatNetError,
    Number,
    RecordLayout,
    Tagged,
    Text,
    Version,
    decode,
    encode,
)

NO_PARENT: Final = -1
_CORNERS: Final = "12f"
_MATRIX: Final = "144f"


@dataclass(frozen=True, slots=True)
class MarkerSetModel:
    """The names of a set's markers."""

    name: str
    markers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ModelMarker:
    """Position of a marker on a rigid body."""

    position: Point
    label: int = 0
    """The active marker's that must be here; 0 for a passive one."""
    name: str = ""


@dataclass(frozen=True, slots=True)
class RigidBodyModel:
    """A rigid body's name and number."""

    name: str
    id: int
    parent: int = NO_PARENT
    offset: Point = (0.0, 0.0, 0.0)
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    markers: tuple[ModelMarker, ...] = ()


@dataclass(frozen=True, slots=True)
class SkeletonModel:
    """A skeleton and its bones."""

    name: str
    id: int
    bones: tuple[RigidBodyModel, ...] = ()


@dataclass(frozen=True, slots=True)
class ForcePlateModel:
    """A force plate: its calibration matrix by rows, its corners one after the other."""

    id: int
    serial: str
    width: float
    length: float
    origin: Point
    matrix: tuple[float, ...]
    corners: tuple[float, ...]
    type: int
    data_type: int
    channels: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DeviceModel:
    """Another device."""

    id: int
    name: str
    serial: str
    type: int
    data_type: int
    channels: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class CameraModel:
    """Position of a camera."""

    name: str
    position: Point
    attitude: Quaternion


@dataclass(frozen=True, slots=True)
class AssetMarkerModel:
    """A marker of an asset."""

    name: str
    id: int
    position: Point
    size_m: float
    params: int


@dataclass(frozen=True, slots=True)
class AssetModel:
    """A trained asset; from 4.1 on."""

    name: str
    type: int
    id: int
    bodies: tuple[RigidBodyModel, ...] = ()
    markers: tuple[AssetMarkerModel, ...] = ()


Model: TypeAlias = (
    MarkerSetModel | RigidBodyModel | SkeletonModel | ForcePlateModel | DeviceModel | CameraModel | AssetModel
)

_TEXT: Final = Text()
_INT: Final = Number("i")
_FLOAT: Final = Number("f")
_POINT: Final = Number("3f")
_QUATERNION: Final = Number("4f")
_TEXTS: Final = Items(_TEXT)

_BODY: Final = RecordLayout(
    RigidBodyModel,
    FieldRow("name", _TEXT),
    FieldRow("id", _INT),
    FieldRow("parent", _INT),
    FieldRow("offset", _POINT),
    FieldRow("rotation", _QUATERNION, since=V4_2),
    FieldRow(
        "markers",
        Columns(
            ModelMarker,
            FieldRow("position", _POINT),
            FieldRow("label", _INT),
            FieldRow("name", _TEXT, since=V4_0),
        ),
        since=V3_0,
    ),
)

MODELS: Final = Items(
    Tagged(
        {
            0: (
                MarkerSetModel,
                RecordLayout(MarkerSetModel, FieldRow("name", _TEXT), FieldRow("markers", _TEXTS)),
            ),
            1: (RigidBodyModel, _BODY),
            2: (
                SkeletonModel,
                RecordLayout(
                    SkeletonModel,
                    FieldRow("name", _TEXT),
                    FieldRow("id", _INT),
                    FieldRow("bones", Items(_BODY)),
                ),
            ),
            3: (
                ForcePlateModel,
                RecordLayout(
                    ForcePlateModel,
                    FieldRow("id", _INT),
                    FieldRow("serial", _TEXT),
                    FieldRow("width", _FLOAT),
                    FieldRow("length", _FLOAT),
                    FieldRow("origin", _POINT),
                    FieldRow("matrix", Number(_MATRIX)),
                    FieldRow("corners", Number(_CORNERS)),
                    FieldRow("type", _INT),
                    FieldRow("data_type", _INT),
                    FieldRow("channels", _TEXTS),
                ),
            ),
            4: (
                DeviceModel,
                RecordLayout(
                    DeviceModel,
                    FieldRow("id", _INT),
                    FieldRow("name", _TEXT),
                    FieldRow("serial", _TEXT),
                    FieldRow("type", _INT),
                    FieldRow("data_type", _INT),
                    FieldRow("channels", _TEXTS),
                ),
            ),
            5: (
                CameraModel,
                RecordLayout(
                    CameraModel,
                    FieldRow("name", _TEXT),
                    FieldRow("position", _POINT),
                    FieldRow("attitude", _QUATERNION),
                ),
            ),
            6: (
                AssetModel,
                RecordLayout(
                    AssetModel,
                    FieldRow("name", _TEXT),
                    FieldRow("type", _INT),
                    FieldRow("id", _INT),
                    FieldRow("bodies", Items(_BODY)),
                    FieldRow(
                        "markers",
                        Items(
                            RecordLayout(
                                AssetMarkerModel,
                                FieldRow("name", _TEXT),
                                FieldRow("id", _INT),
                                FieldRow("position", _POINT),
                                FieldRow("size_m", _FLOAT),
                                FieldRow("params", Number("h")),
                            )
                        ),
                    ),
                ),
            ),
        }
    )
)
"""The payload of model definitions."""


def decoded(payload: bytes, version: Version) -> tuple[Model, ...]:
    """Return the models, those of unknown types left out; NatNetError where these bytes are none."""
    found: tuple[Model | None, ...] = decode(MODELS, payload, version, "models")
    return tuple(model for model in found if model is not None)


def encoded(models: tuple[Model, ...], version: Version) -> bytes:
    """Return the payload of these models; NatNetError where a value does not fit."""
    return encode(MODELS, models, version, "models")


def body_named(models: tuple[Model, ...], name: str) -> int:
    """Return the number of the rigid body with this name; NatNetError where there is none, or two."""
    bodies = [model for model in models if isinstance(model, RigidBodyModel)]
    found = {body.id for body in bodies if body.name == name}
    # Two bodies of one name could be either.
    if len(found) != 1:
        there = ", ".join(body.name for body in bodies) or "none"
        raise NatNetError(f"{len(found)} rigid bodies are called '{name}'; there are: {there}")
    return found.pop()
