"""Traffic on the links of a bridge, by their names, out of all files of a recording.

Instants count from the begin of the recording: that of a run on the bench, else that of its first packet.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from emulators.family import family_of
from emulators.replay.ending import end_requested_at
from emulators.replay.files import files_of, within
from emulators.replay.order import ReplayOrder
from emulators.replay.recordings import (
    Recording,
    RecordingFileError,
    read_can,
    read_lines,
    read_telemetry,
)
from emulators.replay.senders import BRIDGE, Sent, chunks_of, frames_of, messages_of
from emulators.replay.stage import first_of
from emulators.wires import CanWire
from firmware_bridge.dissector import kinds_of
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import mavlink_origin
from firmware_bridge.robot import AnyRobot
from firmware_bridge.runtime.black_box import EVENTS_LOG, STATIONS_LOG
from firmware_bridge.units import MICROSECOND, Nanoseconds


@dataclass(frozen=True, slots=True)
class Inputs:
    """Packets that a bridge has received and sent."""

    robot: AnyRobot
    recordings: Mapping[str, Recording]
    """Recordings by the links' names, the operator's among them."""
    virtual: bool
    """True if the recording is the bench's own."""
    ended: Nanoseconds | None
    """Time of the request to end the bridge; None where no file has it."""

    @property
    def links(self) -> Sequence[str]:
        """The links' names."""
        return tuple(self.recordings)

    @property
    def name(self) -> str:
        """Name of the first file."""
        return next(iter(self.recordings.values())).name

    def on(self, link: str, lead: Nanoseconds = 0) -> list[Sent]:
        """Return the traffic on a link, with its senders; instants count from `lead` before the begin."""
        recording = self.recordings[link].since(-lead)
        if link == OPERATOR:
            return messages_of(recording, self.robot)
        if kinds_of(self.robot)[link] == CAN:
            return frames_of(recording, self.robot, link)
        return chunks_of(recording)


def inputs_of(order: ReplayOrder) -> Inputs:
    """Read the files of an order; RecordingFileError where they do not go together, or a link is missing."""
    robot = order.robot
    found = _found(order)
    links = [name for name in found if name != OPERATOR]
    # Files of two runs would be compared without a single match.
    _at_one_time(tuple(found.values()))
    virtual = all(one.virtual for one in found.values())
    begin = 0 if virtual else _begin_of(found, robot)
    ended = None if virtual else _ended(order, begin)
    inputs = Inputs(robot, {name: one.since(begin) for name, one in found.items()}, virtual, ended)
    if not any(one.sender == BRIDGE for name in links for one in inputs.on(name)):
        raise RecordingFileError(f"{inputs.name}: holds no word of a bridge to the devices of {robot.name}")
    return inputs


def _ended(order: ReplayOrder, begin: Nanoseconds) -> Nanoseconds | None:
    events = within(order.recording, EVENTS_LOG) if order.recording.is_dir() else None
    requested = None if events is None else end_requested_at(events)
    return None if requested is None else requested - begin


def _found(order: ReplayOrder) -> dict[str, Recording]:
    """Return what each link of the robot has carried, the operator's last where it was recorded."""
    robot, files = order.robot, files_of(order)
    kinds = kinds_of(robot)
    buses = [name for name, kind in kinds.items() if kind == CAN]
    found: dict[str, Recording] = {}
    if files.frames is not None:
        if not buses and files.frames is order.recording:
            raise RecordingFileError(
                f"{files.frames.name}: the bridge of {robot.name} is on a serial line, and sends no CAN"
                " frame; give its serial.log, or the folder of the run"
            )
        for name in buses:
            found[name] = read_can(files.frames, order.channel if len(buses) == 1 else name)
    for file in filter(None, (files.chunks, files.sights)):
        found |= _by_link(read_lines(file), robot, set(kinds) - set(buses))
    missing = [name for name in kinds if name not in found]
    if missing:
        raise RecordingFileError(
            f"{order.recording.name}: holds nothing of {robot.name}'s link {_named(missing)}; give the folder"
            " of a run that has all of its links"
        )
    if files.words is not None:
        found[OPERATOR] = _placed(read_telemetry(files.words), order)
    return found


def _placed(words: Recording, order: ReplayOrder) -> Recording:
    """Return the stations' messages, each with its sender's place, where the run's folder records that."""
    file = within(order.recording, STATIONS_LOG) if order.recording.is_dir() else None
    if file is None:
        return words
    inputs, entries, places = deque(read_lines(file).entries), [], dict[tuple[int, ...], int]()
    for entry in words.entries:
        # The telemetry log has whole microseconds.
        while inputs and inputs[0].at <= entry.at + MICROSECOND:
            new = inputs.popleft().packet
            places[tuple(new.payload)] = new.address
        packet = entry.packet
        address = places.get(mavlink_origin(packet.payload)[:2], packet.address)
        entries.append(replace(entry, packet=Packet(packet.link, address, packet.payload)))
    return replace(words, entries=tuple(entries))


def _begin_of(found: Mapping[str, Recording], robot: AnyRobot) -> Nanoseconds:
    """Return the begin of a recording by a real clock.

    A bridge sends to its operator from its begin on; earlier messages of the operator do not matter.
    """
    buses = {name: bus for name in robot.links if (bus := family_of(robot, name).bus(robot, name))}
    bit_times = {name: CanWire(bus.bit_rate).bit_time for name, bus in buses.items()}
    begin = min(one.start(bit_times.get(name, 0)) for name, one in found.items() if name != OPERATOR)
    sent = messages_of(found[OPERATOR], robot) if OPERATOR in found else []
    # The bridge may have spoken to its operator before any device's packet was recorded.
    own = first_of(sent, BRIDGE)
    return begin if own is None else min(begin, own.entry.at)


def _by_link(recording: Recording, robot: AnyRobot, known: set[str]) -> dict[str, Recording]:
    """Part what lines or cameras have carried; RecordingFileError for a link that the robot has not."""
    entries: dict[str, list[int]] = {}
    for place, one in enumerate(recording.entries):
        if one.packet.link not in known:
            raise RecordingFileError(
                f"{one.where}: {robot.name} has no line '{one.packet.link}'; it has: {_named(sorted(known))};"
                " for drives over a serial line use --serial"
            )
        entries.setdefault(one.packet.link, []).append(place)
    return {
        link: Recording(recording.name, tuple(recording.entries[place] for place in places), recording.origin)
        for link, places in entries.items()
    }


def _at_one_time(recordings: Sequence[Recording]) -> None:
    """RecordingFileError where one ended before another one began."""
    first, *others = recordings
    for other in others:
        if other.entries[-1].at < first.entries[0].at or other.entries[0].at > first.entries[-1].at:
            raise RecordingFileError(f"{other.name}: was recorded at another time than {first.name}")


def _named(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names) or "none"
