"""A robot's drives and plant on a real bus, at the command line: `emulate ROBOT`."""

from dataclasses import dataclass
from typing import Annotated, Final

import typer

from emulators.cli import emulation
from emulators.cli.emulation import Emulation, emulating
from emulators.cli.options import ControlOption, FaultOption, LatencyOption, ParametersOption, PlantOption
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.live_page import LiveOption
from firmware_bridge.cli.options import (
    DurationOption,
    EncodersOption,
    LinkOption,
    RobotArgument,
    RobotBitRateOption,
)
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.plot_option import PlotOption
from firmware_bridge.cli.recorded import RecordOption

EXAMPLES: Final = """Examples:

`firmware-bridge emulate rars -i socketcan -c vcan0`

`firmware-bridge emulate rars -i socketcan -c vcan0 --silence 3@10` silences node 3 after 10 s.

`firmware-bridge emulate rars --serial pty --serial-link rars.tty` puts the first drive on a serial line.

`firmware-bridge emulate rome --serial pty --serial-link rome.tty` puts a board with a motor shield on a line.

`firmware-bridge emulate epos2 --node 1-2 -i socketcan -c vcan0` emulates two drives without a robot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOptions(Outside):
    """Put the robot's emulated drives and its plant on a real CAN bus, a serial line, or both, in real time.

    A robot with several links names a place for each: --link base=socketcan:can0 --link arm=socketcan:can1.

    With --serial and neither -i nor -c the CAN bus is inside; the line reaches the other drives through it.

    Ends on Ctrl-C. On a machine without CAN hardware, make a virtual bus first:
    `sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up`
    """

    robot: RobotArgument
    protocol: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Protocol of the serial line: v1 as on RS232, v2 as on USB; for a board with a motor "
            "shield its firmware.",
            show_default="as its host does; of a board by the robot file",
        ),
    ] = None
    encoders: EncodersOption = None
    bit_rate: RobotBitRateOption = None
    plant: PlantOption = None
    silence: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NODE@SECONDS", help="Disconnect a drive from the bus at this time; may be repeated."
        ),
    ] = None
    factory: Annotated[
        bool,
        typer.Option(
            "--factory",
            help="Drives with factory settings; without it they have the gains and limits of the robot "
            "file, as after commissioning.",
        ),
    ] = False
    parameters: ParametersOption = None
    realistic_latency: LatencyOption = False
    link: LinkOption = None
    record: RecordOption = None
    control: ControlOption = "unix"
    plotjuggler: PlotOption = None
    fault: FaultOption = None
    live: LiveOption = False
    duration: DurationOption = None


def start(given: RobotOptions) -> Emulation:
    """Make the devices of `emulate ROBOT`; an error ends the program with a message."""
    from emulators.cli.emulate_lines import emulate_lines
    from emulators.family import families_of
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.robot import RobotFileError

    machine = find_robot(given.robot)
    with one_message(RobotFileError):
        ways = {one.on_ports or emulate_lines for one in families_of(machine) if one.observe is None}
    if len(ways) > 1:
        raise refusal(f"{machine.name} has boards and drives: real ports take one of both; use `bench`")
    (way,) = ways
    return way(machine, given)


def run(given: RobotOptions) -> None:
    """Run `emulate ROBOT` with these options; an error ends the program with a message."""
    emulation.run(given, start(given))


emulate: Final = emulating(RobotOptions, EXAMPLES, start)
