"""The output guard of the toy drive: listed lines alone, and no speed above the axis's bound.

It reads bytes with its own expressions, and imports nothing of this package: a mistake there must not pass
here.
"""

import re
from typing import ClassVar, Final

from firmware_bridge.safety.guard.one_axis import OneAxisRules

SPEED: Final = re.compile(rb"V(-?[0-9]{1,7})\n")
MRAD: Final = 1000.0
UNPOWERED: Final = re.compile(rb"P0 0 -?[0-9]+ -?[0-9]+")
"""The answer to power off."""


class ToyRules(OneAxisRules):
    """Lines to one device."""

    LISTED: ClassVar[frozenset[bytes]] = frozenset({b"Q\n"})
    POWERS: ClassVar[bytes] = b"P1\n"
    STOPS: ClassVar[frozenset[bytes]] = frozenset({b"S\n", b"P0\n"})
    SAFE: ClassVar[bytes] = b"V0\n"

    def speed_of(self, line: bytes) -> float | None:
        """Return the speed of the axis behind its gear."""
        found = SPEED.fullmatch(line)
        return None if found is None else self.axis.direction * int(found[1]) / MRAD / self.axis.ratio

    def unpowered_by(self, line: bytes) -> bool:
        """Return whether it is the answer to power off."""
        return UNPOWERED.fullmatch(line) is not None
