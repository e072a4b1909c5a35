"""The arm AR2 as a family of emulated devices: its board, its joints on a plant, its serial line."""

from functools import partial
from typing import Final

from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.ar2.firmwares import FIRMWARES
from emulators.arduino_omni.ar2.plant_joints import ANGLES, FIELDS, INPUTS, STEP, PlantJoints, SteppedJoints
from emulators.arduino_omni.board_line import BoardLine, board_line
from emulators.family import BridgeLink, BuildOrder, Built, EmulatedFamily, Line, Plan, Station, Way
from emulators.servo.fmu_axes import PlantNeeds
from firmware_bridge.families.ar2 import wire
from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Firmware, Ar2Link
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.robot import AnyRobot
from fmu.plant import FmuPlant


def _plans(order: BuildOrder) -> tuple[Plan, ...]:
    """Return each board; a plant has the joints of one arm, so that a second one is refused."""
    return tuple(_plan(order.robot, name) for name in Ar2Link.all_of(order.robot))


def _plan(robot: AnyRobot, link: str) -> Plan:
    # An arm's motors have no encoder, and its switches stay where they are: only their fields turn over.
    turned = tuple(FIELDS[Ar2Axis.of(axis).joint - 1] for axis in robot.axes_on(link) if axis.direction < 0)
    return Plan(
        title=f"the arm on '{link}'",
        needs=PlantNeeds(inputs=INPUTS, outputs=ANGLES, mirrored=turned),
        build=partial(_built, robot, link),
        every=STEP,
    )


def _built(robot: AnyRobot, link: str, plant: FmuPlant, leads: bool) -> Built:  # noqa: FBT001 - as `Plan`
    joints = PlantJoints(plant, leads=leads)
    board = Ar2Board(FIRMWARES["2.0"], joints)
    station = Station(board, link, {SERIAL: Way.LINE})
    return Built({link: station}, SteppedJoints(board, joints, [axis.name for axis in robot.axes_on(link)]))


def _line(robot: AnyRobot, node: Node, link: BridgeLink, _host: str, before: Line | None) -> BoardLine:
    table = Ar2Link.of_link(robot, link.name)
    return board_line(node, link, table, table.protocol.value, before)


def _protocols(robot: AnyRobot, link: str) -> tuple[str, ...]:
    return (Ar2Link.of_link(robot, link).protocol.value,)


def _reports(node: Node, link: str) -> None:
    from emulators.arduino_omni.commands.reported import keeping_reported  # noqa: PLC0415 - a command's own

    if isinstance(node, Ar2Board):
        keeping_reported(node.mega, link)


FAMILY: Final = EmulatedFamily(
    links=(Ar2Link,),
    plans=_plans,
    line=_line,
    electric=False,
    protocols=_protocols,
    reports_to_console=_reports,
    questions={Ar2Firmware.AR2_2_0: (b"WTS0" + wire.END, wire.DONE)},
)
