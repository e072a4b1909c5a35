"""A robot's drives on real CAN buses, of any family: the buses, who is on them, and who falls silent."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from emulators.cli.silences import silence_of
from firmware_bridge.cli.console import refusal, say
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import CAN_LOG, SERIAL_LOG
from firmware_bridge.units import to_seconds

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.family import Beside, Devices
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.cli.places import BusAddress
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.runtime.ports import Port


def on_buses(
    machine: "AnyRobot",
    given: "RobotOptions",
    emulated: "Devices",
    drives: Mapping[str, Node],
    *,
    rates: Mapping[str, int],
    single: "Callable[[int], tuple[Openers, str]]",
    on_line: str | None = None,
) -> Emulation:
    """Put the drives of a robot, by their axes, on its buses, with its cameras beside them.

    `rates` are the buses' in bit/s by link; `single` opens what the options name where there is one bus of
    this rate; `on_line` is the axis whose drive has a serial line, too. A wrong option ends the program.
    """
    from emulators.cli.beside import beside_of
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.control.live import on_real_links
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from fmu.errors import PlantError

    cuts = [silence_of(machine, text) for text in given.silence or ()]
    cameras = beside_of(machine, emulated)
    outer = {axis.name: {CAN: axis.link if len(rates) > 1 else CAN} for axis in machine.axes}
    places = [(outer[axis.name][CAN], axis.settings.number) for axis in machine.axes]
    files = dict.fromkeys((CAN, *machine.links), CAN_LOG)
    called = {}
    if on_line is not None:
        outer[on_line][SERIAL] = SERIAL
        files[SERIAL], called[SERIAL] = SERIAL_LOG, device_side(on_line, SERIAL)
    members = {**drives, **cameras.members}
    cluster = Cluster(members, emulated.physics, links={**outer, **cameras.links})
    for name, at in cuts:
        cluster.silence(name, at)
        say(f"'{name}' falls silent after {to_seconds(at):g} s")
    nodes = ", ".join(f"{axis.settings.number} {axis.title}" for axis in machine.axes)
    return Emulation(
        node=duplicates_reported(cluster, places),
        opened=lambda: _opened(machine, given, cameras, rates, single),
        text=lambda where: f"{machine.name} is on {where}: {nodes}",
        errors=(PlantError, ServoError),
        files=files,
        called=called,
        around=lambda node: RollCalled(node, places),
        live=lambda: on_real_links(machine, emulated, cluster, emulated.plant),
    )


def _opened(
    machine: "AnyRobot",
    given: "RobotOptions",
    beside: "Beside",
    rates: Mapping[str, int],
    single: "Callable[[int], tuple[Openers, str]]",
) -> "tuple[Openers, str]":
    """Return what opens each link, and the text that names them."""
    from firmware_bridge.cli.places import BusAddress, places_of

    alone = len(rates) == 1
    if alone and not given.link:
        openers, where = single(*rates.values())
    else:
        places = places_of(machine, given.link, BusAddress(given.interface, given.channel, given.serial))
        for name, place in places.items():
            if place.device is not None:
                raise refusal(
                    f"--link {name}: emulated drives of a robot are put on CAN here; give INTERFACE:CHANNEL"
                )
        openers = {
            CAN if alone else name: partial(_port, rates[name], place) for name, place in places.items()
        }
        where = ", ".join(f"{place.title} ({name})" for name, place in places.items())
    return {**openers, **beside.openers}, ", ".join((where, *beside.where))


def _port(rate: int, place: "BusAddress") -> "Port":
    from firmware_bridge.runtime.ports import open_can

    return open_can(place.interface, place.channel, None, default_bit_rate=rate, say=say)
