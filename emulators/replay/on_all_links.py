"""The bridge alone: on each of its links it receives the recorded packets of all other nodes.

The bench's own recordings begin with the run, and have the bridge's packets at their arrival. A real robot's
has them as they leave the bridge, which was started before its first packet by the time that a bridge without
input takes to send it.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Final

from emulators.family import families
from emulators.replay.comparison import EXACT, Comparison, Frames
from emulators.replay.earlier_texts import answers_of
from emulators.replay.inputs import Inputs, inputs_of
from emulators.replay.machine import Machine, machine_of
from emulators.replay.order import ReplayOrder
from emulators.replay.player import Player
from emulators.replay.recordings import RESOLUTION, RecordingFileError
from emulators.replay.senders import BRIDGE, Sent
from emulators.replay.stage import (
    RECORDING,
    ReplayStage,
    call_at,
    end_of,
    first_of,
    not_after,
    script_of,
    to_compare,
)
from emulators.replay.woken import Woken
from emulators.wires import CanWire, Observer
from emulators.world import World
from firmware_bridge.dissector import kinds_of
from firmware_bridge.dissector.canopen import service_name
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

UNHEARD: Final[Nanoseconds] = 60 * SECOND
"""Time after which a silent bridge is given up."""
LATE: Final[Nanoseconds] = 10 * MILLISECOND
"""Greatest delay of a machine that is no busier than it should be."""
LOOK_EVERY: Final[Nanoseconds] = 50 * MILLISECOND
"""Virtual time between two checks for its first packet."""


def on_all_links(order: ReplayOrder) -> ReplayStage:
    """Put the bridge on its links with the recorded traffic; RecordingFileError."""
    inputs = inputs_of(order)
    if inputs.ended is not None:
        # Behind the request to end, packets follow from what is in no packet.
        order = replace(order, until=min(inputs.ended, NEVER if order.until is None else order.until))
    # The bench's own recording begins with the run, and so with the bridge.
    lead, start = (0, 0) if inputs.virtual else _switched_on(order, inputs)
    sent = {name: not_after(order, inputs.on(name, lead), lead) for name in inputs.links}
    world, machine = World(), machine_of(order, timed=inputs.virtual)
    script = [
        (at, Packet(name, packet.address, packet.payload))
        for name, all_ in sent.items()
        for at, packet in script_of(_others(all_), machine.lanes[name].duration)
    ]
    # At one instant the operator, whose file is the last, speaks last: he may be answering.
    script.sort(key=lambda one: one[0])
    world.attach(RECORDING, Player(script), machine.wires)
    # A real machine woke its bridge a little late each time; the bench never does.
    bridge = machine.node if inputs.virtual else _woken(machine, sent, order, start)
    call_at(world, start, partial(world.attach, BRIDGE, bridge, machine.wires))
    end = end_of(order, *sent.values())
    comparisons = tuple(_compared(order, machine, name, all_, end) for name, all_ in sent.items())
    recorded = sorted((one for all_ in sent.values() for one in all_), key=lambda one: one.entry.at)
    kinds = kinds_of(order.robot)
    return ReplayStage(
        world.run, comparisons, recorded, len(script), end, lead, bridge=machine.bridge, kinds=kinds
    )


def _woken(machine: Machine, sent: Mapping[str, list[Sent]], order: ReplayOrder, start: Nanoseconds) -> Woken:
    """Return the bridge as its machine woke it; the instants on a timed bus are not its own."""
    # On a timed bus a frame leaves when the bus is idle, which is not when the bridge was woken.
    untimed = [name for name, lane in machine.lanes.items() if not isinstance(lane.wire, CanWire)]
    all_ = [one for name in untimed for one in sent.get(name, ())]
    spoke = [one.entry.at for one in all_ if one.sender == BRIDGE]
    received = [one.entry.at for one in all_ if one.sender != BRIDGE and one.entry.at > start]
    return Woken(machine.node, spoke, received, max(LATE, order.tolerance))


def _others(sent: list[Sent]) -> list[Sent]:
    return [one for one in sent if one.sender != BRIDGE]


def _compared(
    order: ReplayOrder, machine: Machine, name: str, sent: list[Sent], end: Nanoseconds
) -> Comparison:
    """Compare what the bridge sends on a link with what it is recorded to have sent there."""
    wire, kind = machine.lanes[name].wire, machine.lanes[name].kind
    if kind == OPERATOR:
        # This link delays, loses and overtakes: messages are found by their sequence numbers.
        answers = answers_of(sent, BRIDGE)
        wire.observe(answers.take)
        return answers
    own = to_compare(order, sent, (BRIDGE,))
    link, resolution = (CAN, RESOLUTION) if kind == CAN else (name, EXACT)
    frames = Frames(own, (BRIDGE,), order.tolerance, end, link=link, resolution=resolution)

    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        # A packet of a line's other wires has no bytes, and is in no recording.
        compared = service_name(packet) not in order.without if kind == CAN else bool(packet.payload)
        if compared:
            frames.take(now, sender, packet)

    wire.observe(note)
    return frames


def _switched_on(order: ReplayOrder, inputs: Inputs) -> tuple[Nanoseconds, Nanoseconds]:
    """Return the lead before the recording, and the start of the bridge, counted from there.

    A bridge without input is run until it sends its first packet on a link that is in the recording. To a
    board that may be an answer to the board's own message after power-on.
    """
    # A board speaks for itself after a reset; drives and cameras do not.
    boards = {kind for family in families().values() for kind in family.questions}
    world, machine = World(), machine_of(order, timed=False)
    spoken: dict[str, Nanoseconds] = {}
    requested = [
        name
        for name, lane in machine.lanes.items()
        if name in inputs.links and lane.kind not in boards and first_of(inputs.on(name), BRIDGE) is not None
    ]
    if not requested:
        raise RecordingFileError(
            f"{inputs.name}: its first messages do not show when the bridge was started; give the"
            " operator.tlog that was recorded with it (--operator), or the folder of the run"
        )
    for name in requested:
        machine.lanes[name].wire.observe(_noting(spoken, name))
    world.attach(BRIDGE, machine.node, machine.wires)
    while not spoken:
        if world.now >= UNHEARD:
            raise RecordingFileError(
                f"{inputs.name}: no one knows when the bridge of {order.robot.name} began"
            )
        # In steps: how long a bridge without input is silent depends on its robot file.
        world.run(world.now + LOOK_EVERY)
    name, after = next(iter(spoken.items()))
    own = first_of(inputs.on(name), BRIDGE)
    return after, 0 if own is None else own.entry.at


def _noting(spoken: dict[str, Nanoseconds], name: str) -> Observer:
    def note(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        if packet.payload:
            spoken.setdefault(name, now)

    return note
