"""Writer of a recording in MCAP: packets, states, texts and events as messages, files as attachments.

Times are the run's own nanoseconds from 0. Nothing in the file depends on the day or the machine: the header
has no version of a library, and chunks are not compressed, as two versions of a compressor differ.
"""

import math
from collections.abc import Iterable, Mapping
from typing import IO, Final

from mcap.writer import CompressionType, Writer

from firmware_bridge.mcap_file import channels
from firmware_bridge.mcap_file.rows import DriveRow, EventRow, Joint
from firmware_bridge.mcap_file.schemas import Schema, foxglove, own
from firmware_bridge.packet import Packet
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, EXTENDED_MASK, REMOTE, identifier
from firmware_bridge.wire.internet import place_of

_FLAGS: Final = EXTENDED | REMOTE | ERROR
PROTOBUF: Final = "protobuf"
METADATA: Final = "recording"
LEVELS: Final = (5, 5, 5, 4, 3, 2, 2, 1)
"""Levels of foxglove.Log by MAV_SEVERITY: fatal down to critical, then error, warning, info twice, debug."""


class RecordingWriter:
    """One file. OSError where it cannot be written; without `finish` its end is missing, as after a crash."""

    def __init__(self, file: IO[bytes], about: Mapping[str, str]) -> None:
        """Begin the file; `about` is its metadata, as robot, mission and seed."""
        self._frame: Final = own("CanFrame").message
        self._chunk: Final = own("SerialChunk").message
        self._datagram: Final = own("Datagram").message
        self._drive: Final = own(channels.DRIVE_STATE).message
        self._event: Final = own("Event").message
        self._joints: Final = foxglove("JointStates").message
        self._log: Final = foxglove("Log").message
        self._pose: Final = foxglove("PoseInFrame").message
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._mcap: Final = Writer(file, compression=CompressionType.NONE)
        self._mcap.start(library=channels.LIBRARY)
        self._mcap.add_metadata(METADATA, {"format": channels.FORMAT, **about})

    def frame(self, at: Nanoseconds, bus: str, packet: Packet, *, sent: bool) -> None:
        """Add a CAN frame; `packet.address` with the flags of `firmware_bridge.wire.can`."""
        address, payload = packet.address, packet.payload
        if address & _FLAGS:
            remote = bool(address & REMOTE)
            message = self._frame(
                bus=bus,
                id=address & EXTENDED_MASK if address & ERROR else identifier(address),
                extended=bool(address & EXTENDED),
                remote=remote,
                error=bool(address & ERROR),
                data=b"" if remote else payload,
                requested=len(payload) if remote else 0,
                sent=sent,
            )
        else:
            message = self._frame(bus=bus, id=address, data=payload, sent=sent)
        self._add(at, channels.FRAMES, message.SerializeToString())

    def chunk(self, at: Nanoseconds, link: str, payload: bytes, *, sent: bool) -> None:
        """Add bytes of a serial line."""
        message = self._chunk(link=link, data=payload, sent=sent)
        self._add(at, channels.SERIAL, message.SerializeToString())

    def datagram(self, at: Nanoseconds, link: str, packet: Packet, *, sent: bool) -> None:
        """Add a datagram, with the place of the other end where it has one."""
        message = self._datagram(link=link, place=place_of(packet.address), data=packet.payload, sent=sent)
        self._add(at, channels.DATAGRAMS, message.SerializeToString())

    def text(self, at: Nanoseconds, severity: int, name: str, text: str) -> None:
        """Add a text for people; `severity` is a MAV_SEVERITY, `name` its source."""
        level = LEVELS[min(max(severity, 0), len(LEVELS) - 1)]
        message = self._log(timestamp=_stamp(at), level=level, message=text, name=name)
        self._add(at, channels.LOG, message.SerializeToString())

    def event(self, at: Nanoseconds, row: EventRow) -> None:
        """Add an event."""
        message = self._event(
            kind=int(row.kind),
            name=row.name,
            text=row.text,
            remedy=row.remedy,
            since_ns=at if row.since is None else row.since,
            devices=row.devices,
        )
        self._add(at, channels.EVENTS, message.SerializeToString())

    def drive(self, at: Nanoseconds, topic: str, row: DriveRow) -> None:
        """Add a drive's state; None where a value is not known."""
        message = self._drive(
            axis=row.axis,
            power=row.power,
            state=row.state,
            statusword=row.statusword,
            mode=row.mode,
            mode_name=row.mode_name,
            unit=row.unit,
            position=row.position,
            velocity=row.velocity,
            current_a=row.current_a,
            fault=row.fault,
        )
        self._add(at, topic, message.SerializeToString())

    def joints(self, at: Nanoseconds, joints: Iterable[Joint]) -> None:
        """Add the positions of joints, in rad or m, and their velocities."""
        rows = [{"name": one.name, "position": one.position, "velocity": one.velocity} for one in joints]
        message = self._joints(timestamp=_stamp(at), joints=rows)
        self._add(at, channels.JOINTS, message.SerializeToString())

    def pose(self, at: Nanoseconds, topic: str, frame: str, pose: tuple[float, float, float]) -> None:
        """Add a pose on a plane: x and y in m, the heading in rad, counter-clockwise, in the axes `frame`."""
        x, y, heading = pose
        half = 0.5 * heading
        message = self._pose(
            timestamp=_stamp(at),
            frame_id=frame,
            pose={"position": {"x": x, "y": y}, "orientation": {"z": math.sin(half), "w": math.cos(half)}},
        )
        self._add(at, topic, message.SerializeToString())

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Add a file."""
        self._mcap.add_attachment(0, 0, name, media_type, data)

    def flush(self) -> None:
        """Bring everything so far to the file: what is read after a crash."""
        self._mcap.flush()  # type: ignore[no-untyped-call] # the library's

    def finish(self) -> None:
        """Write the index; the file is closed by its owner."""
        self._mcap.finish()  # type: ignore[no-untyped-call] # the library's

    def _add(self, at: Nanoseconds, topic: str, data: bytes) -> None:
        channel = self._channels.get(topic)
        if channel is None:
            channel = self._channels[topic] = self._registered(topic)
        self._mcap.add_message(channel, at, data, at)

    def _registered(self, topic: str) -> int:
        """Make a channel at its first message, so that a file has none that is empty."""
        schema = _schema_of(topic)
        number = self._schemas.get(schema.name)
        if number is None:
            number = self._mcap.register_schema(schema.name, PROTOBUF, schema.descriptor)
            self._schemas[schema.name] = number
        return self._mcap.register_channel(topic, PROTOBUF, number)


def _schema_of(topic: str) -> Schema:
    if topic in channels.FOXGLOVE:
        return foxglove(channels.FOXGLOVE[topic])
    return own(channels.OWN.get(topic, channels.DRIVE_STATE))


def _stamp(at: Nanoseconds) -> dict[str, int]:
    seconds, nanos = divmod(at, SECOND)
    return {"seconds": seconds, "nanos": nanos}
