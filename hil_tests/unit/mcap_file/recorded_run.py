"""A short run on the bench as an MCAP file, and its messages, decoded by the schemas in the file."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.run import RunOrder, drive
from firmware_bridge.robot_types import find
from firmware_bridge.units import Nanoseconds

CRAWL: Final = """
title = "start, arm, crawl, and lose a plug"
duration_s = 3.0

[noise]
jitter_ms = 5.0

[[step]]
at_s = 0.5
title = "its positions"
zero = { steering = 0.0, lift = 0.0 }

[[step]]
at_s = 1.0
title = "arm"
arm = true

[[step]]
at_s = 1.2
title = "crawl"
speed_mps = 0.05

[[fault]]
kind = "node_silent"
node = "lift"
at_s = 2.4
for_s = 0.3
"""
BOARD: Final = """
title = "start and arm"
duration_s = 4.0

[[step]]
at_s = 3.0
title = "arm"
arm = true
"""


class Row(NamedTuple):
    """One message, decoded."""

    at: Nanoseconds
    topic: str
    schema: str
    message: Any


@cache
def message_class(name: str, descriptor: bytes) -> Any:
    """Return a message's class by a file's own descriptor, as any other reader makes it."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptor).file:
        pool.AddSerializedFile(file.SerializeToString())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def rows(path: Path, topic: str | None = None) -> Iterator[Row]:
    """Yield the messages of a file in their order there."""
    with path.open("rb") as file:
        topics = None if topic is None else [topic]
        for schema, channel, message in make_reader(file).iter_messages(topics, log_time_order=False):
            assert schema is not None
            assert channel.message_encoding == schema.encoding == "protobuf"
            decoded = message_class(schema.name, schema.data).FromString(message.data)
            yield Row(message.log_time, channel.topic, schema.name, decoded)


def recorded(folder: Path, name: str, seed: int = 0, robot: str = "rars", text: str = CRAWL) -> Path:
    """Drive a mission, without pictures; return the file, beside which is the folder of the results."""
    machine = find(robot)
    setup = bench_setup_of(machine)
    script = mission.parse(text, "crawl", machine, setup)
    order = RunOrder(machine, setup, "crawl", script, seed, folder / name, record=folder / f"{name}.mcap")
    drive(order, lambda _now: None)
    return folder / f"{name}.mcap"
