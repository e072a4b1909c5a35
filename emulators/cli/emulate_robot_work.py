"""Puts a robot's drives and its plant on real links, in real time."""

import re
from collections.abc import Sequence
from pathlib import Path

from emulators.cli.beginning import tell_of_beginning
from emulators.devices import devices
from emulators.epos2.serial.serial_drive import baud_of
from emulators.gateway import Cluster
from emulators.servo.bank import ServoError
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.links import Outside, on_the_line
from firmware_bridge.cli.options import until
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.node import SERIAL
from firmware_bridge.robot import Robot, RobotFileError
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds
from firmware_bridge.wire.maxon.frame import Generation
from fmu.errors import PlantError


def emulate(
    robot: str,
    *,
    interface: str | None,
    channel: str | None,
    bit_rate: int | None,
    plant: Path | None,
    silence: Sequence[str] | None,
    realistic_latency: bool,
    serial: str | None,
    serial_link: Path | None,
    serial_node: int | None,
    protocol: Generation,
    duration: float | None,
) -> None:
    """Do what `emulate ROBOT` says; what is wrong ends the program with a message."""
    machine = find_robot(robot)
    cuts = [_cut(machine, text) for text in silence or ()]
    near = on_the_line(serial_node, [axis.node for axis in machine.axes], serial=serial)
    with one_message(RobotFileError, PlantError, ServoError):
        tell_of_beginning(machine, plant)
        owner = next(axis.name for axis in machine.axes if axis.node == near)
        emulated = devices(
            machine,
            plant,
            realistic_latency=realistic_latency,
            serial={} if serial is None else {owner: protocol},
        )
    cluster = Cluster(emulated.drives, emulated.bank, owners={SERIAL: owner})
    for name, at in cuts:
        cluster.silence(name, at)
        say(f"'{name}' falls silent after {to_seconds(at):g} s")
    rate = machine.bus.bit_rate
    nodes = ", ".join(f"{axis.node} {axis.title}" for axis in machine.axes)
    outside = Outside(serial, serial_link, protocol, interface, channel, bit_rate, rate)
    openers, where = outside.openers(baud_of(emulated.drives[owner]))
    carry(
        cluster,
        openers,
        until(duration),
        f"{machine.name} is on {where}: {nodes}",
        PlantError,
        ServoError,
    )


def _cut(robot: Robot, text: str) -> tuple[str, Nanoseconds]:
    """Read NODE@SECONDS, where the node may be a number or the name of an axis."""
    node, _, seconds = text.partition("@")
    for axis in robot.axes:
        if node in {str(axis.node), axis.name}:
            if not re.fullmatch(r"\d+(\.\d+)?", seconds):
                raise refusal(f"--silence {text}: say NODE@SECONDS, as {axis.node}@10")
            return axis.name, from_seconds(float(seconds))
    known = ", ".join(f"{axis.node} ({axis.name})" for axis in robot.axes)
    raise refusal(f"--silence {text}: {robot.name} has no node '{node}'; it has {known}")
