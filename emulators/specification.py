"""What `new` is given for a robot of a user's own, checked word by word."""

import keyword
import math
import re
from collections.abc import Collection
from typing import Final

from firmware_bridge.robot.problems import near

NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,19}")
ENCODER_LINES: Final = range(1, 2_500_001)
"""Of any encoder; a device may take fewer: its key in the robot file is then refused."""


class SpecificationError(Exception):
    """A specification that makes no robot: one message."""


def usable(option: str, name: str) -> str:
    """Return a name that Python and a robot file take; SpecificationError."""
    if NAME.fullmatch(name) is None or keyword.iskeyword(name):
        raise SpecificationError(
            f"{option}: '{name}' is no name: small letters, digits and _, a letter first, at most 20"
        )
    return name


def one_of(option: str, what: str, word: str, known: Collection[str]) -> str:
    """Return a word that is known; SpecificationError."""
    if word not in known:
        raise SpecificationError(f"{option}: no {what}'{word}'; {near(word, known)}")
    return word


def positive(option: str, value: float) -> float:
    """Return a finite number above 0; SpecificationError."""
    if not 0.0 < value < math.inf:
        raise SpecificationError(f"{option} must be positive, not {value:g}")
    return value


def within(option: str, value: int, known: range) -> int:
    """Return a whole number of a range; SpecificationError."""
    if value not in known:
        raise SpecificationError(f"{option} must be {known.start} to {known.stop - 1}, not {value}")
    return value
