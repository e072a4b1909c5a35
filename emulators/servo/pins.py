"""Wiring of a plant's variables to a drive's pins: names on the one side, bits on the other.

All of them are optional: a plant that has none leaves the inputs open and does not see the outputs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

INPUT_PINS: Final = 9
"""Digital inputs of the 70/10, which has the most (maxon EDS: entries of 0x2070)."""
OUTPUT_PINS: Final = 5
"""Digital outputs of the 70/10 (maxon EDS: entries of 0x2079)."""
SWITCHES: Final = MappingProxyType({"negative_limit": 6, "positive_limit": 5, "home": 4})
"""Wiring of a plant's switches: the pins that have these functions by default in 0x2070."""
MIRRORED: Final = MappingProxyType(
    SWITCHES | {"negative_limit": SWITCHES["positive_limit"], "positive_limit": SWITCHES["negative_limit"]}
)
"""The same at a drive whose motor is mounted the other way round."""
BRAKE_CLOSED: Final = 1 << 15
"""Bit beside the levels of the output pins (bit 0 is pin 1): the holding brake is closed."""


@dataclass(frozen=True, slots=True)
class PinWire:
    """One wire: the axis' number, the bit, and which of the plant's outputs or inputs it is."""

    axis: int
    mask: int
    variable: int


def pin_outputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's outputs that are read as input pins where it has them: 1.0 closed, 0.0 open."""
    return tuple(name for axis in axes for name in _input_masks(axis))


def pin_inputs(axes: Sequence[str]) -> tuple[str, ...]:
    """Return the plant's inputs that the drives' output pins are written to where it has them: 1.0 or 0.0."""
    return tuple(name for axis in axes for name in _output_masks(axis))


def input_lines(
    outputs: Sequence[str], axes: Sequence[str], mirrored: Sequence[str] = ()
) -> tuple[PinWire, ...]:
    """Return the wires from a plant with these outputs to the input pins of the axes.

    What a drive counts as positive is the plant's negative side for a `mirrored` axis: its limit switches are
    wired so that each ends the motion towards it.
    """
    return _lines(outputs, [_input_masks(axis, MIRRORED if axis in mirrored else SWITCHES) for axis in axes])


def output_lines(inputs: Sequence[str], axes: Sequence[str]) -> tuple[PinWire, ...]:
    """Return the wires from the output pins of the axes to a plant with these inputs."""
    return _lines(inputs, [_output_masks(axis) for axis in axes])


def _input_masks(axis: str, switches: Mapping[str, int] = SWITCHES) -> dict[str, int]:
    # Bit 0 is pin 1.
    numbered = {f"pin_{pin}_{axis}": 1 << pin - 1 for pin in range(1, INPUT_PINS + 1)}
    return numbered | {f"{switch}_{axis}": 1 << pin - 1 for switch, pin in switches.items()}


def _output_masks(axis: str) -> dict[str, int]:
    numbered = {f"output_{pin}_{axis}": 1 << pin - 1 for pin in range(1, OUTPUT_PINS + 1)}
    return numbered | {f"brake_{axis}": BRAKE_CLOSED}


def _lines(names: Sequence[str], masks: Sequence[Mapping[str, int]]) -> tuple[PinWire, ...]:
    return tuple(
        PinWire(axis, mask, names.index(name))
        for axis, named in enumerate(masks)
        for name, mask in named.items()
        if name in names
    )
