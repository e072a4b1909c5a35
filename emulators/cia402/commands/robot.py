"""A robot's CiA 402 drives on its CAN buses, at the command line."""

from functools import partial
from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from emulators.cli.silences import silence_of
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Link
from firmware_bridge.node import CAN, Node
from firmware_bridge.runtime.black_box import CAN_LOG
from firmware_bridge.units import to_seconds

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.family import Beside
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.cli.places import BusAddress
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.runtime.ports import Port


def emulate_drives(machine: "AnyRobot", given: "RobotOptions") -> Emulation:
    """Make a robot's drives, for its buses; an error ends the program with a message."""
    from emulators.cia402.servo import Servo
    from emulators.cli.beginning import report_beginning
    from emulators.cli.beside import beside_of
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.devices import devices
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    if given.serial is not None or given.parameters is not None:
        option = "--serial" if given.serial is not None else "--parameters"
        raise refusal(f"{option}: {machine.name} has CiA 402 drives, which have no such thing here")
    cuts = [silence_of(machine, text) for text in given.silence or ()]
    with one_message(RobotFileError, PlantError, ServoError):
        report_beginning(machine, given.plant)
        emulated = devices(machine, given.plant, realistic_latency=given.realistic_latency, report=say)
    cameras = beside_of(machine, emulated)
    single = len(Cia402Link.all_of(machine)) == 1
    outer = {axis.name: {CAN: CAN if single else axis.link} for axis in machine.axes}
    members: dict[str, Node] = {**emulated.nodes(Servo), **cameras.members}
    cluster = Cluster(members, emulated.physics, links={**outer, **cameras.links})
    for name, at in cuts:
        cluster.silence(name, at)
        say(f"'{name}' falls silent after {to_seconds(at):g} s")
    nodes = ", ".join(f"{Cia402Axis.of(axis).node} {axis.title}" for axis in machine.axes)
    places = [(outer[axis.name][CAN], Cia402Axis.of(axis).node) for axis in machine.axes]
    return Emulation(
        node=duplicates_reported(cluster, places),
        opened=lambda: _outside(machine, given, cameras),
        text=lambda where: f"{machine.name} is on {where}: {nodes}",
        errors=(PlantError, ServoError),
        files=dict.fromkeys((CAN, *machine.links), CAN_LOG),
        around=lambda node: RollCalled(node, places),
    )


def _outside(machine: "AnyRobot", given: "RobotOptions", beside: "Beside") -> "tuple[Openers, str]":
    """Return what opens each link, and the text that names them."""
    from firmware_bridge.cli.links import opened
    from firmware_bridge.cli.places import BusAddress, places_of

    links = Cia402Link.all_of(machine)
    if len(links) == 1 and not given.link:
        (link,) = links.values()
        openers, where = opened(given, "", 0, link.bit_rate, any_rate=False)
        return {**openers, **beside.openers}, ", ".join((where, *beside.where))
    places = places_of(machine, given.link, BusAddress(given.interface, given.channel, given.serial))
    for name, place in places.items():
        if place.device is not None:
            raise refusal(f"--link {name}: CiA 402 drives are on CAN; give INTERFACE:CHANNEL")
    openers = {
        CAN if len(links) == 1 else name: partial(_port, links[name].bit_rate, place)
        for name, place in places.items()
    }
    where = ", ".join(f"{place.title} ({name})" for name, place in places.items())
    return {**openers, **beside.openers}, ", ".join((where, *beside.where))


def _port(rate: int, place: "BusAddress") -> "Port":
    from firmware_bridge.runtime.ports import open_can

    return open_can(place.interface, place.channel, None, default_bit_rate=rate, say=say)
