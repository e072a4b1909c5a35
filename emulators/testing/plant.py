"""A robot's plant alone, in virtual time: volts in, what moves out, by the names of its reference."""

from collections.abc import Iterable
from typing import Final

from emulators.robot_plant import plant_parameters
from emulators.testing.errors import RigError
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds
from fmu.build import ensure
from fmu.plant import FmuPlant, variables_of

STEP: Final[Nanoseconds] = 100_000
"""Step of the drives' loops, at which the bench steps it, too."""


class VirtualPlant:
    """One plant with the parameters of a robot's file; all inputs begin at 0."""

    def __init__(self, robot: AnyRobot) -> None:
        """Load it, built where that has not been done; PlantError, RobotFileError."""
        path = ensure(robot.plant.fmu)
        self._name: Final = f"the plant of {robot.name}"
        self._known: Final = {it.name: it for it in variables_of(path)}
        names = {
            kind: [it.name for it in self._known.values() if it.causality == kind]
            for kind in ("input", "output")
        }
        self._plant: Final = FmuPlant(path, names["input"], names["output"], plant_parameters(robot), STEP)
        self.inputs: Final = self._plant.input_names
        """Inputs that can be set, in the order of the FMU."""
        self.outputs: Final = self._plant.output_names
        """Outputs that its reference gives over time."""

    @property
    def now(self) -> float:
        """The virtual time, s."""
        return self._plant.steps_done * STEP / SECOND

    def unit(self, name: str) -> str:
        """Return the unit of an input, an output or a parameter, `1` for none; RigError for no such name."""
        return self._known[self._one_of(name, self._known)].unit or "1"

    def sets(self, **values: float) -> None:
        """Set inputs, each in its unit, from now on; RigError for one that there is not, and none is set."""
        # All names first: a wrong one leaves every input as it was.
        for name in values:
            self._one_of(name, self.inputs)
        for name, value in values.items():
            self._plant.inputs[self.inputs.index(name)] = value

    def runs(self, seconds: float) -> None:
        """Let so much virtual time pass, in whole steps of 0.1 ms; PlantError where the FMU gives up."""
        for _ in range(round(from_seconds(seconds) / STEP)):
            self._plant.step()

    def reads(self, name: str) -> float:
        """Return an output as the last step gave it, or a parameter; RigError for what there is not."""
        if name in self.outputs:
            return float(self._plant.outputs[self.outputs.index(name)])
        self._one_of(name, self._known)
        return self._plant.read(name)

    def finish(self) -> None:
        """Let go of it."""
        self._plant.close()

    def _one_of(self, name: str, known: Iterable[str]) -> str:
        if name in known:
            return name
        raise RigError(f"{self._name} has no '{name}'; it has {', '.join(known)}")
