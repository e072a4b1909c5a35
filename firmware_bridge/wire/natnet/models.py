"""Model definitions: the names of the numbers in a frame; requested and sent on the command channel.

Source: as for frames. The part about markers in a bone is there from 3.0 on in OptiTrack's Python client and
missing in an older C++ one: ASSUME it is there, no capture has a skeleton.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.wire.natnet.frame import Point, Quaternion
from firmware_bridge.wire.natnet.layout import (
    V3_0,
    V4_0,
    V4_2,
    Columns,
    Items,
    NatNetError,
    Number,
    Record,
    Row,
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

_BODY: Final = Record(
    RigidBodyModel,
    Row("name", _TEXT),
    Row("id", _INT),
    Row("parent", _INT),
    Row("offset", _POINT),
    Row("rotation", _QUATERNION, since=V4_2),
    Row(
        "markers",
        Columns(ModelMarker, Row("position", _POINT), Row("label", _INT), Row("name", _TEXT, since=V4_0)),
        since=V3_0,
    ),
)

MODELS: Final = Items(
    Tagged(
        {
            0: (
                MarkerSetModel,
                Record(MarkerSetModel, Row("name", _TEXT), Row("markers", _TEXTS)),
            ),
            1: (RigidBodyModel, _BODY),
            2: (
                SkeletonModel,
                Record(SkeletonModel, Row("name", _TEXT), Row("id", _INT), Row("bones", Items(_BODY))),
            ),
            3: (
                ForcePlateModel,
                Record(
                    ForcePlateModel,
                    Row("id", _INT),
                    Row("serial", _TEXT),
                    Row("width", _FLOAT),
                    Row("length", _FLOAT),
                    Row("origin", _POINT),
                    Row("matrix", Number(_MATRIX)),
                    Row("corners", Number(_CORNERS)),
                    Row("type", _INT),
                    Row("data_type", _INT),
                    Row("channels", _TEXTS),
                ),
            ),
            4: (
                DeviceModel,
                Record(
                    DeviceModel,
                    Row("id", _INT),
                    Row("name", _TEXT),
                    Row("serial", _TEXT),
                    Row("type", _INT),
                    Row("data_type", _INT),
                    Row("channels", _TEXTS),
                ),
            ),
            5: (
                CameraModel,
                Record(
                    CameraModel, Row("name", _TEXT), Row("position", _POINT), Row("attitude", _QUATERNION)
                ),
            ),
            6: (
                AssetModel,
                Record(
                    AssetModel,
                    Row("name", _TEXT),
                    Row("type", _INT),
                    Row("id", _INT),
                    Row("bodies", Items(_BODY)),
                    Row(
                        "markers",
                        Items(
                            Record(
                                AssetMarkerModel,
                                Row("name", _TEXT),
                                Row("id", _INT),
                                Row("position", _POINT),
                                Row("size_m", _FLOAT),
                                Row("params", Number("h")),
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
    if len(found) != 1:
        there = ", ".join(body.name for body in bodies) or "none"
        raise NatNetError(f"{len(found)} rigid bodies are called '{name}'; there are: {there}")
    return found.pop()
