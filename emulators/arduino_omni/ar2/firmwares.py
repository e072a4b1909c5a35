"""The generations of the arm's sketch, as rows.

Sources: Chris-Annin/AR2, AR2_2.0 and AR2_1.5. Left out is what their facts do not suffice for: the sketch of
2017 with its other lines, and the later one for two boards with encoders.

Where they are silent:
* 1.5 moves as 2.0 does.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from firmware_bridge.families.ar2 import wire

COMMANDS: Final = frozenset(wire.COMMANDS)


@dataclass(frozen=True, slots=True)
class Firmware:
    """One generation of the firmware, as it can be flashed."""

    title: str
    baud: int
    reached: tuple[bytes, bytes]
    """Answers to LL: all joints are at their switches, or not."""
    input: tuple[bytes, bytes]
    """Answers for an input: high, or low."""
    commands: frozenset[str] = COMMANDS
    multiplier: float = 200.0
    """Pulse time of MJ at full speed, in us."""


FIRMWARES: Final[Mapping[str, Firmware]] = MappingProxyType(
    {
        "2.0": Firmware("AR2 2.0", wire.BAUD, (b"P\r", b"F\r"), (b"T\r", b"F\r")),
        "1.5": Firmware(
            "AR2 1.5",
            wire.OLD_BAUD,
            (b"pass\n\r\n", b"fail\n\r\n"),
            (b"True\n\r\n", b"False\n\r\n"),
            COMMANDS - {"TM", "ML"},
        ),
    }
)
