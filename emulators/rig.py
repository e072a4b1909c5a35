"""One robot put together: operator, bridge, bus, drives and plant in the virtual world."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from emulators.bench.mission import Noise
from emulators.bench.records import SAMPLE_EVERY, HoldRecord, Sample
from emulators.devices import BODY, devices
from emulators.line import Line
from emulators.rewind import Checkpoint, Rewind
from emulators.servo.bank import plant_outputs
from emulators.wires import CanWire, DatagramWire
from emulators.world import Wire, World
from firmware_bridge.bridge import Bridge
from firmware_bridge.node import CAN, OPERATOR, SERIAL, Node
from firmware_bridge.robot import Link, Robot
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.maxon.frame import Generation

LINK_STREAM: Final = 1
"""Which stream of random numbers the operator's link draws from, beside the run's seed."""
QUIET: Final = Noise()
BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"


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

    def snapshot(self) -> Checkpoint:
        """Keep this instant of the world, with what was sampled so far; see `World.snapshot`."""
        return self._rewind.snapshot()

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go to an instant that this rig has kept."""
        self._rewind.restore(checkpoint)

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
