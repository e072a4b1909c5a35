"""Devices alone on serial lines, each with one motor: the line to one, and their family.

The link of each has a `firmware_bridge.robot.table.LineTable`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, Protocol

from emulators.family import (
    BridgeLink,
    BuildOrder,
    Built,
    CountedLink,
    Devices,
    EmulatedFamily,
    Lane,
    Line,
    LineRun,
    Plan,
    Station,
    Way,
)
from emulators.physics import Motor, SteppedActuators
from emulators.servo.fmu_axes import PlantNeeds
from emulators.servo.plant_part import PlantPart
from emulators.wires.adapter import Adapter
from emulators.wires.played import PlayedLine
from emulators.wires.serial import Inbox, SerialWire
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.robot.table import LineTable
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds
from fmu.plant import FmuPlant

BUFFER: Final = 4_096
"""Size of the host's receive buffer, bytes; larger than any answer."""


@dataclass(frozen=True, slots=True)
class PlainLine:
    """The line to a device."""

    wire: SerialWire
    adapter: Adapter
    link: CountedLink
    table: LineTable

    def lane(self, kind: str, player: str) -> Lane:
        """Return a line on which a recording's bytes arrive as they did: only it has their times."""
        played = PlayedLine(self.wire.baud, player, self.link.name)
        return Lane(kind, played, played.duration)

    def carried(self, robot: AnyRobot, duration: Nanoseconds, devices: Devices) -> LineRun:
        """Return what the line has carried in a run so long."""
        del devices
        return LineRun(
            link=self.link.name,
            protocol=self.table.kind,
            baud=self.wire.baud,
            bytes=self.wire.bytes,
            commands=self.link.commands,
            busy_percent=round(100.0 * self.link.busy / duration, 3),
            cycle_ms=float(robot.cycle_ms * self.table.every),
            longest_cycle_ms=self.link.longest_cycle / MILLISECOND,
            late_cycles=self.link.late,
        )


def plain_line(robot: AnyRobot, node: Node, link: BridgeLink, host: str, before: Line | None) -> PlainLine:
    """Put a node on the line of a link; see `emulators.family.MakeLine`. TypeError for another link."""
    table = LineTable.of_link(robot, link.name)
    if not isinstance(link, CountedLink):
        raise TypeError(f"the bridge's link '{link.name}' counts no requests")
    adapter = Adapter(node, link.name)
    if isinstance(before, PlainLine):
        # The cable outlives the process: its plug and its counts go on.
        adapter.plugged = before.adapter.plugged
        link.commands, link.busy = before.link.commands, before.link.busy
        return PlainLine(before.wire, adapter, link, table)
    # Without a latency bytes are handed over one by one, as on a plain UART.
    inboxes = {host: Inbox(BUFFER, table.latency_us * MICROSECOND)} if table.latency_us else {}
    return PlainLine(SerialWire(table.rate, inboxes, link.name), adapter, link, table)


class LineMotor(Node, Motor, Protocol):
    """A device as a node on its line, on the link `SERIAL`, and as the motor of its axis."""

    def act(self) -> None:
        """Set the plant's inputs for its next step, by its outputs after the last one."""


class MakeDevice(Protocol):
    """Constructor of a device."""

    def __call__(self, robot: AnyRobot, axis: Axis, part: PlantPart, /) -> LineMotor:
        """Put the device of an axis at its part of the plant: inputs and outputs as they are listed."""


def line_family(
    table: type[LineTable],
    device: MakeDevice,
    *,
    inputs: Callable[[str], Sequence[str]],
    outputs: Callable[[str], Sequence[str]],
    every: Nanoseconds,
    electric: bool = True,
) -> EmulatedFamily:
    """Return the family of such devices, which act every so many ns.

    `inputs` and `outputs` are the plant's variables of an axis, by its name; all of them turn over with the
    axis's `direction`. `electric` is as in `EmulatedFamily`.
    """

    def plan(robot: AnyRobot, link: str) -> Plan:
        (axis,) = robot.axes_on(link)
        takes, gives = tuple(inputs(axis.name)), tuple(outputs(axis.name))
        return Plan(
            title=f"the device on '{link}'",
            needs=PlantNeeds(
                inputs=takes, outputs=gives, mirrored=(*takes, *gives) if axis.direction < 0 else ()
            ),
            build=partial(built, robot, axis),
            every=every,
        )

    def built(robot: AnyRobot, axis: Axis, plant: FmuPlant, leads: bool) -> Built:  # noqa: FBT001 - as `Plan`
        part = PlantPart(plant, inputs(axis.name), outputs(axis.name))
        made = device(robot, axis, part)
        actuators = SteppedActuators((made,), made.act, plant if leads else part, every)
        return Built({axis.link: Station(made, axis.link, {SERIAL: Way.LINE})}, actuators)

    def plans(order: BuildOrder) -> Sequence[Plan]:
        return [plan(order.robot, link) for link in table.all_of(order.robot)]

    return EmulatedFamily(links=(table,), plans=plans, line=plain_line, electric=electric)
