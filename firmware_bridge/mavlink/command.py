"""One command of a ground station, and what it is answered with; source: common.xml, MAV_RESULT."""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Final


class Result(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4


@dataclass(frozen=True, slots=True)
class Command:
    """One command with its seven parameters, whichever message carried it."""

    number: int
    """Of MAV_CMD."""
    params: tuple[float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class CommandAnswer:
    """The result, and where it is a refusal the reason for people."""

    result: Result
    reason: str = ""


ACCEPTED: Final = CommandAnswer(Result.ACCEPTED)
UNSUPPORTED: Final = CommandAnswer(Result.UNSUPPORTED)


def denied(reason: str) -> CommandAnswer:
    """Refuse for good."""
    return CommandAnswer(Result.DENIED, reason)


def whole(parameter: float) -> int | None:
    """Return a parameter that is a whole number, not below 0; None for any other."""
    if math.isfinite(parameter) and parameter >= 0.0 and parameter == int(parameter):
        return int(parameter)
    return None
