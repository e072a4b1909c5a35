"""Our packing of MAVLink payloads against pymavlink's own, for every message of the dialect."""

import numpy as np
import pytest

from firmware_bridge.teleop.layouts import layout_of
from firmware_bridge.teleop.mavlink import Codec, dialect

SYSTEM, COMPONENT = 7, 190


def frames(number: int) -> list[bytes]:
    """Return frames of one message by pymavlink: all zeros, all kinds of bytes, and cut short by zeros."""
    kind = dialect.mavlink_map[number]
    size = kind.unpacker.size
    chance = np.random.default_rng(number)
    contents = [bytes(size), *(chance.integers(0x7F, size=size, dtype=np.uint8).tobytes() for _ in range(3))]
    contents.append(contents[1][: size // 2].ljust(size, b"\0"))
    speaker = dialect.MAVLink(None, srcSystem=SYSTEM, srcComponent=COMPONENT)
    blank = dialect.MAVLink_message(number, kind.msgname)
    # The field values that give these very bytes are not known, so the step below theirs is taken.
    return [blank._pack(speaker, kind.crc_extra, content) for content in contents]  # noqa: SLF001


@pytest.mark.parametrize("number", sorted(dialect.mavlink_map))
def test_a_message_is_read_and_written_as_pymavlink_does(number: int) -> None:
    listener, codec = dialect.MAVLink(None), Codec(SYSTEM, COMPONENT)
    for sequence, frame in enumerate(frames(number)):
        theirs = listener.decode(bytearray(frame))
        (ours,) = codec.decode(frame)
        assert repr(ours.to_dict()) == repr(theirs.to_dict())
        assert (ours.get_msgId(), ours.get_srcSystem(), ours.get_srcComponent(), ours.get_seq()) == (
            number, SYSTEM, COMPONENT, 0,
        )  # fmt: skip
        speaker = dialect.MAVLink(None, srcSystem=SYSTEM, srcComponent=COMPONENT)
        speaker.seq = sequence
        assert codec.encode(ours) == theirs.pack(speaker)


def test_a_message_that_the_dialect_lacks_has_no_layout() -> None:
    assert layout_of(0xFF_FFFF) is None
