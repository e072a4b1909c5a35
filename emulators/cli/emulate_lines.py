"""A robot whose devices are on serial lines, each on its own, at the command line."""

from functools import partial
from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from firmware_bridge.cli.console import one_message
from firmware_bridge.node import SERIAL, Node
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import SERIAL_LOG

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.runtime.ports import Port


def emulate_lines(machine: "AnyRobot", given: "RobotOptions") -> Emulation:
    """Make a robot's devices above its plant; one message for what cannot be."""
    from emulators.cli.beginning import report_beginning
    from emulators.cli.beside import beside_of
    from emulators.control.live import on_real_links
    from emulators.devices import devices
    from emulators.family import Way, family_of
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.fitted import linked
    from firmware_bridge.dissector import kinds_of
    from firmware_bridge.family import LinkOptions
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    with one_message(RobotFileError, PlantError):
        machine = linked(machine, LinkOptions(given.protocol, encoders=given.encoders))
        report_beginning(machine, given.plant)
        emulated = devices(machine, given.plant)
        cameras = beside_of(machine, emulated)
    own = {one.link: one for one in emulated.stations.values() if Way.LINE in one.on.values()}
    alone = len(own) == 1
    links = {name: SERIAL if alone else name for name in own}
    for name, one in own.items():
        family_of(machine, name).reports_to_console(one.node, name)
    members: dict[str, Node] = {**{name: one.node for name, one in own.items()}, **cameras.members}
    lines = {name: {SERIAL: link} for name, link in links.items()}
    # A board alone moves its plant itself, when it is called.
    physics = emulated.physics if cameras.members or not alone else None
    cluster = Cluster(members, physics, links={**lines, **cameras.links})
    files = {link: SERIAL_LOG if alone else f"{name}-{SERIAL_LOG}" for name, link in links.items()}
    kinds = kinds_of(machine)
    called = {link: device_side(name, kinds[name]) for name, link in links.items()}
    spoken_there = ", ".join(family_of(machine, name).spoken(machine, name) for name in links)

    def opened() -> "tuple[Openers, str]":
        ports = {name: _line_of(machine, name, given, alone=alone) for name in links}
        at_lines = (f"{'' if alone else f'{name} on '}{line.name}" for name, line in ports.items())
        lines: Openers = {links[name]: partial(_same, line) for name, line in ports.items()}
        return {**lines, **cameras.openers}, ", ".join((*at_lines, *cameras.where))

    return Emulation(
        node=cluster,
        opened=opened,
        text=lambda where: f"{machine.name} is on {where}: {spoken_there}",
        errors=(PlantError, ServoError),
        files=files,
        called=called,
        live=lambda: on_real_links(machine, emulated, cluster, emulated.plant),
    )


def _same(port: "Port") -> "Port":
    """Return what was opened already, because its name is found out only then."""
    return port


def _line_of(machine: "AnyRobot", name: str, given: "RobotOptions", *, alone: bool) -> "Port":
    """Open the line to a device; where there are several each has a pseudo-terminal of its own. PortError."""
    from firmware_bridge.cli.links import open_serial
    from firmware_bridge.runtime.ports import PortError
    from firmware_bridge.runtime.ports.pseudo_terminal import WORD

    table = machine.links[name]
    rate = table.rate
    link, device = given.serial_link, given.serial or WORD
    if alone:
        return open_serial(device, rate, link)
    if device != WORD:
        raise PortError(f"--serial {device}: {machine.name} has several lines; use --serial {WORD}")
    return open_serial(device, rate, None if link is None else link.with_name(f"{link.name}-{name}"))
