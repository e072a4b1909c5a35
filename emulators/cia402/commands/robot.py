"""A robot's CiA 402 drives on its CAN buses, at the command line."""

from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Link

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from firmware_bridge.robot import AnyRobot


def emulate_drives(machine: "AnyRobot", given: "RobotOptions") -> Emulation:
    """Make a robot's drives, for its buses; an error ends the program with a message."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cia402.servo import PRODUCT, Servo
    from emulators.cli.beginning import report_beginning
    from emulators.cli.robot_buses import on_buses
    from emulators.devices import devices
    from emulators.parameter_files import Storages, storage_in
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.links import opened
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    if given.serial is not None:
        raise refusal(f"--serial: {machine.name} has CiA 402 drives, which have no serial line here")
    with one_message(RobotFileError, PlantError, ServoError, StorageError):
        report_beginning(machine, given.plant)
        kept = {
            axis.name: storage_in(given.parameters, Cia402Axis.of(axis).node, PRODUCT.name)
            for axis in machine.axes
        }
        emulated = devices(
            machine,
            given.plant,
            realistic_latency=given.realistic_latency,
            report=say,
            options=(Storages(kept),),
        )
    return on_buses(
        machine,
        given,
        emulated,
        emulated.nodes(Servo),
        rates={name: link.bit_rate for name, link in Cia402Link.all_of(machine).items()},
        single=lambda rate: opened(given, "", 0, rate, any_rate=False),
    )
