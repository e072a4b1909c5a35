"""Schemas: the committed descriptor is what protoc makes, and a file has all that its readers need."""

import subprocess
import sys
from pathlib import Path

import pytest
from google.protobuf import descriptor_pb2

import firmware_bridge.mcap_file
from firmware_bridge.mcap_file import channels
from firmware_bridge.mcap_file.rows import EventKind
from firmware_bridge.mcap_file.schemas import DESCRIPTOR, foxglove, own
from firmware_bridge.robot_types import find

FOLDER = Path(firmware_bridge.mcap_file.__file__).parent


def test_the_descriptor_is_what_protoc_makes_of_the_proto_file(tmp_path: Path) -> None:
    pytest.importorskip("grpc_tools")
    made = tmp_path / DESCRIPTOR
    words = (f"-I{FOLDER}", f"--descriptor_set_out={made}", "recording.proto")
    subprocess.run([sys.executable, "-m", "grpc_tools.protoc", *words], check=True)
    parse = descriptor_pb2.FileDescriptorSet.FromString
    assert parse((FOLDER / DESCRIPTOR).read_bytes()) == parse(made.read_bytes()), "run protoc: see its head"


@pytest.mark.parametrize("name", [*channels.OWN.values(), channels.DRIVE_STATE])
def test_each_message_of_ours_is_in_the_descriptor_of_its_schema(name: str) -> None:
    schema = own(name)
    (file,) = descriptor_pb2.FileDescriptorSet.FromString(schema.descriptor).file
    assert schema.name == f"{file.package}.{name}"
    assert name in [message.name for message in file.message_type]


@pytest.mark.parametrize("name", sorted(set(channels.FOXGLOVE.values())))
def test_a_schema_of_foxgloves_has_its_imports_before_itself(name: str) -> None:
    schema, known = foxglove(name), set[str]()
    assert schema.name == f"foxglove.{name}"
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema.descriptor).file:
        assert known.issuperset(file.dependency)
        known.add(file.name)
    assert f"foxglove/{name}.proto" in known


def test_the_kinds_of_events_have_the_numbers_of_the_proto_file() -> None:
    kinds = own("Event").message.DESCRIPTOR.enum_types_by_name["Kind"].values
    assert {one.name: one.number for one in kinds if one.number} == {one.name: one.value for one in EventKind}


def test_no_message_that_is_not_there_has_a_schema() -> None:
    with pytest.raises(KeyError):
        own("Nothing")
    with pytest.raises(KeyError):
        foxglove("Nothing")


def test_a_drives_topic_has_its_number_and_its_link_where_two_links_have_this_number() -> None:
    assert channels.drive_topics(find("rars")) == {
        name: f"/drive/{number}/state" for number, name in enumerate(("left", "right", "steer", "lift"), 1)
    }
    topics = channels.drive_topics(find("rome_arm"))
    assert len(set(topics.values())) == len(topics)
    assert any(topic.count("/") == 4 for topic in topics.values())
