"""The variables that one device has of a plant which another device steps."""

from collections.abc import Sequence
from typing import Final, Protocol

from emulators.servo.seam import Doubles, ServoPlant


class NamedPlant(ServoPlant, Protocol):
    """A plant whose variables have names."""

    @property
    def input_names(self) -> Sequence[str]:
        """Names of its inputs, in their order."""

    @property
    def output_names(self) -> Sequence[str]:
        """Names of its outputs, in their order."""


class _Chosen:
    """Some of a plant's variables, in an order of their own."""

    def __init__(self, variables: Doubles, places: Sequence[int]) -> None:
        self._variables: Final = variables
        self._places: Final = tuple(places)

    def __getitem__(self, index: slice) -> Sequence[float]:
        return [self._variables[place : place + 1][0] for place in self._places[index]]

    def __setitem__(self, index: int, value: float) -> None:
        self._variables[self._places[index]] = value


class PlantPart:
    """A plant to a device that follows: its inputs count from the plant's next step on."""

    def __init__(self, plant: NamedPlant, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self._inputs: Final = _Chosen(plant.inputs, [plant.input_names.index(name) for name in inputs])
        self._outputs: Final = _Chosen(plant.outputs, [plant.output_names.index(name) for name in outputs])

    @property
    def inputs(self) -> Doubles:
        """Its inputs."""
        return self._inputs

    @property
    def outputs(self) -> Doubles:
        """Its outputs after the plant's last step."""
        return self._outputs

    def step(self) -> None:
        """Leave the plant where it is: the leading device steps it."""
