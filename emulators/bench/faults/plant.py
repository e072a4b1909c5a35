"""Faults of what the robot stands on or hangs by: the plant's, not a device's."""

from typing import Annotated, ClassVar

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import Lasting, Node
from emulators.bench.faults.site import Site
from emulators.servo.fmu_axes import GRIP_LOST
from fmu.errors import PlantError


class GripLost(Lasting):
    """What holds an axis on the surface lets go: a magnet, a sucker."""

    kind: ClassVar = "grip_lost"
    node: Annotated[Node, Field(description="whose")]

    def put_on(self, site: Site, chance: Generator) -> None:
        """Take the grip; PlantError where the plant has no such input."""
        del chance
        self._grip(site, 1.0)

    def take_off(self, site: Site) -> None:
        """Give it back; what has fallen stays down."""
        self._grip(site, 0.0)

    def _grip(self, site: Site, lost: float) -> None:
        plant = site.plant
        for axis in self.targets(site.robot):
            name = f"{GRIP_LOST}{axis}"
            if plant is None or name not in plant.input_names:
                raise PlantError(f"the plant has no input {name}: nothing can lose its grip")
            plant.inputs[plant.input_names.index(name)] = lost
