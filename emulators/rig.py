"""One robot put together: operator, bridge, bus, drives and plant in the virtual world.

The same drives and the same plant go onto a real bus through `devices`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from emulators.bench.mission import Noise
from emulators.bench.records import SAMPLE_EVERY, HoldRecord, Sample
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.wires import CanWire, DatagramWire
from emulators.world import World
from firmware_bridge.bridge import Bridge
from firmware_bridge.node import CAN, OPERATOR, Node
from firmware_bridge.robot import Robot
from firmware_bridge.safety.guard import Guarded
from firmware_bridge.safety.guard_rules import rules_for
from firmware_bridge.units import Nanoseconds, from_seconds
from fmu.build import ensure
from fmu.plant import FmuPlant

BODY: Final = ("battery_voltage", "x", "y", "heading", "speed", "yaw_rate", "steer", "lift_height")
"""Outputs of the plant beside those of its axes, in this order."""


@dataclass(frozen=True, slots=True)
class Devices:
    """The emulated half of a robot: its drives by axis name, what moves them, and the plant below."""

    drives: dict[str, Epos2]
    bank: ServoBank
    plant: FmuPlant


def devices(robot: Robot, plant_path: Path | None = None) -> Devices:
    """Build a robot's drives above its plant; PlantError where the plant cannot be used.

    Geometry that the robot file and the plant both name is set from the robot file, so that they agree.
    """
    names = [axis.name for axis in robot.axes]
    outputs = plant_outputs(names)
    plant = FmuPlant(
        plant_path or ensure(robot.plant.fmu),
        plant_inputs(names),
        (*outputs, *BODY),
        plant_parameters(robot) if plant_path is None else robot.plant.parameters,
    )
    axes = [ServoAxis(axis.name, axis.quadcounts_per_turn) for axis in robot.axes]
    bank = ServoBank(
        plant, axes, supply=len(outputs), analogue=(robot.battery.axis, robot.battery.divider)
    )
    drives = {
        axis.name: Epos2(axis.node, servo) for axis, servo in zip(robot.axes, axes, strict=True)
    }
    return Devices(drives, bank, plant)


def plant_parameters(robot: Robot) -> dict[str, float]:
    """Return the plant's parameters that the robot file knows, in SI units, under the plant's names."""
    base, lift = robot.base, robot.lift
    geometry = {
        "wheel_radius": base.wheel_radius_m,
        "rear_track": base.rear_track_m,
        "wheelbase": base.wheelbase_m,
        "kingpin_distance": base.kingpin_distance_m,
        "davis_h": base.davis_h_m,
        "pinion_diameter": base.pinion_diameter_m,
        "lift_stages": float(lift.stages),
        "lift_link_length": lift.link_length_m,
        "lift_collapsed_angle": math.radians(lift.collapsed_angle_deg),
        "lift_extended_angle": math.radians(lift.extended_angle_deg),
        "screw_pitch": lift.screw_pitch_m,
        "battery_emf": robot.battery.nominal_v,
    }
    gears = {f"gear_{axis.name}": axis.gear_ratio for axis in robot.axes}
    return geometry | gears | robot.plant.parameters


class Rig:
    """A robot on the bench. `run` moves time on; what happened stands in `samples` and `holds`."""

    def __init__(
        self, robot: Robot, operator: Node, *, plant_path: Path | None = None, seed: int = 0, noise: Noise = QUIET
    ) -> None:
        self.robot = robot
        self.operator = operator
        self.devices = devices(robot, plant_path)
        self.plant = self.devices.plant
        self.bridge = Bridge(robot)
        self.guard = Guarded(self.bridge, rules_for(robot))
        self.can_wire = CanWire(robot.bus.bit_rate)
        self.operator_wire = DatagramWire(
            from_seconds(noise.delay_ms / 1000.0),
            from_seconds(noise.jitter_ms / 1000.0),
            noise.loss,
            np.random.default_rng([seed, LINK_STREAM]),
        )
        self.world = World(self.devices.bank)
        for name, drive in self.devices.drives.items():
            self.world.attach(name, drive, {CAN: self.can_wire})
        self.world.attach("bridge", self.guard, {CAN: self.can_wire, OPERATOR: self.operator_wire})
        self.world.attach("operator", operator, {OPERATOR: self.operator_wire})
        self.samples: list[Sample] = []
        self.holds: list[HoldRecord] = []
        self._held: dict[str, HoldRecord] = {}
        self._next_sample: Nanoseconds = 0
