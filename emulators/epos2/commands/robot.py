"""A robot's drives on a CAN bus, a serial line, or both, at the command line."""

from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link

if TYPE_CHECKING:
    from emulators.canopen.saved_parameters import Storage
    from emulators.cli.emulate_robot import RobotOptions
    from firmware_bridge.families.epos2.maxon.frame import Generation
    from firmware_bridge.robot import AnyRobot, Axis


def emulate_drives(machine: "AnyRobot", given: "RobotOptions") -> Emulation:
    """Make a robot's drives, for a bus, a serial line, or both."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cli.beginning import report_beginning
    from emulators.cli.robot_buses import on_buses
    from emulators.devices import devices
    from emulators.epos2.commands.links import drives_opened
    from emulators.epos2.drive import Epos2
    from emulators.epos2.options import Epos2Options
    from emulators.epos2.serial.serial_drive import baud_of
    from emulators.parameter_files import Storages
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.links import on_the_line
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    protocol = _generation(given.protocol)
    near = on_the_line(given, [Epos2Axis.of(axis).node for axis in machine.axes])
    links = Epos2Link.all_of(machine)
    if given.link is None and len(links) > 1 and given.serial is not None:
        raise refusal("--serial is of a robot with one link; here only --link NAME=INTERFACE:CHANNEL works")
    owner = next(axis.name for axis in machine.axes if Epos2Axis.of(axis).node == near)
    with one_message(RobotFileError, PlantError, ServoError, StorageError):
        report_beginning(machine, given.plant)
        emulated = devices(
            machine,
            given.plant,
            realistic_latency=given.realistic_latency,
            report=say,
            options=(
                Epos2Options(serial={} if given.serial is None else {owner: protocol}),
                Storages({axis.name: _storage(axis, given) for axis in machine.axes}),
            ),
        )
    drives = emulated.nodes(Epos2)
    return on_buses(
        machine,
        given,
        emulated,
        drives,
        rates={name: link.bit_rate for name, link in links.items()},
        single=lambda rate: drives_opened(given, protocol, baud_of(drives[owner]), rate),
        on_line=owner,
    )


def _generation(spoken: str | None) -> "Generation | None":
    """Return the protocol of drives; another one ends the program with a message."""
    from firmware_bridge.families.epos2.maxon.frame import Generation

    known = [one.value for one in Generation]
    if spoken is not None and spoken not in known:
        raise refusal(f"--protocol {spoken}: drives speak {' or '.join(known)}")
    return None if spoken is None else Generation(spoken)


def _storage(axis: "Axis", given: "RobotOptions") -> "Storage":
    """Return where a drive finds its parameters at power-on: saved, the robot file's or the factory's."""
    from emulators.epos2.options import PRODUCT
    from emulators.parameter_files import Commissioned, storage_in
    from firmware_bridge.families.epos2.driver.product import commissioned

    kept = storage_in(given.parameters, Epos2Axis.of(axis).node, PRODUCT)
    if given.factory:
        return kept
    return Commissioned({row.address: row.value for row in commissioned(axis)}, kept)
