"""One robot put together: operator, bridge, bus, drives and plant in the virtual world.

The same drives and the same plant go onto a real bus through `devices`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from emulators.bench.mission import Noise
from emulators.bench.records import SAMPLE_EVERY, HoldRecord, Sample
from emulators.epos2.drive import Epos2
from emulators.epos2.profile import EPOS2_70_10, DeviceProfile, realistic
from emulators.epos2.serial.drive import SerialEpos2
from emulators.line import Line
from emulators.rewind import Moment, Rewind
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.servo.pins import input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.sensor_lines import sensor_lines, sensor_outputs
from emulators.wires import CanWire, DatagramWire
from emulators.world import Wire, World
from firmware_bridge.bridge import Bridge
from firmware_bridge.node import CAN, OPERATOR, SERIAL, Node
from firmware_bridge.robot import Link, Robot, RobotFileError
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.maxon.frame import Generation
from fmu.build import ensure
from fmu.plant import FmuPlant, PlantError
from fmu.rars.parameters import ROBOT_FILE, SETS

BODY: Final = ("battery_voltage", "x", "y", "heading", "speed", "yaw_rate", "steer", "lift_height")
"""Outputs of the plant beside those of its axes, in this order."""
LINK_STREAM: Final = 1
"""Which stream of random numbers the operator's link draws from, beside the run's seed."""
QUIET: Final = Noise()
NO_SERIAL: Final[Mapping[str, Generation]] = MappingProxyType({})
BACK_EMF_UNIT: Final = 1 << 24
"""Parts of 1 V s/rad in which a servo axis keeps its motor's constant."""
BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"


@dataclass(frozen=True, slots=True)
class Devices:
    """The emulated half of a robot: its drives by axis name, what moves them, and the plant below."""

    drives: dict[str, Epos2]
    bank: ServoBank
    plant: FmuPlant


def devices(
    robot: Robot,
    plant_path: Path | None = None,
    *,
    realistic_latency: bool = False,
    serial: Mapping[str, Generation] = NO_SERIAL,
) -> Devices:
    """Build a robot's drives above its plant; PlantError where the plant cannot be used.

    With `realistic_latency` they take the published time for an SDO answer; otherwise they answer at once.
    `serial` names the axes whose drives have a host on their serial port, and the protocol that they speak.

    Geometry that both know is set from the robot file into our own plant, so that they agree; a plant of the
    user's is taken as it is, with the parameters that the robot file lists for it.
    """
    names = [axis.name for axis in robot.axes]
    outputs = plant_outputs(names)
    if plant_path is None:
        path, parameters = ensure(robot.plant.fmu), plant_parameters(robot)
    else:
        path, parameters = plant_path, robot.plant.parameters
    plant = FmuPlant(
        path,
        plant_inputs(names),
        (*outputs, *BODY),
        parameters,
        optional_inputs=pin_inputs(names),
        optional_outputs=pin_outputs(names) + sensor_outputs(names),
    )
    axes = [
        ServoAxis(axis.name, axis.quadcounts_per_turn, back_emf=_back_emf(plant, axis.name))
        for axis in robot.axes
    ]
    bank = ServoBank(
        plant,
        axes,
        supply=len(outputs),
        analogue=(robot.battery.axis, robot.battery.divider),
        input_lines=input_lines(plant.output_names, names) + sensor_lines(plant.output_names, names),
        output_lines=output_lines(plant.input_names, names),
    )
    kind = realistic(EPOS2_70_10) if realistic_latency else EPOS2_70_10
    drives = {
        axis.name: _drive(axis.node, servo, _individual(kind, axis.node), serial.get(axis.name))
        for axis, servo in zip(robot.axes, axes, strict=True)
    }
    return Devices(drives, bank, plant)


def _drive(node: int, servo: ServoAxis, profile: DeviceProfile, serial: Generation | None) -> Epos2:
    if serial is None:
        return Epos2(node, servo, profile)
    return SerialEpos2(node, servo, profile, generation=serial)


def _individual(kind: DeviceProfile, node: int) -> DeviceProfile:
    """Return such a drive with a serial number of its own, so that no two on one bus are the same."""
    return replace(kind, serial_number=kind.serial_number + node)


def _back_emf(plant: FmuPlant, axis: str) -> int:
    """Return the motor's constant as an axis takes it; 0, to be learnt, where the plant does not tell it."""
    try:
        return round(plant.read(f"torque_constant_{axis}") * BACK_EMF_UNIT)
    except PlantError:
        return 0


def plant_parameters(robot: Robot) -> dict[str, float]:
    """Return the plant's parameters that the robot file knows, under the plant's names and in its units.

    The geometry that bridge and plant share wins over the parameter set, single values win over both.
    RobotFileError where the set is unknown.
    """
    chosen = robot.plant.parameter_set
    if chosen is not None and chosen not in SETS:
        known = ", ".join(SETS)
        problem = f"the plant '{robot.plant.fmu}' has no such set '{chosen}'; it has {known}"
        raise RobotFileError(robot.name, "plant.parameter_set", problem)
    found = {} if chosen is None else dict(SETS[chosen])
    by_role = {axis.role.value: axis for axis in robot.axes}
    for key, (name, factor) in ROBOT_FILE.items():
        table, *rest = key.split(".")
        owner = by_role[rest.pop(0)] if table == "axes" else getattr(robot, table)
        found[name] = factor * float(getattr(owner, rest[0]))
    return found | robot.plant.parameters


