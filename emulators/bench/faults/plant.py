"""Faults of what the robot stands on or hangs by: the plant's, not a device's."""

from collections.abc import Iterator
from typing import Annotated, ClassVar

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import Lasting, Node, Problem
from emulators.bench.faults.site import Site
from emulators.servo.fmu_axes import GRIP_LOST
from firmware_bridge.robot import AnyRobot
from fmu.errors import PlantError
from fmu.plants import find, names


class GripLost(Lasting):
    """An axis loses its grip on the surface: of a magnet, or a sucker."""

    kind: ClassVar = "grip_lost"
    node: Annotated[Node, Field(description="axis that loses adhesion")]

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Give the parts that this robot lacks for it; the check of a plant waits until it is installed."""
        yield from super().problems(robot)
        if robot.plant.fmu in names() and not find(robot.plant.fmu).grips:
            yield "kind", f"nothing holds {robot.name} on a wall: its plant has no input {GRIP_LOST}AXIS"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Take the grip; PlantError where the plant has no such input."""
        del chance
        self._grip(site, 1.0)

    def take_off(self, site: Site) -> None:
        """Give it back; what has fallen stays down."""
        self._grip(site, 0.0)

    def _grip(self, site: Site, lost: float) -> None:
        plant = site.devices.plant
        for axis in self.targets(site.robot):
            name = f"{GRIP_LOST}{axis}"
            if name not in plant.input_names:
                raise PlantError(f"the plant has no input {name}: nothing can lose its grip")
            plant.inputs[plant.input_names.index(name)] = lost
