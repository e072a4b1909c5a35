"""The worlds that recordings are played into: the drives alone, the bridge alone, the bench.

This module alone knows a robot's links, and the nodes on them.

The bench's own recordings begin with the run. In one of a real bus a drive that begins with its boot-up
message, and the bridge with its first frame, is switched on for that instant. Another drive was there `LEAD`
before, and its boot-up message is not received. A drive that sends nothing in a recording stays off the bus.
"""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

from emulators.bench.bench_setup import bench_setup_of
from emulators.devices import devices
from emulators.family import family_of
from emulators.recorded import FRAMES, WORDS
from emulators.replay.comparison import Frames
from emulators.replay.earlier_texts import answers_of
from emulators.replay.files import one_file
from emulators.replay.on_all_links import on_all_links
from emulators.replay.order import Into, ReplayOrder
from emulators.replay.player import Player
from emulators.replay.recordings import (
    Recording,
    RecordingFileError,
    duration_of,
    is_lines,
    is_telemetry,
    read_can,
    read_telemetry,
)
from emulators.replay.senders import BRIDGE, Sent, frames_of, messages_of
from emulators.replay.stage import (
    RECORDING,
    ReplayStage,
    begin_of,
    call_at,
    end_of,
    first_of,
    not_after,
    script_of,
    to_compare,
)
from emulators.rig import Rig
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen.cia301 import ERROR_CONTROL, LSS_RESPONSE, NmtState, encode_heartbeat
from firmware_bridge.dissector.canopen import service_name
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

LEAD: Final[Nanoseconds] = SECOND
"""A drive that was there before a recording has had this time to initialize."""
SHARED: Final = LSS_RESPONSE
"""Identifier with which every drive answers, so the sender of an answer is ambiguous."""


def _drives(order: ReplayOrder) -> ReplayStage:
    """Put the drives of the recording on a bus, with its other nodes."""
    if order.confirmed:
        raise RecordingFileError(f"{order.recording.name}: the drives take no position, a bridge does")
    robot, link = order.robot, order.link
    recording = _can_log(order, LEAD)
    lead = 0 if recording.virtual else LEAD
    frames = not_after(order, frames_of(recording, robot, order.link), lead)
    firsts = {axis.name: one for axis in robot.axes_on(link) if (one := first_of(frames, axis.name))}
    if not firsts:
        raise RecordingFileError(f"{recording.name}: holds no frame of a drive of {robot.name}")
    emulated = devices(robot, order.plant, on_lines=False)
    world, bus = World(emulated.physics), CanWire(_bit_rate(order))
    duration = partial(duration_of, bit_time=bus.bit_time)
    for axis in robot.axes_on(link):
        name, first = axis.name, firsts.get(axis.name)
        boots = first is not None and _boots(first, axis.settings.number)
        start = begin_of(first, duration) if first and boots and not recording.virtual else 0
        call_at(world, start, partial(world.attach, name, emulated.stations[name].node, {CAN: bus}))
        if not boots:
            # It was there before: its boot-up message is not in the recording, and must not come.
            world.silence(name, 0)
        if first and not boots:
            call_at(world, max(lead, 1), partial(world.silence, name, NEVER))
    played = [one for one in frames if one.sender not in firsts and one.entry.packet.address != SHARED]
    world.attach(RECORDING, Player(script_of(played, duration)), {CAN: bus})
    end = end_of(order, frames)
    comparison = Frames(to_compare(order, frames, firsts), firsts, order.tolerance, end)

    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        if service_name(packet) not in order.without and packet.address != SHARED:
            comparison.take(now, sender, packet)

    bus.observe(note)
    return ReplayStage(world.run, (comparison,), frames, len(played), end, lead, emulated.plant.close)


def _bench(order: ReplayOrder) -> ReplayStage:
    """Put the robot on the bench with the recorded operator."""
    file = one_file(order, WORDS)
    if not is_telemetry(file) or order.operator is not None:
        raise RecordingFileError(
            f"{file.name}: the bench takes an operator's messages, and wants one telemetry log (.tlog)"
        )
    robot = order.robot
    recording = read_telemetry(file)
    messages = not_after(order, messages_of(recording.since(recording.start(0)), robot))
    if first_of(messages, BRIDGE) is None:
        raise RecordingFileError(f"{recording.name}: holds no message of the bridge of {robot.name}")
    from_devices = [one for one in messages if one.sender != BRIDGE]
    answers = answers_of(messages, BRIDGE)
    operator = Player(script_of(from_devices, lambda _: 0))
    rig = Rig(robot, bench_setup_of(robot), operator, plant_path=order.plant, confirmed=order.confirmed)
    rig.operator_wire.observe(answers.take)
    return ReplayStage(
        rig.run, (answers,), messages, len(from_devices), end_of(order, messages), finish=rig.finish
    )


STAGES: Final[Mapping[Into, Callable[[ReplayOrder], ReplayStage]]] = MappingProxyType(
    {Into.DRIVES: _drives, Into.BRIDGE: on_all_links, Into.BENCH: _bench}
)
"""Constructors of each world; RecordingFileError, PlantError."""


def _can_log(order: ReplayOrder, lead: Nanoseconds) -> Recording:
    """Read the CAN log of an order; unless it is the bench's own, it begins at `lead`."""
    file = one_file(order, FRAMES)
    if is_telemetry(file):
        raise RecordingFileError(
            f"{file.name}: a telemetry log is played into the bench; give a CAN log, and this one"
            " beside it with --operator"
        )
    if is_lines(file):
        raise RecordingFileError(f"{file.name}: the drives take a CAN bus; lines are played into the bridge")
    if order.operator is not None:
        raise RecordingFileError(f"{order.operator.name}: the drives take no operator")
    bit_rate = _bit_rate(order)
    if not bit_rate:
        raise RecordingFileError(f"{file.name}: {order.robot.name} has no drives on a CAN bus")
    recording = read_can(file, order.channel)
    start = recording.start(CanWire(bit_rate).bit_time)
    return recording.since(start if recording.virtual else start - lead)


def _bit_rate(order: ReplayOrder) -> int:
    """Return the bit rate of the link's CAN bus, bit/s; 0 without one."""
    known = order.link in order.robot.links
    bus = family_of(order.robot, order.link).bus(order.robot, order.link) if known else None
    return 0 if bus is None else bus.bit_rate


def _boots(sent: Sent, node: int) -> bool:
    """Return whether a frame is a node's boot-up message."""
    return sent.entry.packet == Packet(CAN, ERROR_CONTROL + node, encode_heartbeat(NmtState.BOOT_UP))