def _served(robot: Robot) -> Mapping[str, Generation]:
    """Return which axis has a host on its serial port."""
    bus = robot.bus
    through = bus.link is Link.SERIAL
    return {axis.name: bus.protocol for axis in robot.axes if through and axis.node == bus.gateway}


class Rig:
    """A robot on the bench: `run` moves time on; what happened stands in `samples` and `holds`.

    The operator's link delays, jitters and loses as `noise` says, by the run's seed.
    """

    def __init__(
        self,
        robot: Robot,
        operator: Node,
        *,
        plant_path: Path | None = None,
        seed: int = 0,
        noise: Noise = QUIET,
        realistic_latency: bool = False,
    ) -> None:
        self.robot: Final = robot
        self.devices: Final = devices(
            robot, plant_path, realistic_latency=realistic_latency, serial=_served(robot)
        )
        self.bridge: Final = Bridge(robot)
        self.guard: Final = guarded(self.bridge, robot)
        self.can_wire: Final = CanWire(robot.bus.bit_rate)
        self.operator_wire: Final = DatagramWire(
            round(noise.delay_ms * MILLISECOND),
            round(noise.jitter_ms * MILLISECOND),
            noise.loss,
            np.random.default_rng([seed, LINK_STREAM]),
        )
        self.world: Final = World(self.devices.bank)
        self.line: Final = Line.of(robot, self.guard, self.bridge.link, BRIDGE)
        for axis, drive in zip(robot.axes, self.devices.drives.values(), strict=True):
            links: dict[str, Wire] = {CAN: self.can_wire}
            if self.line is not None and axis.node == robot.bus.gateway:
                links[SERIAL] = self.line.wire
            self.world.attach(axis.name, drive, links)
        if self.line is None:
            self.world.attach(BRIDGE, self.guard, {CAN: self.can_wire, OPERATOR: self.operator_wire})
        else:
            links = {SERIAL: self.line.wire, OPERATOR: self.operator_wire}
            self.world.attach(BRIDGE, self.line.adapter, links)
        self.world.attach(OPERATOR_STATION, operator, {OPERATOR: self.operator_wire})
        self.samples: Final[list[Sample]] = []
        self.holds: Final[list[HoldRecord]] = []
        self._noted = self.bridge.holds
        """The holds as they were noted last."""
        self._next_sample: Nanoseconds = 0
        self._rewind = Rewind(self)
        self._body = len(plant_outputs([axis.name for axis in robot.axes]))

    def run(self, until: Nanoseconds) -> None:
        """Let everything happen up to `until`, and take a sample every 10 ms."""
        while self._next_sample <= until:
            self.world.run(self._next_sample)
            self._sample(self._next_sample)
            self._next_sample += SAMPLE_EVERY
        self.world.run(until)

    def runs(self, seconds: float) -> None:
        """Run on for some seconds."""
        self.run(self.world.now + from_seconds(seconds))

    def snapshot(self) -> Moment:
        """Keep this instant of the world, with what was sampled so far; see `World.snapshot`."""
        return self._rewind.snapshot()

    def restore(self, moment: Moment) -> None:
        """Go to an instant that this rig has kept."""
        self._rewind.restore(moment)

    def finish(self) -> None:
        """Let go of the plant."""
        self.devices.plant.close()

    def _sample(self, now: Nanoseconds) -> None:
        count = len(self.robot.axes)
        values = self.devices.plant.outputs[:]
        _, x, y, heading, speed, yaw_rate, steer, lift = values[self._body : self._body + len(BODY)]
        currents, motor_speeds = tuple(values[:count]), tuple(values[2 * count : 3 * count])
        seen = self.bridge.seen
        pose = seen.pose
        believed = (seen.demanded_speed_mps, seen.armed, pose.x_m, pose.y_m, pose.heading_rad)
        self.samples.append(
            Sample(now, x, y, heading, speed, yaw_rate, steer, lift, currents, motor_speeds, *believed)
        )
        self._note_holds(now)

    def _note_holds(self, now: Nanoseconds) -> None:
        """Keep the holds from beginning to end; one shorter than a sample may pass unseen."""
        if self.bridge.holds is self._noted:
            return
        self._noted = self.bridge.holds
        standing = {hold.name: hold for hold in self.bridge.holds}
        for index, record in enumerate(self.holds):
            if record.ended is None:
                hold = standing.pop(record.name, None)
                if hold is None or hold.since != record.began:
                    self.holds[index] = HoldRecord(record.name, record.reason, record.began, now)
                    if hold is not None:
                        standing[hold.name] = hold
        for hold in standing.values():
            self.holds.append(HoldRecord(hold.name, hold.reason, hold.since))


def build(
    robot: Robot, operator: Node, *, plant_path: Path | None = None, seed: int = 0, noise: Noise = QUIET
) -> Rig:
    """Put a robot on the bench."""
    return Rig(robot, operator, plant_path=plant_path, seed=seed, noise=noise)
