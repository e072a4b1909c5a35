"""Schemas of a recording: their names, descriptors and message classes, made at run time, without protoc.

Importing this module needs the extra `mcap`: see `firmware_bridge.extras.from_extras`.
"""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, Final, TypeAlias

from foxglove_schemas_protobuf import JointStates_pb2, Log_pb2, PoseInFrame_pb2
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

MessageClass: TypeAlias = Any
"""A class of protobuf's, which carries no types."""
OURS: Final = "firmware_bridge.recording"
"""Package of `recording.proto`."""
DESCRIPTOR: Final = "recording.desc"
"""A serialized FileDescriptorSet, as protoc makes it."""


@dataclass(frozen=True, slots=True)
class Schema:
    """One message of a channel."""

    name: str
    descriptor: bytes
    """A serialized FileDescriptorSet with all that the message needs, as MCAP has it."""
    message: MessageClass


@cache
def own(name: str) -> Schema:
    """Return a message of `recording.proto`; KeyError where it has none of this name."""
    full = f"{OURS}.{name}"
    return Schema(full, _descriptor(), message_factory.GetMessageClass(_pool().FindMessageTypeByName(full)))


@cache
def foxglove(name: str) -> Schema:
    """Return a message of Foxglove's: PoseInFrame, JointStates or Log; KeyError for another."""
    message: Any = {
        "JointStates": JointStates_pb2.JointStates,
        "Log": Log_pb2.Log,
        "PoseInFrame": PoseInFrame_pb2.PoseInFrame,
    }[name]
    return Schema(f"foxglove.{name}", _with_imports(message.DESCRIPTOR.file), message)


@cache
def _descriptor() -> bytes:
    return files(__package__).joinpath(DESCRIPTOR).read_bytes()


@cache
def _pool() -> Any:
    # A pool of its own: another program's messages of this name are no conflict.
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(_descriptor()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return pool


def _with_imports(file: Any) -> bytes:
    """Return a file's descriptor behind those of all files that it imports, in the order of the imports."""
    found: dict[str, bytes] = {}

    def add(one: Any) -> None:
        for imported in one.dependencies:
            add(imported)
        found.setdefault(one.name, one.serialized_pb)

    add(file)
    every = [descriptor_pb2.FileDescriptorProto.FromString(one) for one in found.values()]
    raw: bytes = descriptor_pb2.FileDescriptorSet(file=every).SerializeToString()
    return raw
